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

/**
 * Reads how large an image of a saved layer says to be, which anybody may have written: a few bytes can stand for gigabytes. `save` writes
 * none of more than 2048 × 2048, so that those of all layers take 512 MiB at most, two for each.
 * @param side  The pixels along each side that it must have. Default: any.
 * @throws {CagecastError} `badArgument` that names the image, its pixels and the limit.
 */
export function readImage(url: unknown, name: string, side?: number): SavedImage {
  if (typeof url !== 'string') throw notA('the data URL of an image', name, url);
  const { bytes, type } = bytesOf(url, name);
  const size = imageSize(bytes);
  if (!size) throw wrong(`${name} cannot be read: it does not say how many pixels it has`);
  const { width, height } = size;
  const has = `${name} has ${counted(width)} × ${counted(height)} pixels`;
  if (side !== undefined && (width !== side || height !== side))
    throw wrong(`${has}, not ${side} × ${side} as its painting`);
  if (Math.max(width, height) > maxCompositeSize)
    throw wrong(`${has}, more than ${maxCompositeSize} × ${maxCompositeSize}`);
  return { name, bytes, type, width, height };
}

function bytesOf(url: string, name: string): ReturnType<typeof fromDataUrl> {
  try {
    return fromDataUrl(url);
  } catch (error) {
    throw wrong(`${name} cannot be read: ${(error as Error).message}`);
  }
}

export const counted = (pixels: number): string => pixels.toLocaleString('en');

/** The image file of a data URL, its bytes and media type. @throws if it is none. */
function fromDataUrl(url: string): { bytes: Uint8Array<ArrayBuffer>; type: string } {
  const [, type, base64] = /^data:(image\/[\w.+-]+);base64,(.*)$/s.exec(url) ?? [];
  if (base64 === undefined) throw new Error('it is no data URL of an image');
  return { bytes: Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)), type: type! };
}
