import { colorByte, type Image, linearOf, resize } from '../../bake/image.js';

/** A place in an atlas, in texels, without the margin around it. */
export interface Place {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** Texels around each place that go on as its border does, so that smaller copies of the atlas do not mix neighbours. */
const kMargin = 8;
/** The sides of an atlas, if nothing else is said. */
const kSides = [256, 512, 1024, 2048, 4096];
/** Where there is no room, places get smaller by this factor, again and again; down to that before an atlas gets larger. */
const kSmaller = 0.96;
const kSmall = 0.8;

/**
 * Finds places for images of some sizes, none scaled up.
 * @param side  Of the atlas, in texels. Default: a power of two, 4096 at most, in which they keep their size or most of it.
 * @returns undefined if there is no room even for tiny ones.
 */
export function placed(
  sizes: readonly (readonly [number, number])[],
  side?: number,
): { side: number; places: Place[] } | undefined {
  const sides = side === undefined ? kSides : [side];
  for (const one of sides)
    for (let scale = 1; scale > (one === sides.at(-1) ? 1e-3 : kSmall); scale *= kSmaller) {
      const scaled = sizes.map((size) => size.map((x) => Math.max(1, Math.round(scale * x))) as [number, number]);
      const places = shelved(scaled, one);
      if (places) return { side: one, places };
    }
  return undefined;
}

/** Puts images side by side in rows, the highest first. */
function shelved(sizes: readonly (readonly [number, number])[], side: number): Place[] | undefined {
  const places: Place[] = [];
  let [x, y, row] = [0, 0, 0];
  for (const i of [...sizes.keys()].sort((a, b) => sizes[b]![1] - sizes[a]![1] || a - b)) {
    const [width, height] = sizes[i]!;
    const [wide, high] = [width + 2 * kMargin, height + 2 * kMargin];
    if (x + wide > side) [x, y, row] = [0, y + row, 0];
    if (x + wide > side || y + high > side) return undefined;
    places[i] = { x: x + kMargin, y: y + kMargin, width, height };
    x += wide;
    row = Math.max(row, high);
  }
  return places;
}

/** Puts an image into an atlas, scaled to its place, and its border around it. */
export function put(atlas: Image, image: Image, { x, y, width, height }: Place): void {
  const { data } = resize(image, width, height);
  const clamped = (at: number, length: number) => Math.min(length - 1, Math.max(0, at));
  for (let row = -kMargin; row < height + kMargin; ++row)
    for (let column = -kMargin; column < width + kMargin; ++column) {
      const from = 4 * (clamped(row, height) * width + clamped(column, width));
      atlas.data.set(data.subarray(from, from + 4), 4 * ((y + row) * atlas.width + x + column));
    }
}

/** An image of one colour. */
export const flat = (color: readonly number[]): Image => ({ width: 1, height: 1, data: Uint8Array.from(color) });

/** An image whose colours are multiplied. @param isColor  Whether in linear light. */
export function tinted(image: Image, factor: readonly number[], isColor: boolean): Image {
  if (factor.every((share) => share === 1)) return image;
  const toByte = colorByte();
  const table = factor.map((share) =>
    Uint8Array.from({ length: 256 }, (_, byte) =>
      isColor ? toByte(share * linearOf[byte]!) : Math.round(share * byte),
    ),
  );
  return { ...image, data: image.data.map((byte, i) => table[i % 4]?.[byte] ?? byte) };
}
