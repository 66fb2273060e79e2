import { imageSize } from '../../gltf/image-file.js';
import { asStored, fromDataUrl } from '../canvas.js';
import { notA, wrong } from '../errors.js';
import { maxCompositeSize } from './composite.js';

/** An image that is not decoded yet. */
export interface SavedImage {
  /** For messages. */
  name: string;
  file: Blob;
  pixels: number;
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
  return { name, file: new Blob([bytes], { type }), pixels: width * height };
}

/** Decodes an image. @throws {CagecastError} `badArgument` that names it. */
export async function decoded({ name, file, pixels }: SavedImage): Promise<ImageBitmap> {
  const bitmap = await asStored(file).catch((error: Error) => {
    throw wrong(`${name} cannot be read: ${error.message}`);
  });
  const { width, height } = bitmap;
  if (width * height <= pixels) return bitmap;
  bitmap.close();
  throw wrong(`${name} has ${counted(width)} × ${counted(height)} pixels, more than it says`);
}

function bytesOf(url: string, name: string): ReturnType<typeof fromDataUrl> {
  try {
    return fromDataUrl(url);
  } catch (error) {
    throw wrong(`${name} cannot be read: ${(error as Error).message}`);
  }
}

const counted = (pixels: number): string => pixels.toLocaleString('en');
