import type { Mesh } from '../api/mesh.js';
import { boxOf, doubleAreaNormal, firstInPlace, grouped, length, pointAt, UnionFind, type Vector } from './geometry.js';

/** An edge between two positions, and its triangles. */
export interface Edge {
  /** The first vertex at each of its two positions. */
  a: number;
  b: number;
  /** Its triangles, duplicates once: the corner where the edge begins, and whether the triangle runs from `a` to `b`. */
  uses: { triangle: number; corner: number; forward: boolean }[];
}

/** A boundary loop: a closed chain of open edges, or several that touch, around a hole or at the end of the cage. */
interface Loop {
  edges: Edge[];
  /** Total length of its edges, in units of the input. */
  perimeter: number;
  /** Diagonal of its bounding box. */
  diagonal: number;
  /** Area of the triangles between its edges and its middle. */
  area: number;
  centre: Vector;
}

/** A cage as a surface. Triangles without area are ignored, duplicates count once, and vertices at the same position are one. */
export interface Surface {
  mesh: Mesh;
  /** 1 per vertex: the first vertex at the same position. */
  place: Uint32Array;
  /** 1 per triangle: its area; 0 if it is ignored. */
  areas: Float64Array;
  /** 1 per triangle: 1 if an earlier one has the same corners, in any order. */
  doubled: Uint8Array;
  /** The area of all triangles. */
  area: number;
  edges: Edge[];
  loops: Loop[];
  /** 1 per vertex: the loop that it lies on, or -1. */
  loopOfVertex: Int32Array;
  /** The loop of an open edge, by `edgeKey`. */
  loopOfEdge: Map<number, number>;
  /** The key of the edge between two positions. */
  edgeKey(a: number, b: number): number;
}

/** Finds the edges and the holes of a cage. */
export function surfaceOf(mesh: Mesh): Surface {
  const { positions, indices } = mesh;
  const place = firstInPlace(positions);
  const count = place.length;
  const edgeKey = (a: number, b: number) => (a < b ? a * count + b : b * count + a);

  const areas = new Float64Array(indices.length / 3);
  const doubled = new Uint8Array(areas.length);
  const seen = new Set<string>();
  const byKey = new Map<number, Edge>();
  for (let t = 0; t < areas.length; ++t) {
    const [i, j, k] = [indices[3 * t]!, indices[3 * t + 1]!, indices[3 * t + 2]!];
    areas[t] = length(doubleAreaNormal(pointAt(positions, i), pointAt(positions, j), pointAt(positions, k))) / 2;
    if (areas[t] === 0) continue;
    const corners = [place[i]!, place[j]!, place[k]!].sort((v, w) => v - w).join(' ');
    if (seen.has(corners)) {
      doubled[t] = 1;
      continue;
    }
    seen.add(corners);
    for (let corner = 0; corner < 3; ++corner) {
      const from = place[indices[3 * t + corner]!]!;
      const to = place[indices[3 * t + ((corner + 1) % 3)]!]!;
      const key = edgeKey(from, to);
      let edge = byKey.get(key);
      if (!edge) byKey.set(key, (edge = { a: Math.min(from, to), b: Math.max(from, to), uses: [] }));
      edge.uses.push({ triangle: t, corner, forward: from < to });
    }
  }
  const edges = [...byKey.values()];

  const open = edges.filter(({ uses }) => uses.length === 1);
  const sets = new UnionFind(count);
  for (const { a, b } of open) sets.join(a, b);
  const loops = grouped(open, ({ a }) => sets.root(a)).map((group) => loopOf(positions, group));
  const loopOfVertex = new Int32Array(count).fill(-1);
  const loopOfEdge = new Map<number, number>();
  loops.forEach((loop, l) => {
    for (const { a, b } of loop.edges) {
      loopOfVertex[a] = loopOfVertex[b] = l;
      loopOfEdge.set(edgeKey(a, b), l);
    }
  });
  for (let v = 0; v < count; ++v) loopOfVertex[v] = loopOfVertex[place[v]!]!;
  return {
    mesh,
    place,
    areas,
    doubled,
    area: areas.reduce((sum, area) => sum + area, 0),
    edges,
    loops,
    loopOfVertex,
    loopOfEdge,
    edgeKey,
  };
}

/** How many sets there are of triangles that are not ignored. */
export const countSets = ({ areas, doubled }: Surface, sets: UnionFind): number =>
  areas.reduce((sum, area, t) => sum + (area > 0 && doubled[t] === 0 && sets.root(t) === t ? 1 : 0), 0);

/** The middle of a chain of edges, weighted by length. */
export function middleOf(positions: Float32Array, edges: readonly Edge[]): Vector {
  const sum = [0, 0, 0];
  let perimeter = 0;
  for (const { a, b } of edges) {
    const [p, q] = [pointAt(positions, a), pointAt(positions, b)];
    const weight = Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
    perimeter += weight;
    for (let k = 0; k < 3; ++k) sum[k]! += (weight * (p[k]! + q[k]!)) / 2;
  }
  return perimeter > 0
    ? [sum[0]! / perimeter, sum[1]! / perimeter, sum[2]! / perimeter]
    : pointAt(positions, edges[0]!.a);
}

function loopOf(positions: Float32Array, edges: Edge[]): Loop {
  const centre = middleOf(positions, edges);
  let [perimeter, area] = [0, 0];
  for (const { a, b } of edges) {
    const [p, q] = [pointAt(positions, a), pointAt(positions, b)];
    perimeter += Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
    area += length(doubleAreaNormal(p, q, centre)) / 2;
  }
  return {
    edges,
    perimeter,
    diagonal: boxOf(
      positions,
      edges.flatMap(({ a, b }) => [a, b]),
    ).diagonal,
    area,
    centre,
  };
}
