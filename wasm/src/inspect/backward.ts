import type { Mesh, TransferResult } from '../api/index.js';
import { CagecastError } from '../core/error.js';
import type { Finding } from './finding.js';
import { boxOf, dot, doubleAreaNormal, joined, minus, pointAt, vertexAreas } from './geometry.js';
import { reverse } from './reverse.js';

/** If at most this share of what is seen of a target is outside of its cage, that faces the right way. */
const kFewOutside = 0.05;
/** A cage that faces the other way is nearer to the target once it is turned: at most by this factor as far away. */
const kClearlyNearer = 0.65;

/** A mesh turned by half about the vertical axis of its scene. */
export const turnedBack = <M extends Mesh>(mesh: M): M => ({
  ...mesh,
  positions: mesh.positions.map((x, i) => (i % 3 === 1 ? x : 0 - x)),
});

/**
 * Whether a cage faces the other way: turned by half about the vertical axis, as models of VRM 0 are against others, it fits clearly
 * better. Its distances from the target decide, as a root of the mean square over its area. Cost: linear in the vertices; up to that
 * of a transfer if some of the target is outside of the cage.
 */
export function isBackward(
  cage: Mesh,
  target: Mesh,
  { triangles, distances, zones }: Pick<TransferResult, 'triangles' | 'distances' | 'zones'>,
): boolean {
  const areas = vertexAreas(target);
  let [seen, outside] = [0, 0];
  for (let v = 0; v < areas.length; ++v) {
    if (zones[v] === 1) continue;
    seen += areas[v]!;
    const [a, b, c] = [0, 1, 2].map((k) => pointAt(cage.positions, cage.indices[3 * triangles[v]! + k]!));
    if (distances[v]! > 0 && dot(doubleAreaNormal(a!, b!, c!), minus(pointAt(target.positions, v), a!)) > 0)
      outside += areas[v]!;
  }
  if (outside <= kFewOutside * seen) return false;
  const around = { target, cage, areas, targetBox: boxOf(target.positions) };
  try {
    const all = reverse(around, joined(cage.positions, turnedBack(cage).positions))?.distances;
    const weights = vertexAreas(cage);
    const squares = (first: number) =>
      weights.reduce((sum, weight, v) => sum + weight * (all?.[first + v] ?? 0) ** 2, 0);
    return Math.sqrt(squares(weights.length)) < kClearlyNearer * Math.sqrt(squares(0));
  } catch (error) {
    // A cage may be too far away for this, but not for the transfer.
    if (error instanceof CagecastError) return false;
    throw error;
  }
}

/** Reports a cage that faces the other way. */
export const checkBackward = (...all: Parameters<typeof isBackward>): Finding[] =>
  isBackward(...all)
    ? [
        {
          code: 'cageBackward',
          weight: 60, // before all that follows from it
          sentence: 'The cage faces the other way: turned by half about the vertical axis, it fits clearly better',
          advice: 'Turn it by 180° about the y axis; models of VRM 0 face the other way than others.',
          numbers: {},
        },
      ]
    : [];
