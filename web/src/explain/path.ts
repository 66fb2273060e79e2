import { Vector3 } from 'three';
import { placeOn, type Surface } from '../scene/surface';
import type { Rims } from './boundary-loops';
import { firstHit, type Hit } from './ray';

/** The way from a vertex to the cage and along its ray, as steps 1 to 3 of the method go it. Lengths are in units of the model. */
export interface Path {
  /** The vertex itself. */
  start: Vector3;
  /** Where the cage is nearest to it. */
  place: Vector3;
  /** Of the cage's triangle there, outward; the ray goes along it. */
  normal: Vector3;
  /** How far the vertex is outside the plane of that triangle; negative inside. */
  outside: number;
  /** Where the ray meets the cage. */
  cage: Hit | undefined;
  /** Where it first meets the model, whether or not that counts. */
  model: Hit | undefined;
  /** What came of it. */
  outcome: 'hidden' | 'covered' | 'pokesOut' | 'lost';
}

/** Of the rules, what decides here; lengths are shares of the model's diagonal. */
export interface Reach {
  occlusionReach: number;
  pokeThrough: number;
}

// Of the model's diagonal; docs/method.md.
const kRayStart = 1e-5;
const kOnRim = 1e-6;

/**
 * Goes the way of one vertex again, for people to see.
 * @param triangle The cage's triangle that the transfer found nearest.
 * @param diagonal Of the target's box.
 * Cost: every triangle of target and cage is looked at, twice.
 */
export function pathOf(
  target: Surface,
  cage: Surface,
  rims: Rims,
  vertex: number,
  triangle: number,
  diagonal: number,
  reach: Reach,
): Path {
  const start = new Vector3().fromArray(target.positions, 3 * vertex);
  const { place, normal } = placeOn(cage, triangle, start);
  const outside = start.clone().sub(place).dot(normal);
  const ofCage = firstHit(cage, start, normal, -kRayStart * diagonal);
  const model = firstHit(target, start, normal, kRayStart * diagonal);
  const end = ofCage ? Math.max(0, ofCage.length) + reach.occlusionReach * diagonal : Infinity;
  const pokesOut =
    outside > 0 &&
    start.distanceTo(place) <= reach.pokeThrough * diagonal &&
    !rims.has(triangle, place, kOnRim * diagonal);
  const outcome = model && model.length <= end ? 'hidden' : ofCage ? 'covered' : pokesOut ? 'pokesOut' : 'lost';
  return { start, place, normal, outside, cage: ofCage, model, outcome };
}
