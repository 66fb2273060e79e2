import { Vector3 } from 'three';
import { closestPointOnTriangle, type Surface } from '../state/surface';
import { firstHit, type Hit } from '../view/ray';
import type { BoundaryLoops } from './boundary-loops';

/** Steps 1 to 3 of the method for one vertex: the closest point on the cage, and the ray from there. Lengths are in model units. */
export interface Path {
  /** The vertex itself. */
  start: Vector3;
  /** The closest point on the cage. */
  closest: Vector3;
  /** The outward normal of the cage triangle there: the ray's direction. */
  normal: Vector3;
  /** Signed distance of the vertex from the plane of that triangle; negative inside. */
  outside: number;
  /** Where the ray meets the cage. */
  cage: Hit | undefined;
  /** Where it first meets the model, even if that is too far away to count. */
  model: Hit | undefined;
  /** Occluded, covered by the cage, just outside it, or neither. */
  outcome: 'hidden' | 'covered' | 'pokesOut' | 'lost';
}

/** The options that matter here; shares of the model's diagonal. */
interface Reach {
  occlusionReach: number;
  pokeThrough: number;
}

/** The surfaces of a path. */
interface PathScene {
  target: Surface;
  cage: Surface;
  /** Of the cage. */
  loops: BoundaryLoops;
}

/** Where a path starts. */
interface PathStart {
  /** Of the target. */
  vertex: number;
  /** The closest cage triangle, as the transfer found it. */
  triangle: number;
  /** Diagonal of the target's bounding box. */
  diagonal: number;
}

// Of the model's diagonal; docs/method.md.
const kRayStart = 1e-5;
const kOnBoundary = 1e-6;

/**
 * Repeats steps 2 and 3 for one vertex, to show them. The triangle of step 1 is the transfer's.
 * Cost: visits all triangles of target and cage.
 */
export function pathOf(
  { target, cage, loops }: PathScene,
  { vertex, triangle, diagonal }: PathStart,
  reach: Reach,
): Path {
  const start = new Vector3().fromArray(target.positions, 3 * vertex);
  const { closest, normal } = closestPointOnTriangle(cage, triangle, start);
  const outside = start.clone().sub(closest).dot(normal);
  const cageHit = firstHit(cage, start, normal, -kRayStart * diagonal);
  const model = firstHit(target, start, normal, kRayStart * diagonal);
  const end = cageHit ? Math.max(0, cageHit.length) + reach.occlusionReach * diagonal : Infinity;
  const pokesOut =
    outside > 0 &&
    start.distanceTo(closest) <= reach.pokeThrough * diagonal &&
    !loops.has(triangle, closest, kOnBoundary * diagonal);
  const outcome = model && model.length <= end ? 'hidden' : cageHit ? 'covered' : pokesOut ? 'pokesOut' : 'lost';
  return { start, closest, normal, outside, cage: cageHit, model, outcome };
}
