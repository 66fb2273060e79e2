import type { Mesh } from '../api/mesh.js';
import { boxOf, type Vector } from '../inspect/geometry.js';

/** What is subtracted from positions before they are rounded to floats: a place in the scene, or that of the model itself. */
export type Origin = Vector | 'own';

/** The scene's own origin. */
export const kSceneOrigin: Vector = [0, 0, 0];

/** A model that is so many times its size away from the origin of its scene gets one of its own: floats would be too coarse there. */
const kFar = 64;

/** Points, 3 numbers each, and the matrix that takes them to the scene, column by column. */
interface Vectord {
  points: Float32Array;
  matrix: ArrayLike<number>;
}

/** The origin of a model: its middle if it is far away for its size, else that of the scene. */
export function originOf(model: readonly Vectord[]): Vector {
  const [low, high] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ] as [number[], number[]];
  for (const { points, matrix: m } of model) {
    const { min, max } = boxOf(points);
    for (let k = 0; k < 3; ++k) {
      const along = [0, 1, 2].map((c) => [m[4 * c + k]! * min[c]!, m[4 * c + k]! * max[c]!]);
      low[k] = Math.min(
        low[k]!,
        along.reduce((sum, ends) => sum + Math.min(...ends), m[12 + k]!),
      );
      high[k] = Math.max(
        high[k]!,
        along.reduce((sum, ends) => sum + Math.max(...ends), m[12 + k]!),
      );
    }
  }
  const middle = (k: number) => (low[k]! + high[k]!) / 2;
  const size = Math.max(...[0, 1, 2].map((k) => high[k]! - low[k]!));
  const away = Math.max(...[0, 1, 2].map((k) => Math.abs(middle(k))));
  return away > kFar * size ? [middle(0), middle(1), middle(2)] : kSceneOrigin;
}

/** A matrix to the scene as one to a space with another origin; itself if that is the scene's. */
export const fromOrigin = <M extends readonly number[]>(matrix: M, [x, y, z]: Vector): M =>
  x === 0 && y === 0 && z === 0
    ? matrix
    : (matrix.map((value, i) => value - ([x, y, z][i - 12] ?? 0)) as readonly number[] as M);

/** A mesh of a scene in a space with another origin; itself if that is the scene's, or it is none that can be used. */
export const moved = <M extends Mesh>(mesh: M, origin: Vector): M =>
  mesh.positions instanceof Float32Array && origin.some((x) => x !== 0)
    ? { ...mesh, positions: mesh.positions.map((value, i) => value - origin[i % 3]!) }
    : mesh;

/** Named spots moved by an origin, so many times. */
export const landmarksMoved = (
  landmarks: Readonly<Record<string, Vector>>,
  origin: Vector,
  times: 1 | -1,
): Record<string, [number, number, number]> =>
  Object.fromEntries(
    Object.entries(landmarks).map(([name, [x, y, z]]) => [
      name,
      [x + times * origin[0], y + times * origin[1], z + times * origin[2]],
    ]),
  );
