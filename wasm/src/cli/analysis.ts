import type { Mesh, TransferResult } from '../index.js';

/** A number for each zone. */
export interface PerZone {
  cosmetic: number;
  occluded: number;
  uncovered: number;
  culled: number;
}

const zoneNames = ['cosmetic', 'occluded', 'uncovered', 'culled'] as const;

/** Adds up a weight per vertex (1 by default) for each zone, over a range of vertices. */
export function perZone(zones: Uint8Array, weights?: Float64Array, first = 0, end = zones.length): PerZone {
  const sums: PerZone = { cosmetic: 0, occluded: 0, uncovered: 0, culled: 0 };
  for (let v = first; v < end; ++v) sums[zoneNames[zones[v]!]!] += weights ? weights[v]! : 1;
  return sums;
}

/** The area that each vertex stands for: a third of each of its triangles. */
export function vertexAreas({ positions, indices }: Mesh): Float64Array {
  const areas = new Float64Array(positions.length / 3);
  for (let t = 0; t < indices.length; t += 3) {
    const corners = [indices[t]!, indices[t + 1]!, indices[t + 2]!] as const;
    const third = length(doubleAreaNormal(positions, ...corners)) / 6;
    for (const corner of corners) areas[corner]! += third;
  }
  return areas;
}

/** The normal of a triangle, as long as twice its area. */
export function doubleAreaNormal(positions: Float32Array, a: number, b: number, c: number): [number, number, number] {
  const edge = (from: number, to: number, k: number) => positions[3 * to + k]! - positions[3 * from + k]!;
  const [ux, uy, uz] = [edge(a, b, 0), edge(a, b, 1), edge(a, b, 2)];
  const [vx, vy, vz] = [edge(a, c, 0), edge(a, c, 1), edge(a, c, 2)];
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}

function length([x, y, z]: readonly [number, number, number]): number {
  return Math.sqrt(x * x + y * y + z * z);
}

/**
 * How far each target vertex lies on the outer side of its nearest cage triangle's plane, in units of the input;
 * negative on the inner side, where a target belongs.
 */
export function signedDistances(cage: Mesh, target: Mesh, { triangles, distances }: Pick<TransferResult, 'triangles' | 'distances'>): Float64Array {
  return Float64Array.from(distances, (distance, v) => {
    const corner = 3 * triangles[v]!;
    const [a, b, c] = [cage.indices[corner]!, cage.indices[corner + 1]!, cage.indices[corner + 2]!];
    const [nx, ny, nz] = doubleAreaNormal(cage.positions, a, b, c);
    const from = (k: number) => target.positions[3 * v + k]! - cage.positions[3 * a + k]!;
    return Math.sign(nx * from(0) + ny * from(1) + nz * from(2)) * distance;
  });
}

/** Values that given shares of a list do not exceed. */
export function quantiles(values: ArrayLike<number>, shares: readonly number[]): number[] {
  const sorted = Float64Array.from(values).sort();
  return shares.map((share) => sorted[Math.min(Math.floor(share * sorted.length), sorted.length - 1)] ?? 0);
}

/** What is wrong with a cage as a surface. */
export interface CageShape {
  /** Triangles without area: they take no part. */
  degenerateTriangles: number;
  /** Holes and open rims: closed chains of edges with a triangle on one side only. */
  openLoops: number;
  /** Edges of more than two triangles. */
  nonManifoldEdges: number;
  /** Vertices whose UV lies outside 0 … 1. */
  uvsOutside: number;
}

/** Looks at a cage's edges and UVs; vertices in one place count as one. */
export function cageShape({ positions, indices, uvs }: Mesh): CageShape {
  const places = new Map<string, number>();
  const place = Uint32Array.from({ length: positions.length / 3 }, (_, v) => {
    const key = `${positions[3 * v]} ${positions[3 * v + 1]} ${positions[3 * v + 2]}`;
    if (!places.has(key)) places.set(key, v);
    return places.get(key)!;
  });
  const trianglesOfEdge = new Map<string, number>();
  let degenerateTriangles = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const corners = [indices[t]!, indices[t + 1]!, indices[t + 2]!] as const;
    if (length(doubleAreaNormal(positions, ...corners)) === 0) {
      ++degenerateTriangles;
      continue;
    }
    for (let k = 0; k < 3; ++k) {
      const [a, b] = [place[corners[k]!]!, place[corners[(k + 1) % 3]!]!];
      const key = a < b ? `${a} ${b}` : `${b} ${a}`;
      trianglesOfEdge.set(key, (trianglesOfEdge.get(key) ?? 0) + 1);
    }
  }
  const parents = new Map<number, number>();
  const root = (v: number): number => {
    let at = v;
    for (let up = parents.get(at) ?? at; up !== at; up = parents.get(at) ?? at) at = up;
    parents.set(v, at);
    return at;
  };
  let nonManifoldEdges = 0;
  for (const [key, count] of trianglesOfEdge) {
    if (count > 2) ++nonManifoldEdges;
    if (count !== 1) continue;
    const [a, b] = key.split(' ').map(Number) as [number, number];
    parents.set(root(a), root(b));
  }
  const openLoops = new Set([...parents.keys()].map(root)).size;
  let uvsOutside = 0;
  for (let v = 0; v < (uvs?.length ?? 0) / 2; ++v) if ([uvs![2 * v]!, uvs![2 * v + 1]!].some((value) => value < 0 || value > 1)) ++uvsOutside;
  return { degenerateTriangles, openLoops, nonManifoldEdges, uvsOutside };
}
