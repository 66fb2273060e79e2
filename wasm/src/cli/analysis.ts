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

/** Where a vertex lies as the cage sees it. */
export interface Sides {
  /** Distance to the cage, negative on the inner side of the nearest triangle's plane, where a target belongs. */
  signedDistances: Float64Array;
  /** 1 where the nearest point of the cage is on an open border, so that the cage says nothing about the vertex. */
  onBorder: Uint8Array;
}

/** Finds on which side of the cage each target vertex lies, and whether beside it. */
export function sidesOf(cage: Mesh, target: Mesh, { triangles, distances }: Pick<TransferResult, 'triangles' | 'distances'>): Sides {
  const { place, openEdges } = edges(cage);
  const openEnds = new Set([...openEdges].flatMap((key) => key.split(' ').map(Number)));
  const signedDistances = new Float64Array(distances.length);
  const onBorder = new Uint8Array(distances.length);
  for (let v = 0; v < distances.length; ++v) {
    const corner = 3 * triangles[v]!;
    const corners = [cage.indices[corner]!, cage.indices[corner + 1]!, cage.indices[corner + 2]!] as const;
    const p = pointAt(target.positions, v);
    const points = corners.map((c) => pointAt(cage.positions, c)) as [Point, Point, Point];
    signedDistances[v] = Math.sign(dot(doubleAreaNormal(cage.positions, ...corners), minus(p, points[0]))) * distances[v]!;
    const touched = nearestFeature(p, ...points).map((k) => place[corners[k]!]!);
    if (touched.length === 1) onBorder[v] = openEnds.has(touched[0]!) ? 1 : 0;
    if (touched.length === 2) onBorder[v] = openEdges.has(edgeKey(touched[0]!, touched[1]!)) ? 1 : 0;
  }
  return { signedDistances, onBorder };
}

type Point = readonly [number, number, number];
const pointAt = (positions: Float32Array, v: number): Point => [positions[3 * v]!, positions[3 * v + 1]!, positions[3 * v + 2]!];
const minus = (a: Point, b: Point): Point => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a: Point, b: Point): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** The corners of the feature of triangle abc that is nearest to p: one for a corner, two for an edge, three inside. */
function nearestFeature(p: Point, a: Point, b: Point, c: Point): number[] {
  // Ericson, Real-Time Collision Detection, 5.1.5: the Voronoi regions of corners, edges and face.
  const [ab, ac, ap] = [minus(b, a), minus(c, a), minus(p, a)];
  const [d1, d2] = [dot(ab, ap), dot(ac, ap)];
  if (d1 <= 0 && d2 <= 0) return [0];
  const bp = minus(p, b);
  const [d3, d4] = [dot(ab, bp), dot(ac, bp)];
  if (d3 >= 0 && d4 <= d3) return [1];
  if (d1 * d4 - d3 * d2 <= 0 && d1 >= 0 && d3 <= 0) return [0, 1];
  const cp = minus(p, c);
  const [d5, d6] = [dot(ab, cp), dot(ac, cp)];
  if (d6 >= 0 && d5 <= d6) return [2];
  if (d5 * d2 - d1 * d6 <= 0 && d2 >= 0 && d6 <= 0) return [0, 2];
  if (d3 * d6 - d5 * d4 <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return [1, 2];
  return [0, 1, 2];
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
export function cageShape(cage: Mesh): CageShape {
  const { openEdges, nonManifoldEdges, degenerateTriangles } = edges(cage);
  const parents = new Map<number, number>();
  const root = (v: number): number => {
    let at = v;
    for (let up = parents.get(at) ?? at; up !== at; up = parents.get(at) ?? at) at = up;
    parents.set(v, at);
    return at;
  };
  for (const key of openEdges) {
    const [a, b] = key.split(' ').map(Number) as [number, number];
    parents.set(root(a), root(b));
  }
  let uvsOutside = 0;
  const { uvs = new Float32Array(0) } = cage;
  for (let v = 0; v < uvs.length; v += 2) if ([uvs[v]!, uvs[v + 1]!].some((value) => value < 0 || value > 1)) ++uvsOutside;
  return { degenerateTriangles, openLoops: new Set([...parents.keys()].map(root)).size, nonManifoldEdges, uvsOutside };
}

const edgeKey = (a: number, b: number): string => (a < b ? `${a} ${b}` : `${b} ${a}`);

/** The edges of a mesh between places: `place` is the first vertex in the same place as each. */
function edges({ positions, indices }: Mesh) {
  const places = new Map<string, number>();
  const place = Uint32Array.from({ length: positions.length / 3 }, (_, v) => {
    const key = pointAt(positions, v).join(' ');
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
      const key = edgeKey(place[corners[k]!]!, place[corners[(k + 1) % 3]!]!);
      trianglesOfEdge.set(key, (trianglesOfEdge.get(key) ?? 0) + 1);
    }
  }
  const counts = [...trianglesOfEdge];
  return {
    place,
    openEdges: new Set(counts.filter(([, count]) => count === 1).map(([key]) => key)),
    nonManifoldEdges: counts.filter(([, count]) => count > 2).length,
    degenerateTriangles,
  };
}
