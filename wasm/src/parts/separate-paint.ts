import type { SplitPart } from './split-part.js';

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
  const isPainted = paintedVertices(indices, cosmetic, vertices);
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

/** A split part with more copies. */
export function withCopies(split: SplitPart, { copied, indices }: Copies): SplitPart {
  const count = split.sources.length;
  const uvs = new Float32Array(2 * (count + copied.length));
  const sources = new Uint32Array(count + copied.length);
  uvs.set(split.uvs);
  sources.set(split.sources);
  copied.forEach((vertex, n) => {
    sources[count + n] = split.sources[vertex]!;
    uvs.set(split.uvs.subarray(2 * vertex, 2 * vertex + 2), 2 * (count + n));
  });
  return { uvs, sources, indices, copies: split.copies + copied.length };
}

/** 1 for each vertex that a painted triangle has. */
export function paintedVertices(indices: ArrayLike<number>, cosmetic: Uint8Array, vertices: number): Uint8Array {
  const isPainted = new Uint8Array(vertices);
  for (let t = 0; t < cosmetic.length; ++t)
    if (cosmetic[t] === 1) for (let i = 3 * t; i < 3 * t + 3; ++i) isPainted[indices[i]!] = 1;
  return isPainted;
}
