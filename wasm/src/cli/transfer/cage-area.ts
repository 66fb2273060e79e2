import type { ReadModel } from '../../gltf/read-model.js';
import { InputError } from '../../scene/input-error.js';
import type { UvBounds } from '../model/uv-bounds.js';

/** A cage whose UVs are 0..1 within bounds: a texture covers just these. @throws {InputError} if no triangle reaches into them. */
export function withinBounds(cage: ReadModel, bounds: UvBounds | undefined): ReadModel {
  if (bounds === undefined) return cage;
  const [left, top, right, bottom] = bounds;
  const { mesh } = cage.extracted;
  const uvs = mesh.uvs!.map((x, i) => (i % 2 === 0 ? (x - left) / (right - left) : (x - top) / (bottom - top)));
  const reaches = (corners: Uint32Array) =>
    [0, 1].every((k) => {
      const values = [...corners].map((v) => uvs[2 * v + k]!);
      return Math.max(...values) > 0 && Math.min(...values) < 1;
    });
  if (!trianglesOf(mesh.indices).some(reaches))
    throw new InputError(`no triangle has UVs within the bounds ${bounds.join(', ')}`).in(cage.file.path);
  return { ...cage, extracted: { ...cage.extracted, mesh: { ...mesh, uvs } } };
}

/**
 * A cage without the triangles whose UVs a reference lacks: they were cut away from it. A triangle is lacking if the centre of its
 * UVs is on no triangle of the reference's UVs.
 * @throws {InputError} that names the cage, if none is left.
 */
export function withoutLacking(cage: ReadModel, reference: ReadModel | undefined): ReadModel {
  if (reference === undefined) return cage;
  const { mesh } = cage.extracted;
  const covers = uvCover(reference);
  const uv = (v: number, k: number) => mesh.uvs![2 * v + k]!;
  const kept = trianglesOf(mesh.indices).filter(([a, b, c]) =>
    covers((uv(a!, 0) + uv(b!, 0) + uv(c!, 0)) / 3, (uv(a!, 1) + uv(b!, 1) + uv(c!, 1)) / 3),
  );
  if (kept.length === 0)
    throw new InputError(`none of its triangles has UVs that the reference cage ${reference.file.path} has`).in(
      cage.file.path,
    );
  const indices = Uint32Array.from(kept.flatMap((triangle) => [...triangle]));
  return { ...cage, extracted: { ...cage.extracted, mesh: { ...mesh, indices } } };
}

const trianglesOf = (indices: Uint32Array): Uint32Array[] =>
  Array.from({ length: indices.length / 3 }, (_, t) => indices.subarray(3 * t, 3 * t + 3));

/** Cells along each side of the grid that finds triangles by UV, and how far outside of a triangle a UV counts as on it. */
const [cells, slack] = [64, 1e-5];

/** Returns a test whether a UV is on a triangle of a mesh. */
function uvCover({ extracted: { mesh } }: ReadModel): (u: number, v: number) => boolean {
  const uvs = mesh.uvs!;
  const bounds = [0, 1].map((k) => {
    const values = uvs.filter((_, i) => i % 2 === k);
    const least = values.reduce((least, x) => Math.min(least, x), Infinity);
    return { least, size: values.reduce((most, x) => Math.max(most, x), -Infinity) - least || 1 };
  });
  const cellOf = (x: number, k: number) => {
    const { least, size } = bounds[k]!;
    return Math.min(cells - 1, Math.max(0, Math.floor(((x - least) / size) * cells)));
  };
  const grid: Uint32Array[][] = Array.from({ length: cells * cells }, () => []);
  for (const triangle of trianglesOf(mesh.indices)) {
    const [[left, right], [top, bottom]] = [0, 1].map((k) => {
      const values = [...triangle].map((v) => uvs[2 * v + k]!);
      return [cellOf(Math.min(...values) - slack, k), cellOf(Math.max(...values) + slack, k)];
    }) as [[number, number], [number, number]];
    for (let y = top; y <= bottom; ++y) for (let x = left; x <= right; ++x) grid[y * cells + x]!.push(triangle);
  }
  return (u, v) =>
    grid[cellOf(v, 1) * cells + cellOf(u, 0)]!.some((triangle) => {
      const [a, b, c] = [...triangle].map((n) => [uvs[2 * n]! - u, uvs[2 * n + 1]! - v] as const) as [P, P, P];
      // The distances from the three sides have the same sign.
      const sides = [side(a, b), side(b, c), side(c, a)];
      return sides.every((x) => x >= -slack) || sides.every((x) => x <= slack);
    });
}

type P = readonly [number, number];

/** How far the origin is to the left of the line from one point to another; 0 if they are the same. */
function side(a: P, b: P): number {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
  return length === 0 ? 0 : (a[0] * b[1] - a[1] * b[0]) / length;
}
