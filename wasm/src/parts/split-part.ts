import { splitVertices, type TransferResult } from '../index.js';

/** The ranges of a part in the arrays of a result, and its triangles. */
export interface PartGeometry {
  firstVertex: number;
  vertexCount: number;
  firstTriangle: number;
  triangleCount: number;
  /** Whether its matrix mirrors it: then the winding of its triangles is reversed in the arrays, second and third corners swapped. */
  mirrored: boolean;
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
  /** Number of added vertices; if 0, the part is unchanged. */
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
