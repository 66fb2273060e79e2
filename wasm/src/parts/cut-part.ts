import type { CutTarget } from '../api/cut-borders.js';
import { CagecastError, show } from '../core/error.js';
import type { Blends } from './blend.js';
import { gather, type PartGeometry, type PartRange, turnOver } from './split-part.js';

/** A cut part, numbered as if it were the only one, and the result for it. */
interface CutPart {
  geometry: PartGeometry;
  result: Pick<CutTarget, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>;
  cut: PartCut;
}

/** What cutting made of a part. */
export interface PartCut extends Blends {
  /** 1 per triangle: the triangle of the whole target that it was cut from; ascending. */
  triangles: Uint32Array;
}

/** Extracts a part from a cut target. Vertices keep their order; new ones come after them. */
export function cutPart(part: PartRange, cut: CutTarget): CutPart {
  const targetVertexCount = cut.zones.length - cut.sources.length / 3;
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
    cut: {
      sources: gather(cut.sources, 3, added).map((v) => v - firstVertex),
      weights: gather(cut.weights, 3, added),
      triangles: cut.triangles.slice(first, end),
    },
  };
}

/** Where the paint ends: at existing triangle edges, or at the borders of the cage, along which triangles are cut. */
export type Borders = 'triangle' | 'cut';

/** Whether to cut borders. @throws {CagecastError} `badOption` */
export function isCut(fn: string, borders: Borders = 'triangle'): boolean {
  if (borders !== 'triangle' && borders !== 'cut')
    throw new CagecastError(
      'badOption',
      fn,
      `options.borders = ${show(borders)} is unknown; there are: "triangle", "cut"`,
    );
  return borders === 'cut';
}
