/** Deltas of a morph target, 3 numbers per point, and how far they are applied. */
export interface Morph {
  weight: number;
  deltas: ArrayLike<number>;
}

/** Returns points as morph targets shape them, added in double precision; `points` itself if none does. */
export function morphed(points: Float32Array, morphs: readonly Morph[]): Float32Array {
  const active = morphs.filter(({ weight }) => weight !== 0);
  if (active.length === 0) return points;
  return points.map((value, i) => active.reduce((sum, { weight, deltas }) => sum + weight * deltas[i]!, value));
}

/**
 * Takes points to another space, in double precision.
 * @param m       A matrix, column by column.
 * @param points  3 numbers each.
 * @param out     Other memory, which gets them from `at` on.
 * @returns `out`
 */
export function movePoints<Out extends Float32Array | [x: number, y: number, z: number]>(
  m: ArrayLike<number>,
  points: ArrayLike<number>,
  out: Out,
  at = 0,
): Out {
  for (let i = 0; i < points.length; i += 3)
    for (let k = 0; k < 3; ++k)
      out[at + i + k] = m[k]! * points[i]! + m[4 + k]! * points[i + 1]! + m[8 + k]! * points[i + 2]! + m[12 + k]!;
  return out;
}
