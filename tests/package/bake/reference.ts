import type { Image } from 'cagecast/engines';
import type { Layout } from '#bake';

/** A number from 0 to 1 at each call, the same for the same seed. */
export function randomNumbers(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) | 0;
    return (state >>> 0) / 2 ** 32;
  };
}

/** A square picture of a function of its pixels. */
export function picture(width: number, colorAt: (x: number, y: number) => readonly number[]): Image {
  const data = new Uint8Array(4 * width * width);
  for (let i = 0; i < width * width; ++i) data.set(colorAt(i % width, Math.floor(i / width)), 4 * i);
  return { width, height: width, data };
}

/** A picture without sharp edges, opaque or not. */
export function smoothImage(width: number, height: number, isOpaque = true): Image {
  const data = new Uint8Array(4 * width * height);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const [u, v] = [(2 * Math.PI * (x + 0.5)) / width, (2 * Math.PI * (y + 0.5)) / height];
      const alpha = isOpaque ? 255 : 128 + 127 * Math.sin(2 * u + v);
      data.set(
        [127 + 100 * Math.sin(3 * u), 127 + 100 * Math.cos(4 * v), 127 + 100 * Math.sin(2 * u + 2 * v), alpha],
        4 * (y * width + x),
      );
    }
  return { width, height, data };
}

const toLinear = (byte: number): number =>
  byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4;
const toByte = (linear: number): number =>
  255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);

/** A premultiplied bilinear sample of an image that repeats, in linear light. */
function sample({ width, height, data }: Image, u: number, v: number): number[] {
  const [x, y] = [u * width - 0.5, v * height - 0.5];
  const out = [0, 0, 0, 0];
  for (const row of [Math.floor(y), Math.floor(y) + 1]) {
    for (const column of [Math.floor(x), Math.floor(x) + 1]) {
      const weight = (1 - Math.abs(x - column)) * (1 - Math.abs(y - row));
      const at = 4 * ((((row % height) + height) % height) * width + (((column % width) + width) % width));
      const alpha = (weight * data[at + 3]!) / 255;
      for (let k = 0; k < 3; ++k) out[k]! += alpha * toLinear(data[at + k]!);
      out[3]! += alpha;
    }
  }
  return out;
}

/** The weight of a texel at a distance, by Keys' cubic convolution. */
function cubic(distance: number): number {
  const [a, d] = [-0.75, Math.abs(distance)];
  if (d >= 2) return 0;
  return d < 1 ? (a + 2) * d ** 3 - (a + 3) * d ** 2 + 1 : a * (d ** 3 - 5 * d ** 2 + 8 * d - 4);
}

/** A premultiplied cubic sample, in linear light, between the values of the four nearest texels. */
function sharpSample({ width, height, data }: Image, u: number, v: number): number[] {
  const [x, y] = [u * width - 0.5, v * height - 0.5];
  const sums = [0, 0, 0, 0];
  const nearest: number[][] = [];
  for (let row = Math.floor(y) - 1; row < Math.floor(y) + 3; ++row) {
    for (let column = Math.floor(x) - 1; column < Math.floor(x) + 3; ++column) {
      const at = 4 * ((((row % height) + height) % height) * width + (((column % width) + width) % width));
      const alpha = data[at + 3]! / 255;
      const values = [0, 1, 2, 3].map((k) => (k === 3 ? alpha : alpha * toLinear(data[at + k]!)));
      values.forEach((value, k) => (sums[k]! += value * cubic(x - column) * cubic(y - row)));
      if (Math.abs(x - column) < 1 && Math.abs(y - row) < 1) nearest.push(values);
    }
  }
  const held = sums.map((sum, k) => {
    const four = nearest.map((values) => values[k]!);
    return Math.min(Math.max(...four), Math.max(Math.min(...four), sum));
  });
  return held.map((value) => Math.min(value, held[3]!));
}

/** A texel that lies in one triangle, or in none: its bytes. Undefined for one on an edge. */
export type Texel = number[] | undefined;

interface Triangle {
  corners: number[];
  area: number;
  from: number[] | undefined;
}

/**
 * What the texels of a square texture should be: each sample is looked up among all triangles, and the first one counts.
 * @param samples  Per texel and direction.
 * @param isCoarse Whether the colour is that of the middle of a texel, not the mean of its samples.
 * @param far      In a repeating texture: how many textures around the first one are searched.
 */
export function texelsOf(
  layouts: readonly Layout[],
  image: Image,
  { size, samples, isCoarse, far = 0 }: { size: number; samples: number; isCoarse: boolean; far?: number },
): Texel[] {
  const triangles = [1, -1].flatMap((way) => layouts.flatMap((layout) => trianglesOf(layout, far, way)));
  const places = Array.from({ length: samples ** 2 }, (_, i) => [
    ((i % samples) + 0.5) / samples,
    (Math.floor(i / samples) + 0.5) / samples,
  ]);
  return Array.from({ length: size * size }, (_, texel) => {
    const at = ([right, down]: number[]) => [
      ((texel % size) + right!) / size,
      (Math.floor(texel / size) + down!) / size,
    ];
    const firsts = places.map((place) => triangles.find((triangle) => weightsAt(triangle, at(place))));
    const [first] = firsts;
    if (firsts.some((other) => other !== first)) return undefined;
    if (!first?.from) return [0, 0, 0, 0];
    const sums = [0, 0, 0, 0];
    const used = isCoarse ? [[0.5, 0.5]] : places;
    for (const place of used) {
      const weights = weightsAt(first, at(place));
      if (!weights) return undefined;
      const uv = [0, 1].map((k) =>
        weights.reduce((sum, weight, corner) => sum + weight * first.from![2 * corner + k]!, 0),
      );
      (isCoarse ? sharpSample : sample)(image, uv[0]!, uv[1]!).forEach((value, k) => (sums[k]! += value / used.length));
    }
    const color = [0, 1, 2].map((k) => (sums[3]! > 0 ? toByte(sums[k]! / sums[3]!) : 0));
    return [...color, 255 * sums[3]!];
  });
}

/** The triangles of a layout with one orientation, once for every texture around. */
function trianglesOf({ to, from, painted }: Layout, far: number, way: number): Triangle[] {
  const shifts = Array.from({ length: 2 * far + 1 }, (_, i) => i - far);
  return [...painted.keys()].flatMap((t) =>
    shifts.flatMap((right) =>
      shifts.flatMap((down) => {
        const corners = [...to.subarray(6 * t, 6 * t + 6)].map((value, k) => value + (k % 2 ? down : right));
        const [u0, v0, u1, v1, u2, v2] = corners as [number, number, number, number, number, number];
        const area = (u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0);
        if (Math.sign(area) !== way) return [];
        return [{ corners, area, from: painted[t] === 1 ? [...from.subarray(6 * t, 6 * t + 6)] : undefined }];
      }),
    ),
  );
}

/** The barycentric weights of a place in a triangle; undefined if it lies outside. */
function weightsAt({ corners, area }: Triangle, [u, v]: number[]): number[] | undefined {
  const [u0, v0, u1, v1, u2, v2] = corners as [number, number, number, number, number, number];
  const [p, q] = [u! - u0, v! - v0];
  const s = (p * (v2 - v0) - q * (u2 - u0)) / area;
  const t = (q * (u1 - u0) - p * (v1 - v0)) / area;
  return s < 0 || t < 0 || s + t > 1 ? undefined : [1 - s - t, s, t];
}
