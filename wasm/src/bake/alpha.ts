import type { Image } from './image.js';

/** The cells of a grid, along each side at most, that say of an image what is there. */
const kMostCells = 1024;
/** How many texels beyond a triangle are looked at, as pictures of half the size mix them in. */
const kMargin = 2;

/** An alpha below this is not seen where a material blends. */
const kSeen = 1 / 64;

/**
 * The least alpha of a texel, 0 to 255, that is seen.
 * @param cutoff  Of a material that cuts out; undefined if it blends.
 * @param factor  By which the alpha of the texture is multiplied.
 */
export const leastSeen = (cutoff: number | undefined, factor: number): number => (255 * (cutoff ?? kSeen)) / factor;

/** Whether nothing of an image counts where a triangle lies. @param uvs  2 per vertex. */
export type IsFree = (uvs: ArrayLike<number>, a: number, b: number, c: number) => boolean;

/** Whether an image file may have transparency, by its header. */
export const mayBeClear = (bytes: Uint8Array, mimeType: string): boolean =>
  mimeType !== 'image/jpeg' && (mimeType !== 'image/png' || pngMayBeClear(bytes));

/** Whether a PNG has alpha, in its pixels or its palette. */
function pngMayBeClear(png: Uint8Array): boolean {
  const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
  const kColorType = 25;
  if (png[kColorType]! >= 4) return true;
  for (let at = 8; at + 8 <= png.length; at += 12 + view.getUint32(at)) {
    const type = String.fromCharCode(...png.subarray(at + 4, at + 8));
    if (type === 'tRNS') return true;
    if (type === 'IDAT') return false;
  }
  return false;
}

/**
 * Returns what tells whether a triangle, and a little around it, has no texel that counts.
 * @param counts     By the alpha of a texel, 0 to 255.
 * @param isClamped  Whether the image ends at its border; else it begins anew there.
 */
export function freeOf({ width, height, data }: Image, counts: (alpha: number) => boolean, isClamped: boolean): IsFree {
  const size = Math.max(1, Math.ceil(Math.max(width, height) / kMostCells));
  const [columns, rows] = [Math.ceil(width / size), Math.ceil(height / size)];
  const found = new Uint8Array(columns * rows);
  for (let i = 0; i < width * height; ++i)
    if (counts(data[4 * i + 3]!))
      found[columns * Math.floor(Math.floor(i / width) / size) + Math.floor((i % width) / size)] = 1;
  // How many cells count, above and to the left of a corner of the grid.
  const sums = new Uint32Array((columns + 1) * (rows + 1));
  for (let y = 0; y < rows; ++y)
    for (let x = 0, row = 0; x < columns; ++x) {
      row += found[columns * y + x]!;
      sums[(columns + 1) * (y + 1) + x + 1] = sums[(columns + 1) * y + x + 1]! + row;
    }
  const sum = (x: number, y: number) => sums[(columns + 1) * y + x]!;
  const all = sum(columns, rows) === 0;
  return (uvs, a, b, c) => {
    if (all) return true;
    const range = (k: 0 | 1, texels: number, cells: number): [number, number] => {
      const values = [uvs[2 * a + k]!, uvs[2 * b + k]!, uvs[2 * c + k]!];
      const start = isClamped ? 0 : Math.floor(Math.min(...values));
      const cell = (share: number, margin: number) => Math.floor(((share - start) * texels + margin) / size);
      const [from, to] = [cell(Math.min(...values), -kMargin), cell(Math.max(...values), kMargin) + 1];
      // Beyond its border a texture begins anew.
      if (!isClamped && (from < 0 || to > cells)) return [0, cells];
      const within = (at: number) => Math.min(cells - 1, Math.max(0, at));
      return [within(from), within(to - 1) + 1];
    };
    const [left, right] = range(0, width, columns);
    const [top, bottom] = range(1, height, rows);
    return sum(right, bottom) - sum(left, bottom) - sum(right, top) + sum(left, top) === 0;
  };
}
