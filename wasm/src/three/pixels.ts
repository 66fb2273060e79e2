import type { Image } from '../bake/index.js';
import { smallSize } from '../bake/small-image.js';
import { type Context, makeCanvas } from './canvas.js';

/** A picture that a canvas can draw. */
type Drawable = CanvasImageSource & { width: number; height: number };

/** What a texture of any kind has as its image. */
export type PixelSource = Partial<Omit<Image, 'data'>> & { data?: unknown };

/**
 * The pixels of an image, the upper row first as its UVs have it, a picture small; undefined if they cannot be read: compressed, of another
 * origin, not loaded.
 */
export function pixelsOf(source: PixelSource | undefined, isFlipped: boolean): Image | undefined {
  const { width = 0, height = 0, data } = source ?? {};
  if (width === 0 || height === 0) return undefined;
  if (data !== undefined) {
    const isRead = data instanceof Uint8Array || data instanceof Uint8ClampedArray;
    if (!isRead || data.length !== 4 * width * height) return undefined;
    const image = { width, height, data };
    return isFlipped ? flipped(image) : image;
  }
  const [columns, rows] = smallSize({ width, height });
  try {
    const context = makeCanvas(columns, rows).getContext('2d', { willReadFrequently: true }) as Context | null;
    if (!context) return undefined;
    if (isFlipped) context.setTransform(1, 0, 0, -1, 0, rows);
    context.drawImage(source as Drawable, 0, 0, columns, rows);
    return { width: columns, height: rows, data: context.getImageData(0, 0, columns, rows).data };
  } catch {
    return undefined; // no canvas, an image of another origin, or none that can be drawn
  }
}

function flipped({ width, height, data }: Image): Image {
  const out = new Uint8Array(data.length);
  for (let row = 0; row < height; ++row)
    out.set(data.subarray(4 * width * row, 4 * width * (row + 1)), 4 * width * (height - 1 - row));
  return { width, height, data: out };
}
