import type { CutTarget } from '../borders/index.js';
import { gather, type PartGeometry } from '../split-part.js';
import type { TransferResult } from '../transfer.js';
import type { Blends } from './blend.js';

/** A part and what was transferred to it. */
export interface WrittenPart {
  geometry: PartGeometry;
  /** In which `geometry` says where the part lies. */
  result: Pick<TransferResult, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>;
  /** Its vertices that are new. */
  blends: Blends;
}

/**
 * A part as it was cut, as if there were no other. Vertices keep their numbers, new ones come after them.
 * @param ownCount  Vertices of the whole target before it was cut.
 */
export function cutPart(part: PartGeometry, cut: CutTarget, ownCount: number): WrittenPart {
  const { firstVertex, vertexCount, firstTriangle, triangleCount, turned } = part;
  const added = Array.from({ length: cut.sources.length / 3 }, (_, n) => n).filter((n) => cut.sources[3 * n]! >= firstVertex && cut.sources[3 * n]! < firstVertex + vertexCount);
  const placeOf = new Map(added.map((n, i) => [ownCount + n, vertexCount + i]));
  const vertices = Uint32Array.from({ length: vertexCount + added.length }, (_, v) => (v < vertexCount ? firstVertex + v : ownCount + added[v - vertexCount]!));
  const blendsOf = Uint32Array.from(added);

  const before = (limit: number) => {
    const first = cut.triangles.findIndex((t) => t >= limit);
    return first < 0 ? cut.triangles.length : first;
  };
  const [first, end] = [before(firstTriangle), before(firstTriangle + triangleCount)];
  const localIndices = cut.indices.slice(3 * first, 3 * end).map((v) => placeOf.get(v) ?? v - firstVertex);
  for (let i = 0; turned && i < localIndices.length; i += 3) [localIndices[i + 1], localIndices[i + 2]] = [localIndices[i + 2]!, localIndices[i + 1]!];
  return {
    geometry: { firstVertex: 0, vertexCount: vertices.length, firstTriangle: 0, triangleCount: end - first, turned, localIndices },
    result: {
      uvs: gather(cut.uvs, 2, vertices),
      cornerUvs: cut.cornerUvs.slice(6 * first, 6 * end),
      zones: gather(cut.zones, 1, vertices),
      cosmeticTriangles: cut.cosmeticTriangles.slice(first, end),
    },
    blends: { sources: gather(cut.sources, 3, blendsOf).map((v) => v - firstVertex), weights: gather(cut.weights, 3, blendsOf) },
  };
}
