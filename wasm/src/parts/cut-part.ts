import type { CutTarget } from '../api/cut-borders.js';
import type { Classification } from '../api/result.js';
import { type Blends, heaviestOf } from './blend.js';
import { gather, type PartGeometry, turnOver } from './split-part.js';

/** A cut part, numbered as if it were the only one, and the result for it. */
export interface CutPart {
  geometry: PartGeometry;
  result: Pick<CutTarget, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>;
  /** Its vertices that are new. */
  blends: Blends;
  /** 1 per triangle: the triangle of the whole target that it was cut from. */
  origins: Uint32Array;
}

/**
 * Extracts a part from a cut target. Vertices keep their order; new ones come after them.
 * @param targetVertexCount  Vertices of the whole target before it was cut.
 */
export function cutPart(part: Omit<PartGeometry, 'localIndices'>, cut: CutTarget, targetVertexCount: number): CutPart {
  const { firstVertex, vertexCount, firstTriangle, triangleCount, mirrored } = part;
  const added = new Uint32Array(cut.sources.length / 3)
    .map((_, n) => n)
    .filter((n) => cut.sources[3 * n]! >= firstVertex && cut.sources[3 * n]! < firstVertex + vertexCount);
  const numberInPart = new Uint32Array(cut.sources.length / 3);
  added.forEach((n, i) => (numberInPart[n] = vertexCount + i));
  const vertices = new Uint32Array(vertexCount + added.length).map((_, v) =>
    v < vertexCount ? firstVertex + v : targetVertexCount + added[v - vertexCount]!,
  );

  const before = (limit: number) => {
    const first = cut.triangles.findIndex((t) => t >= limit);
    return first < 0 ? cut.triangles.length : first;
  };
  const [first, end] = [before(firstTriangle), before(firstTriangle + triangleCount)];
  const localIndices = cut.indices
    .slice(3 * first, 3 * end)
    .map((v) => (v < targetVertexCount ? v - firstVertex : numberInPart[v - targetVertexCount]!));
  if (mirrored) turnOver(localIndices);
  return {
    geometry: {
      firstVertex: 0,
      vertexCount: vertices.length,
      firstTriangle: 0,
      triangleCount: end - first,
      mirrored,
      localIndices,
    },
    result: {
      uvs: gather(cut.uvs, 2, vertices),
      cornerUvs: cut.cornerUvs.slice(6 * first, 6 * end),
      zones: gather(cut.zones, 1, vertices),
      cosmeticTriangles: cut.cosmeticTriangles.slice(first, end),
    },
    blends: {
      sources: gather(cut.sources, 3, added).map((v) => v - firstVertex),
      weights: gather(cut.weights, 3, added),
    },
    origins: cut.triangles.slice(first, end),
  };
}

/** What is needed of a cut part once its vertices are split. */
export interface CutPieces extends Pick<CutPart, 'blends' | 'origins'> {
  result: Pick<CutPart['result'], 'zones' | 'cosmeticTriangles'>;
}

type Decision = Pick<Classification, 'zones' | 'cosmeticTriangles'>;

/**
 * Applies another classification to a cut part: in segments whose verdict has changed, pieces take the result of the whole triangle
 * that they were cut from.
 * @param part     As it was before it was cut.
 * @param indices  Of the whole target, as the decision is.
 * @param isOther  1 per vertex of the whole target: whether its segment has another verdict.
 */
export function decideAgain(
  { result, blends, origins }: CutPieces,
  { firstVertex, vertexCount }: Pick<PartGeometry, 'firstVertex' | 'vertexCount'>,
  indices: ArrayLike<number>,
  isOther: ArrayLike<number>,
  now: Decision,
): Decision {
  return {
    zones: result.zones.map((zone, v) => {
      // A piece, and all sources of a new vertex, belong to one segment.
      const n = v - vertexCount;
      const source = firstVertex + (n < 0 ? v : heaviestOf(blends, n));
      return isOther[source] ? now.zones[source]! : zone;
    }),
    cosmeticTriangles: result.cosmeticTriangles.map((cosmetic, piece) => {
      const t = origins[piece]!;
      return isOther[indices[3 * t]!] ? now.cosmeticTriangles[t]! : cosmetic;
    }),
  };
}
