import { splitVertices, type TransferResult } from '../api/index.js';

/** Where a part is in the arrays of a target. */
export interface PartRange {
  firstVertex: number;
  vertexCount: number;
  firstTriangle: number;
  triangleCount: number;
  /**
   * Whether its matrix mirrors it: then the winding of its triangles is reversed in the arrays, second and third corners swapped.
   * Default: no
   */
  mirrored?: boolean | undefined;
}

/** The ranges of a part, and its triangles. */
export interface PartGeometry extends PartRange {
  /** 3 per triangle, as numbers of the part's own vertices, before the winding is reversed. */
  localIndices: ArrayLike<number>;
}

/** A part's vertices with a UV each that is right for all corners: existing vertices keep their numbers, copies come after them. */
export interface SplitPart {
  /** 2 per vertex, copies included. */
  uvs: Float32Array<ArrayBuffer>;
  /** 1 per vertex, copies included: the vertex that it copies, except for its UV. */
  sources: Uint32Array<ArrayBuffer>;
  /** 3 per triangle, with copies where needed. */
  indices: Uint32Array<ArrayBuffer>;
  /** Number of copies. */
  copies: number;
}

/** Splits the vertices of a part of a target where the UVs of a result's corners differ. */
export function splitPart(part: PartGeometry, result: Pick<TransferResult, 'uvs' | 'cornerUvs'>): SplitPart {
  const { firstVertex, vertexCount, firstTriangle, triangleCount } = part;
  const localIndices = Uint32Array.from(part.localIndices);
  const uvs = result.uvs.slice(2 * firstVertex, 2 * (firstVertex + vertexCount));
  const own = new Uint32Array(vertexCount).map((_, v) => v);
  if (result.cornerUvs.length === 0) return { uvs, sources: own, indices: localIndices, copies: 0 };

  const cornerUvs = result.cornerUvs.slice(6 * firstTriangle, 6 * (firstTriangle + triangleCount));
  if (part.mirrored) {
    for (let t = 0; t < cornerUvs.length; t += 6) {
      const second = cornerUvs.slice(t + 2, t + 4);
      cornerUvs.copyWithin(t + 2, t + 4, t + 6);
      cornerUvs.set(second, t + 4);
    }
  }
  const split = splitVertices({ positions: new Float32Array(3 * vertexCount), indices: localIndices }, cornerUvs);
  const taken = new Uint8Array(vertexCount);
  const added: number[] = [];
  const place = split.sources.map((source) => {
    if (taken[source] === 1) return vertexCount + added.push(source) - 1;
    taken[source] = 1;
    return source;
  });
  const all = new Float32Array(2 * (vertexCount + added.length));
  all.set(uvs);
  place.forEach((to, n) => {
    all[2 * to] = split.uvs[2 * n]!;
    all[2 * to + 1] = split.uvs[2 * n + 1]!;
  });
  return {
    uvs: all,
    sources: Uint32Array.from([...own, ...added]),
    indices: split.indices.map((n) => place[n]!),
    copies: added.length,
  };
}

/** Elements of `size` numbers each, in the order of `sources`. */
export function gather<A extends Float32Array | Int8Array | Uint8Array | Int16Array | Uint16Array | Uint32Array>(
  values: A,
  size: number,
  sources: Uint32Array,
): A {
  const out = new (values.constructor as new (length: number) => A)(size * sources.length);
  for (let v = 0; v < sources.length; ++v)
    for (let k = 0; k < size; ++k) out[size * v + k] = values[size * sources[v]! + k]!;
  return out;
}

/** Turns triangles over, in place. */
export function turnOver(indices: Uint32Array): void {
  for (let i = 0; i < indices.length; i += 3) [indices[i + 1], indices[i + 2]] = [indices[i + 2]!, indices[i + 1]!];
}

/** Copies of vertices, which come after the existing ones. */
export interface Copies {
  /** 1 per copy: the vertex that it copies. */
  copied: Uint32Array<ArrayBuffer>;
  /** 3 per triangle, with copies where needed. */
  indices: Uint32Array<ArrayBuffer>;
}

/**
 * Splits vertices until every triangle without paint has a vertex that no painted triangle has: then a triangle is painted if
 * and only if all its vertices are. Few triangles need it: those without paint whose three vertices are all at its border.
 * @param cosmetic  1 per triangle: 1 if it is painted.
 * @returns `undefined` if no vertex has to be split.
 */
export function separatePaint(indices: ArrayLike<number>, cosmetic: Uint8Array, vertices: number): Copies | undefined {
  const isPainted = verticesOf(indices, cosmetic, vertices);
  const copies = new Map<number, number>();
  const changes: [corner: number, copy: number][] = [];
  for (let i = 0; i < 3 * cosmetic.length; i += 3) {
    if (cosmetic[i / 3] === 1) continue;
    const corners = [i, i + 1, i + 2];
    if (corners.some((corner) => isPainted[indices[corner]!] === 0)) continue;
    const corner = corners.find((c) => copies.has(indices[c]!)) ?? i;
    const vertex = indices[corner]!;
    if (!copies.has(vertex)) copies.set(vertex, vertices + copies.size);
    changes.push([corner, copies.get(vertex)!]);
  }
  if (copies.size === 0) return undefined;
  const split = Uint32Array.from(indices);
  for (const [corner, copy] of changes) split[corner] = copy;
  return { copied: Uint32Array.from(copies.keys()), indices: split };
}

/** 1 for each vertex that a painted triangle has. */
export function verticesOf(indices: ArrayLike<number>, cosmetic: Uint8Array, vertices: number): Uint8Array {
  const isPainted = new Uint8Array(vertices);
  for (let t = 0; t < cosmetic.length; ++t)
    if (cosmetic[t] === 1) for (let i = 3 * t; i < 3 * t + 3; ++i) isPainted[indices[i]!] = 1;
  return isPainted;
}
