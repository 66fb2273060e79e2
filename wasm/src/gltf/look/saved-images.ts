import { notA, wrong } from '../../core/checks.js';
import { imageSize } from '../image-file.js';

/** The greatest number of texels per side of a composite. */
export const maxCompositeSize = 2048;

/** An image that is not decoded yet. */
export interface SavedImage {
  /** For messages. */
  name: string;
  bytes: Uint8Array<ArrayBuffer>;
  type: string;
  width: number;
  height: number;
}

/** The longest data URL of an image: of one without compression, with room for what else is in its file. */
const kMaxUrl = Math.ceil(1.4 * 4 * maxCompositeSize ** 2) + 65536; // characters

/** Images that were read, by their data URLs: layers share them. */
export type ReadImages = Map<string, Omit<SavedImage, 'name'>>;

/**
 * Reads how large an image of a saved layer says to be, which anybody may have written: a few bytes can stand for gigabytes. `save` writes
 * none of more than 2048 × 2048, so that those of all layers take 512 MiB at most, two for each.
 * @param known  Gets what is read.
 * @param side   The pixels along each side that it must have. Default: any.
 * @throws {CagecastError} `badArgument` that names the image, its characters or pixels, and the limit.
 */
export function readImage(url: unknown, name: string, known: ReadImages, side?: number): SavedImage {
  if (typeof url !== 'string') throw notA('the data URL of an image', name, url);
  if (url.length > kMaxUrl)
    throw wrong(`${name} is a data URL of ${counted(url.length)} characters, more than ${counted(kMaxUrl)}`);
  const image = known.get(url) ?? fileOf(url, name);
  known.set(url, image);
  const { width, height } = image;
  const has = `${name} has ${counted(width)} × ${counted(height)} pixels`;
  if (side !== undefined && (width !== side || height !== side))
    throw wrong(`${has}, not ${side} × ${side} as its painting`);
  if (Math.max(width, height) > maxCompositeSize)
    throw wrong(`${has}, more than ${maxCompositeSize} × ${maxCompositeSize}`);
  return { name, ...image };
}

/** What a data URL says of its image. @throws {CagecastError} */
function fileOf(url: string, name: string): Omit<SavedImage, 'name'> {
  try {
    const file = fromDataUrl(url);
    const size = imageSize(file.bytes);
    if (!size) throw new Error('it does not say how many pixels it has');
    return { ...file, ...size };
  } catch (error) {
    throw wrong(`${name} cannot be read: ${(error as Error).message}`);
  }
}

export const counted = (pixels: number): string => pixels.toLocaleString('en');

/** The image file of a data URL, its bytes and media type. @throws if it is none. */
function fromDataUrl(url: string): { bytes: Uint8Array<ArrayBuffer>; type: string } {
  const [, type, base64] = /^data:(image\/[\w.+-]+);base64,(.*)$/s.exec(url) ?? [];
  if (base64 === undefined) throw new Error('it is no data URL of an image');
  const letters = atob(base64);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = letters.charCodeAt(i);
  return { bytes, type: type! };
}
