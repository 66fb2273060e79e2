import type { CutTarget, TransferResult } from '../api/index.js';
import type { Split } from '../parts/blend.js';
import { type PreparedPart, preparePart } from '../parts/prepare.js';
import { isMirrored } from '../scene/matrix.js';
import type { Piece } from '../scene/pieces.js';

/** What a result makes of one part of a target. @param cut  The whole target with cut borders, if they are cut. */
export const preparePiece = (
  part: Piece,
  result: Pick<TransferResult, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>,
  cut: CutTarget | undefined,
): PreparedPart => preparePart({ ...part, mirrored: isMirrored(part.matrix) }, result, cut, false);

/** Vertices that primitives share. Existing ones keep their numbers; those of cuts follow, then copies. */
export interface SharedVertices extends Split {
  /** 2 per vertex. */
  uvs: Float32Array;
  /** 1 per vertex. */
  zones: Uint8Array;
  /** For each primitive, 3 per triangle. */
  indices: Uint32Array[];
  /** Whether anything differs from the vertices before. */
  isNew: boolean;
}

/**
 * Joins what was made of primitives with the same attributes, so that they go on sharing them: a vertex is only copied where the
 * primitives need different UVs or zones.
 * @param vertexCount  Of the attributes, before.
 */
export function shareVertices(vertexCount: number, members: readonly PreparedPart[]): SharedVertices {
  const [only, ...others] = members;
  if (only && others.length === 0) {
    return { ...only, indices: [only.indices], isNew: only.sources.length > vertexCount };
  }
  const cut = {
    sources: Uint32Array.from(members.flatMap((member) => [...(member.cut?.sources ?? [])])),
    weights: Float32Array.from(members.flatMap((member) => [...(member.cut?.weights ?? [])])),
  };
  const before = vertexCount + cut.sources.length / 3;
  const sources = Array.from({ length: before }, (_, v) => v);
  const [uvs, zones]: [number[], number[]] = [new Array(2 * before).fill(0), new Array(before).fill(0)];
  const isTaken = new Uint8Array(before);
  const copies = new Map<string, number>();
  let firstBlend = vertexCount;
  const indices = members.map((split) => {
    const place = new Int32Array(split.sources.length).fill(-1);
    const shift = firstBlend - vertexCount;
    firstBlend += (split.cut?.sources.length ?? 0) / 3;
    return split.indices.map((n) => {
      if (place[n]! >= 0) return place[n]!;
      const local = split.sources[n]!;
      const source = local < vertexCount ? local : local + shift;
      const [u, v, zone] = [split.uvs[2 * n]!, split.uvs[2 * n + 1]!, split.zones[n]!];
      let to = source;
      if (isTaken[source] === 1 && !(uvs[2 * source] === u && uvs[2 * source + 1] === v && zones[source] === zone)) {
        const key = `${source} ${u} ${v} ${zone}`;
        to = copies.get(key) ?? sources.push(source) - 1;
        copies.set(key, to);
      }
      isTaken[source] = 1;
      [uvs[2 * to], uvs[2 * to + 1], zones[to]] = [u, v, zone];
      place[n] = to;
      return to;
    });
  });
  return {
    cut,
    copies: sources.length - before,
    sources: Uint32Array.from(sources),
    uvs: Float32Array.from(uvs),
    zones: Uint8Array.from(zones),
    indices,
    isNew: sources.length > vertexCount,
  };
}

/**
 * UVs as files hold them: as 16-bit numbers where all are within 0..1, a 16th of a pixel of a texture of 8192 × 8192 off at most;
 * else as they are.
 */
export function storedUvs(uvs: Float32Array): Float32Array | Uint16Array {
  return uvs.every((x) => x >= 0 && x <= 1) ? Uint16Array.from(uvs, (x) => Math.round(65535 * x)) : uvs;
}

/** The elements that are not 0, if it takes fewer bytes to list them than to store all; else `undefined`. */
export function sparseElements(values: ArrayLike<number> & { BYTES_PER_ELEMENT: number }, size: number) {
  const count = values.length / size;
  const bytes = size * values.BYTES_PER_ELEMENT;
  const found: number[] = [];
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < size; ++k) {
      if (values[size * i + k] === 0) continue;
      found.push(i);
      break;
    }
  }
  const entry = bytes + (count < 65536 ? 2 : 4);
  return found.length * entry + kSparseJson < count * Math.ceil(bytes / 4) * 4 ? Uint32Array.from(found) : undefined;
}

/** The length of the JSON by which a sparse accessor differs from another, about. */
const kSparseJson = 200;
