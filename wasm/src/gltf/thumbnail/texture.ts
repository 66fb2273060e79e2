import { type Image, linearOf } from '../../bake/image.js';
import type { Wrap } from '../../bake/raster.js';

/** An image that surfaces show: smooth between its texels, and smaller copies of it for surfaces that are far away. */
export class Texture {
  /** The image, and copies of half the size of the one before. */
  readonly #levels: Image[];
  readonly #wraps: readonly [Wrap, Wrap];

  constructor(image: Image, wraps: readonly [Wrap, Wrap]) {
    this.#levels = [image];
    this.#wraps = wraps;
  }

  /** Which copy is shown, so that a sample of a picture has less than two texels a side. @param uvs  Area, in textures, per sample. */
  levelFor(uvs: number): number {
    const { width, height } = this.#levels[0]!;
    const most = Math.floor(Math.log2(Math.min(width, height)));
    const level = Math.min(most, Math.max(0, Math.floor(Math.log2(uvs * width * height) / 2)));
    while (this.#levels.length <= level) this.#levels.push(halved(this.#levels.at(-1)!));
    return level;
  }

  /** Red, green and blue in linear light, and alpha, bilinear; all 0..1. */
  sample(u: number, v: number, level: number, out: Float32Array): void {
    const { width, height, data } = this.#levels[level]!;
    const [x, y] = [u * width - 0.5, v * height - 0.5];
    const [column, row] = [Math.floor(x), Math.floor(y)];
    const [left, right] = [wrap(column, width, this.#wraps[0]), wrap(column + 1, width, this.#wraps[0])];
    const [top, bottom] = [wrap(row, height, this.#wraps[1]), wrap(row + 1, height, this.#wraps[1])];
    const [across, down] = [x - column, y - row];
    const a = 4 * (top * width + left);
    const b = 4 * (top * width + right);
    const c = 4 * (bottom * width + left);
    const d = 4 * (bottom * width + right);
    const [wa, wb, wc, wd] = [(1 - across) * (1 - down), across * (1 - down), (1 - across) * down, across * down];
    for (let k = 0; k < 3; ++k)
      out[k] =
        wa * linearOf[data[a + k]!]! +
        wb * linearOf[data[b + k]!]! +
        wc * linearOf[data[c + k]!]! +
        wd * linearOf[data[d + k]!]!;
    out[3] = (wa * data[a + 3]! + wb * data[b + 3]! + wc * data[c + 3]! + wd * data[d + 3]!) / 255;
  }
}

/** The texel that stands for one that may be beyond the border. */
function wrap(place: number, length: number, how: Wrap): number {
  if (how === 'clamp') return Math.min(length - 1, Math.max(0, place));
  const period = how === 'mirror' ? 2 * length : length;
  const inside = ((place % period) + period) % period;
  return inside < length ? inside : period - 1 - inside;
}

/** An image of half the size: the mean of two by two texels as they are stored, weighted by alpha; an odd last one is left out. */
function halved({ width, height, data }: Image): Image {
  const [wide, high] = [Math.max(1, width >> 1), Math.max(1, height >> 1)];
  const out = new Uint8Array(4 * wide * high);
  const [aside, below] = [width > 1 ? 4 : 0, height > 1 ? 4 * width : 0];
  for (let y = 0; y < high; ++y)
    for (let x = 0; x < wide; ++x) {
      const at = 8 * (y * width + x);
      const to = 4 * (y * wide + x);
      const [b, c, d] = [at + aside, at + below, at + aside + below];
      const sum = data[at + 3]! + data[b + 3]! + data[c + 3]! + data[d + 3]!;
      // Where all is transparent, plainly.
      const least = sum === 0 ? 1 : 0;
      const [wa, wb, wc, wd] = [
        data[at + 3]! + least,
        data[b + 3]! + least,
        data[c + 3]! + least,
        data[d + 3]! + least,
      ];
      for (let k = 0; k < 3; ++k)
        out[to + k] =
          (wa * data[at + k]! + wb * data[b + k]! + wc * data[c + k]! + wd * data[d + k]!) / (sum || 4) + 0.5;
      out[to + 3] = (sum + 2) >> 2;
    }
  return { width: wide, height: high, data: out };
}
