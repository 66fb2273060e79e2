import { type Finding, percent } from './finding.js';
import { dot, doubleAreaNormal, minus, pointAt, type Vector } from './geometry.js';
import type { Reverse } from './reverse.js';
import type { Scene } from './scene.js';

/** How deep in the target a vertex of the cage lies, as a share of the diagonal, before it counts as inside. */
const kDepth = 0.0025;
/** A cage is unfit if more than this share of its vertices, by area, is inside the target. */
const kMaxInside = 0.15;

/** The cage's vertices that lie inside the target. */
export interface Inside {
  /** How many vertices, counting those at the same position once. */
  vertices: number;
  /** Their share of the cage's area, not counting vertices at borders. */
  area: number;
}

/**
 * Finds the vertices of the cage that lie inside the target: behind the nearest triangle of the target, whose normal must also
 * agree with the cage's. Vertices at borders are left out, because they may lie anywhere; so may those inside of what is never
 * painted, such as hair.
 */
export function insideOf(
  { surface, cage, diagonal, target, result: { segments, segmentStats } }: Scene,
  reversed: Reverse | undefined,
): Inside {
  if (!reversed) return { vertices: 0, area: 0 };
  const isExcluded = (triangle: number): boolean =>
    segmentStats[segments[target.indices[3 * triangle]!]!]?.culledBy === 'lock';
  const { positions, indices } = cage;
  const { place, loopOfVertex } = surface;
  const normals = new Float64Array(positions.length);
  const areas = new Float64Array(place.length);
  for (let t = 0; t < surface.areas.length; ++t) {
    const corners = [0, 1, 2].map((k) => place[indices[3 * t + k]!]!) as [number, number, number];
    const [a, b, c] = corners.map((v) => pointAt(positions, v)) as [Vector, Vector, Vector];
    const normal = doubleAreaNormal(a, b, c);
    for (const v of corners) {
      areas[v]! += surface.areas[t]! / 3;
      for (let k = 0; k < 3; ++k) normals[3 * v + k]! += normal[k]!;
    }
  }
  let [vertices, inside, total] = [0, 0, 0];
  for (let v = 0; v < place.length; ++v) {
    if (place[v] !== v || areas[v] === 0 || loopOfVertex[v]! >= 0) continue;
    total += areas[v]!;
    if (reversed.distances[v]! <= kDepth * diagonal || isExcluded(reversed.triangles[v]!)) continue;
    const p = pointAt(positions, v);
    const [a, b, c] = reversed.corners(v);
    const normal = doubleAreaNormal(a, b, c);
    const beneath = dot(normal, minus(a, p)) > 0;
    if (!beneath || dot(normal, pointAt(normals, v)) <= 0) continue;
    ++vertices;
    inside += areas[v]!;
  }
  return { vertices, area: total > 0 ? inside / total : 0 };
}

/** A cage that lies partly inside its target. */
export function checkInside({ vertices, area }: Inside): Finding[] {
  if (vertices === 0) return [];
  return [
    {
      code: 'cageInsideTarget',
      weight: area / kMaxInside,
      sentence: `${vertices} of the cage's vertices, ${percent(area)} by area, lie inside the target`,
      advice: 'Move them outwards until they lie above its surface.',
      numbers: { vertices, area },
    },
  ];
}
