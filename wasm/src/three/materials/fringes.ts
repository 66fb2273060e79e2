// Images have a colour, mostly black, where they are transparent, and the GPU filters colours whatever their alpha is: dark fringes at the
// borders of what is painted. So such texels get the colours around them.
import { DataTexture, type Texture } from 'three';
import { type Context, makeCanvas } from '../canvas.js';

/** Texels of the largest image that is copied. */
const kMax = 2048 ** 2;

/** What is shown for a texture, and of which version. */
interface Shown {
  version: number;
  texture: Texture;
  copy: DataTexture | undefined;
}

const shownFor = new WeakMap<Texture, Shown>();

/**
 * The texture to be shown for another one: a copy whose transparent texels have the colours around them, of an image that has such; else
 * the texture itself. Textures that are drawn, and canvases, videos, data and compressed ones, are shown as they are.
 * Cost, once for each version: some milliseconds for an opaque image, tens for each million texels of another.
 */
export function withoutFringes(texture: Texture): Texture {
  const known = shownFor.get(texture);
  if (known?.version === texture.version) return known.texture;
  const filled = texture.premultiplyAlpha ? undefined : filledImage(texture.image);
  const copy = filled && copyOf(texture, filled, known?.copy);
  if (!known && copy) texture.addEventListener('dispose', () => shownFor.get(texture)?.copy?.dispose());
  shownFor.set(texture, { version: texture.version, texture: copy ?? texture, copy: copy ?? known?.copy });
  return copy ?? texture;
}

const kSettings = ['wrapS', 'wrapT', 'magFilter', 'minFilter', 'anisotropy', 'generateMipmaps', 'colorSpace'] as const;

function copyOf(texture: Texture, { data, width, height }: ImageData, before: DataTexture | undefined): DataTexture {
  const copy = before ?? new DataTexture();
  // Another size needs other memory on the GPU.
  if (copy.image.width !== width || copy.image.height !== height) copy.dispose();
  for (const name of kSettings) copy[name] = texture[name] as never;
  copy.name = texture.name;
  copy.flipY = texture.flipY;
  copy.image = { data: new Uint8Array(data.buffer), width, height };
  copy.needsUpdate = true;
  return copy;
}

/** The pixels of an image with transparent texels, filled; undefined if it has none, or is something else. */
function filledImage(image: unknown): ImageData | undefined {
  const isImage =
    (typeof HTMLImageElement === 'function' && image instanceof HTMLImageElement) ||
    (typeof ImageBitmap === 'function' && image instanceof ImageBitmap);
  if (!isImage) return undefined;
  const { width, height } = image;
  if (width === 0 || height === 0 || width * height > kMax) return undefined;
  try {
    const context = makeCanvas(width, height).getContext('2d', { willReadFrequently: true }) as Context;
    context.drawImage(image, 0, 0);
    const pixels = context.getImageData(0, 0, width, height);
    return fill(pixels) ? pixels : undefined;
  } catch {
    return undefined; // an image of another origin, which WebGL refuses, too
  }
}

/** Sums over squares of texels: red, green and blue times alpha, and alpha. */
interface Level {
  sums: Float32Array;
  width: number;
  height: number;
}

/** The sums of twice as large squares. @param weighs  Whether colours are not multiplied by alpha yet. */
function summed(values: ArrayLike<number>, width: number, height: number, weighs: boolean): Level {
  const [columns, rows] = [Math.ceil(width / 2), Math.ceil(height / 2)];
  const sums = new Float32Array(4 * columns * rows);
  for (let y = 0, from = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, from += 4) {
      const to = 4 * ((y >> 1) * columns + (x >> 1));
      const alpha = values[from + 3]!;
      if (alpha === 0) continue;
      const weight = weighs ? alpha : 1;
      for (let k = 0; k < 3; ++k) sums[to + k]! += values[from + k]! * weight;
      sums[to + 3]! += alpha;
    }
  return { sums, width: columns, height: rows };
}

/** Gives transparent texels the mean colour of the smallest square around them that has one. @returns whether there are both. */
function fill({ data, width, height }: ImageData): boolean {
  let clear = 0;
  for (let at = 3; at < data.length; at += 4) clear += Number(data[at] === 0);
  if (clear === 0 || clear === width * height) return false;
  const levels = [summed(data, width, height, true)];
  for (let last = levels[0]!; last.width > 1 || last.height > 1; last = levels.at(-1)!)
    levels.push(summed(last.sums, last.width, last.height, false));
  for (let y = 0, at = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, at += 4) {
      if (data[at + 3] !== 0) continue;
      for (const [l, { sums, width: columns }] of levels.entries()) {
        const from = 4 * ((y >> (l + 1)) * columns + (x >> (l + 1)));
        if (sums[from + 3] === 0) continue;
        for (let k = 0; k < 3; ++k) data[at + k] = sums[from + k]! / sums[from + 3]!;
        break;
      }
    }
  return true;
}
