import { show } from '../core/error.js';
import { cornersOf } from './bake.js';
import { checkImage, checkNames, type Image, wrongArgument } from './image.js';
import { modulo } from './raster.js';

/** Images in a model's own UVs: white where it is never, or always, painted; black or transparent elsewhere. */
export interface MaskImages {
  never?: Image | undefined;
  always?: Image | undefined;
}

const kMinSamples = 3; // along a side of a triangle
const kMaxSamples = 24;
const kHalf = 0.5;

/**
 * Masks for `transfer` from images in a model's own UVs, such as a painting program makes: a triangle is masked if at least half of
 * it is; `never` overrides `always`. So a mask ends at edges of triangles.
 * Cost: a sample per texel of each triangle, 6 to 300.
 * @param target  Triangles and UVs, which repeat. Triangles with UVs that are not finite numbers are not masked.
 * @returns 1 per triangle: `masks.triangles`.
 * @throws {CagecastError} `badArgument` for images of a wrong type, or a target without UVs; `badOption` for other names of images.
 *
 * @example
 * transfer(cage, scan, { masks: { triangles: maskTriangles(scan, { never: eyes }) } });
 */
export function maskTriangles(
  { indices, uvs }: { indices: ArrayLike<number>; uvs?: ArrayLike<number> | undefined },
  images: MaskImages,
): Int8Array<ArrayBuffer> {
  if (!uvs || uvs.length === 0) throw wrongArgument('maskTriangles', 'target', 'has no UVs');
  checkNames('maskTriangles', 'images', images, 'never, always');
  const [never, always] = (['never', 'always'] as const).map((name) =>
    images[name] === undefined ? undefined : checkImage('maskTriangles', `images.${name}`, images[name]),
  );
  const corners = cornersOf(uvs, indices, 2);
  return Int8Array.from({ length: corners.length / 6 }, (_, t) => {
    const own = corners.subarray(6 * t, 6 * t + 6);
    if (!own.every(Number.isFinite)) return 0;
    if (never && maskedShare(never, own) >= kHalf) return -1;
    return always && maskedShare(always, own) >= kHalf ? 1 : 0;
  });
}

/** How much of a triangle is white, 0 to 1. */
function maskedShare({ width, height, data }: Image, uvs: ArrayLike<number>): number {
  const [u0, v0] = [uvs[0]! * width, uvs[1]! * height];
  const [du, dv] = [uvs[2]! * width - u0, uvs[3]! * height - v0];
  const [eu, ev] = [uvs[4]! * width - u0, uvs[5]! * height - v0];
  const longest = Math.max(Math.hypot(du, dv), Math.hypot(eu, ev), Math.hypot(du - eu, dv - ev));
  const n = Math.max(kMinSamples, Math.min(kMaxSamples, Math.ceil(longest)));
  let [sum, count] = [0, 0];
  for (let i = 0; i < n; ++i) {
    for (let j = 0; i + j < n; ++j) {
      const [s, t] = [(i + 1 / 3) / n, (j + 1 / 3) / n];
      const x = modulo(Math.floor(u0 + s * du + t * eu), width);
      const y = modulo(Math.floor(v0 + s * dv + t * ev), height);
      const at = 4 * (y * width + x);
      sum += ((data[at]! + data[at + 1]! + data[at + 2]!) * data[at + 3]!) / (3 * 255 * 255);
      ++count;
    }
  }
  return sum / count;
}

/**
 * Masks for `transfer` from vertex colours: never where red exceeds green by at least half, always where green exceeds red so.
 * White, black, grey and blue leave it to the method. A triangle with a vertex of "never" is not painted; see `Masks`.
 * @param colors  `size` numbers per vertex, 0 to 1, red first.
 * @returns 1 per vertex: `masks.vertices`.
 * @throws {CagecastError} `badArgument`
 */
export function maskVertices(colors: ArrayLike<number>, size: 3 | 4): Int8Array<ArrayBuffer> {
  if ((size !== 3 && size !== 4) || colors.length % size !== 0)
    throw wrongArgument(
      'maskVertices',
      'colors',
      `has ${colors.length} numbers, size is ${show(size)}, not 3 or 4 per vertex`,
    );
  return Int8Array.from({ length: colors.length / size }, (_, v) => {
    const lead = colors[size * v]! - colors[size * v + 1]!;
    return lead >= kHalf ? -1 : lead <= -kHalf ? 1 : 0;
  });
}
