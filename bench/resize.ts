import { MeshoptSimplifier } from 'meshoptimizer';
import type { Scene, SceneMesh } from './scene-file.js';

/**
 * The same shape with another number of triangles (within 2 %): simplified, or each triangle cut in four as often as that
 * fits and simplified in between.
 */
export async function resized(mesh: SceneMesh, triangles: number): Promise<SceneMesh> {
  const count = mesh.indices.length / 3;
  if (triangles === count) return mesh;
  if (triangles < count) return simplified(mesh, triangles);
  const cuts = Math.floor(Math.log2(triangles / count) / 2);
  let result = mesh;
  const before = Math.round(triangles / 4 ** cuts);
  if (before > 1.02 * count) result = await simplified(cut(result), before);
  for (let i = 0; i < cuts; ++i) result = cut(result);
  return result;
}

/** Simplifies by meshoptimizer, which keeps a subset of the vertices with all they carry. */
async function simplified(mesh: SceneMesh, triangles: number): Promise<SceneMesh> {
  await MeshoptSimplifier.ready;
  const [indices] = MeshoptSimplifier.simplify(mesh.indices, mesh.positions, 3, 3 * triangles, 1, ['LockBorder']);
  return compacted({ ...mesh, indices });
}

/** Drops the vertices that no triangle uses. */
function compacted({ positions, uvs, groups, indices }: SceneMesh): SceneMesh {
  const places = new Int32Array(positions.length / 3).fill(-1);
  const sources: number[] = [];
  for (const v of indices) if (places[v] === -1) places[v] = sources.push(v) - 1;
  const pick = <A extends Float32Array | Uint32Array>(array: A, width: number): A => {
    const out = new (array.constructor as new (length: number) => A)(width * sources.length);
    sources.forEach((v, place) => out.set(array.subarray(width * v, width * (v + 1)), width * place));
    return out;
  };
  return {
    positions: pick(positions, 3),
    indices: indices.map((v) => places[v]!),
    ...(uvs && { uvs: pick(uvs, 2) }),
    ...(groups && { groups: pick(groups, 1) }),
  };
}

/**
 * Cuts each triangle in four at the middles of its edges. Vertices that were split stay split, and where their positions
 * are equal so are those of the new ones between them: x + y is y + x.
 */
function cut(mesh: SceneMesh): SceneMesh {
  const { positions, indices, uvs, groups } = mesh;
  const vertexCount = positions.length / 3;
  const middles = edgeMiddles(indices, vertexCount);
  const count = vertexCount + middles.ends.length / 2;
  const grow = <A extends Float32Array | Uint32Array>(array: A, width: number, isBlended: boolean): A => {
    const out = new (array.constructor as new (length: number) => A)(width * count);
    out.set(array);
    for (let m = 0; m < middles.ends.length / 2; ++m) {
      const a = middles.ends[2 * m]!;
      const b = middles.ends[2 * m + 1]!;
      for (let k = 0; k < width; ++k) {
        const first = array[width * a + k]!;
        out[width * (vertexCount + m) + k] = isBlended ? (first + array[width * b + k]!) / 2 : first;
      }
    }
    return out;
  };
  const out = new Uint32Array(4 * indices.length);
  for (let t = 0; t < indices.length / 3; ++t) {
    const [a, b, c] = [indices[3 * t]!, indices[3 * t + 1]!, indices[3 * t + 2]!];
    const [ab, bc, ca] = [middles.of[3 * t]!, middles.of[3 * t + 1]!, middles.of[3 * t + 2]!];
    out.set([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], 12 * t);
  }
  return {
    positions: grow(positions, 3, true),
    indices: out,
    ...(uvs && { uvs: grow(uvs, 2, true) }),
    ...(groups && { groups: grow(groups, 1, false) }),
  };
}

/** A new vertex for each edge: that of each side of each triangle, and the two ends of each. */
function edgeMiddles(indices: Uint32Array, vertexCount: number): { of: Uint32Array; ends: Uint32Array } {
  // Edges are chained at their lower end. A Map of millions of edges would take a minute.
  const firstAt = new Int32Array(vertexCount).fill(-1);
  const next = new Int32Array(indices.length);
  const ends = new Uint32Array(2 * indices.length);
  const of = new Uint32Array(indices.length);
  let count = 0;
  for (let side = 0; side < indices.length; ++side) {
    const a = indices[side]!;
    const b = indices[side % 3 === 2 ? side - 2 : side + 1]!;
    const [low, high] = a < b ? [a, b] : [b, a];
    let edge = firstAt[low]!;
    while (edge !== -1 && ends[2 * edge + 1] !== high) edge = next[edge]!;
    if (edge === -1) {
      edge = count++;
      next[edge] = firstAt[low]!;
      firstAt[low] = edge;
      ends[2 * edge] = low;
      ends[2 * edge + 1] = high;
    }
    of[side] = vertexCount + edge;
  }
  return { of, ends: ends.slice(0, 2 * count) };
}

/**
 * Bends target and cage alike by a smooth field of position, so that the pieces of a triangle that was cut do not lie in
 * one plane. Vertices of equal position stay together.
 * @param share  How far the field moves a vertex at most, as a share of the target's longest side.
 */
export function bent({ cage, target }: Scene, share: number): Scene {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  target.positions.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3]!, x);
    high[i % 3] = Math.max(high[i % 3]!, x);
  });
  const side = Math.max(...high.map((x, k) => x - low[k]!));
  const bend = (mesh: SceneMesh): SceneMesh => {
    const positions = new Float32Array(mesh.positions.length);
    for (let v = 0; v < positions.length; v += 3) {
      const at = [0, 1, 2].map((k) => (mesh.positions[v + k]! - low[k]!) / side);
      for (let k = 0; k < 3; ++k) {
        const wave = Math.sin(41 * at[(k + 1) % 3]! + k) * Math.sin(37 * at[(k + 2) % 3]! - k);
        positions[v + k] = mesh.positions[v + k]! + share * side * wave;
      }
    }
    return { ...mesh, positions };
  };
  return { cage: bend(cage), target: bend(target) };
}
