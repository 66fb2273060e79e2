import type { Mesh } from '../api/mesh.js';

/** A point or a direction. */
export type Vector = readonly [number, number, number];

export const pointAt = (positions: ArrayLike<number>, v: number): Vector => [
  positions[3 * v]!,
  positions[3 * v + 1]!,
  positions[3 * v + 2]!,
];
export const minus = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** The point at a share of the way between two; beyond them, if it is not 0..1. */
export const between = (a: Vector, b: Vector, share: number): Vector => [
  a[0] + share * (b[0] - a[0]),
  a[1] + share * (b[1] - a[1]),
  a[2] + share * (b[2] - a[2]),
];
export const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const length = (a: Vector): number => Math.sqrt(dot(a, a));

/** The normal of triangle abc, as long as twice its area. */
export const doubleAreaNormal = (a: Vector, b: Vector, c: Vector): Vector => cross(minus(b, a), minus(c, a));

/** The area that each vertex stands for: a third of each of its triangles. */
export function vertexAreas({ positions, indices }: Mesh): Float64Array {
  const areas = new Float64Array(positions.length / 3);
  for (let t = 0; t < indices.length; t += 3) {
    const [a, b, c] = [indices[t]!, indices[t + 1]!, indices[t + 2]!];
    const sixth = length(doubleAreaNormal(pointAt(positions, a), pointAt(positions, b), pointAt(positions, c))) / 6;
    areas[a]! += sixth;
    areas[b]! += sixth;
    areas[c]! += sixth;
  }
  return areas;
}

/** The points of one array and then of another. */
export function joined(a: Float32Array, b: Float32Array): Float32Array {
  const both = new Float32Array(a.length + b.length);
  both.set(a);
  both.set(b, a.length);
  return both;
}

/** The smallest box around points. */
export interface Box {
  min: [number, number, number];
  max: [number, number, number];
  diagonal: number;
}

/** The box around those of the points that `vertices` names; around all of them without. */
export function boxOf(positions: ArrayLike<number>, vertices?: Iterable<number>): Box {
  const min: Box['min'] = [Infinity, Infinity, Infinity];
  const max: Box['max'] = [-Infinity, -Infinity, -Infinity];
  const take = (v: number) => {
    for (let k = 0; k < 3; ++k) {
      const value = positions[3 * v + k]!;
      if (value < min[k]!) min[k] = value;
      if (value > max[k]!) max[k] = value;
    }
  };
  if (vertices) for (const v of vertices) take(v);
  else for (let v = 0; v < positions.length / 3; ++v) take(v);
  return { min, max, diagonal: min[0] <= max[0] ? length(minus(max, min)) : 0 };
}

/** Values that given shares of a list do not exceed. */
export function quantiles(values: ArrayLike<number>, shares: readonly number[]): number[] {
  const sorted = Float64Array.from(values).sort();
  return shares.map((share) => sorted[Math.min(Math.floor(share * sorted.length), sorted.length - 1)] ?? 0);
}

/** For each vertex, the first vertex in the very same place (−0 is 0). */
export function firstInPlace(positions: Float32Array): Uint32Array {
  const count = positions.length / 3;
  const exact = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; ++i) exact[i] = positions[i]! + 0; // turns −0 into 0
  const bits = new Uint32Array(exact.buffer);
  // Open addressing, at most half full: a Map of strings takes ten times as long for half a million triangles.
  const mask = 2 ** Math.ceil(Math.log2(Math.max(2 * count, 2))) - 1;
  const table = new Int32Array(mask + 1).fill(-1);
  const place = new Uint32Array(count);
  for (let v = 0; v < count; ++v) {
    const [x, y, z] = [bits[3 * v]!, bits[3 * v + 1]!, bits[3 * v + 2]!];
    let hash = Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca77) ^ Math.imul(z, 0xc2b2ae3d);
    hash = Math.imul(hash ^ (hash >>> 15), 0x2c1b3c6d);
    for (let slot = (hash ^ (hash >>> 13)) & mask; ; slot = (slot + 1) & mask) {
      const other = table[slot]!;
      if (other < 0) table[slot] = v;
      if (other < 0 || (bits[3 * other] === x && bits[3 * other + 1] === y && bits[3 * other + 2] === z)) {
        place[v] = other < 0 ? v : other;
        break;
      }
    }
  }
  return place;
}

/** Things with the same key together, in the order of the first of each. */
export function grouped<T, Key>(things: readonly T[], keyOf: (thing: T) => Key): [T, ...T[]][] {
  const groups = new Map<Key, [T, ...T[]]>();
  for (const thing of things) {
    const key = keyOf(thing);
    const group = groups.get(key);
    if (group) group.push(thing);
    else groups.set(key, [thing]);
  }
  return [...groups.values()];
}

/** Sets of things by number that grow together. */
export class UnionFind {
  readonly #parents: Uint32Array;

  constructor(count: number) {
    this.#parents = Uint32Array.from({ length: count }, (_, i) => i);
  }

  /** The least number of the set that `i` is in. */
  root(i: number): number {
    const parents = this.#parents;
    while (parents[i] !== i) i = parents[i] = parents[parents[i]!]!;
    return i;
  }

  join(i: number, k: number): void {
    const [a, b] = [this.root(i), this.root(k)];
    this.#parents[Math.max(a, b)] = Math.min(a, b);
  }
}

/** The point of a triangle that is nearest to another point. */
interface Nearest {
  point: Vector;
  /** The corners of the feature it lies on: one for a corner, two for an edge, three inside. */
  corners: readonly number[];
}

/**
 * Finds the point of triangle abc that is nearest to p.
 * Ericson, Real-Time Collision Detection, 5.1.5: the Voronoi regions of corners, edges and face.
 */
export function nearestPoint(p: Vector, a: Vector, b: Vector, c: Vector): Nearest {
  const [ab, ac, ap] = [minus(b, a), minus(c, a), minus(p, a)];
  const [d1, d2] = [dot(ab, ap), dot(ac, ap)];
  if (d1 <= 0 && d2 <= 0) return { point: a, corners: [0] };
  const bp = minus(p, b);
  const [d3, d4] = [dot(ab, bp), dot(ac, bp)];
  if (d3 >= 0 && d4 <= d3) return { point: b, corners: [1] };
  const vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return { point: along(a, ab, d1 / (d1 - d3)), corners: [0, 1] };
  const cp = minus(p, c);
  const [d5, d6] = [dot(ab, cp), dot(ac, cp)];
  if (d6 >= 0 && d5 <= d6) return { point: c, corners: [2] };
  const vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return { point: along(a, ac, d2 / (d2 - d6)), corners: [0, 2] };
  const va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return { point: along(b, minus(c, b), (d4 - d3) / (d4 - d3 + d5 - d6)), corners: [1, 2] };
  const sum = va + vb + vc;
  return { point: along(along(a, ab, vb / sum), ac, vc / sum), corners: [0, 1, 2] };
}

const along = (from: Vector, direction: Vector, t: number): Vector => [
  from[0] + t * direction[0],
  from[1] + t * direction[1],
  from[2] + t * direction[2],
];
