import type { BufferGeometry } from 'three';
import type { CutTarget } from '../../index.js';
import { type CutPart, cutPart } from '../../parts/cut-part.js';
import type { PartRange } from '../../parts/prepare.js';
import { type SplitPart, splitPart } from '../../parts/split-part.js';
import { atOnce, remake, replace } from './remake.js';

/**
 * Replaces the triangles and vertices of a part's geometry by the cut ones. New vertices are blends in all attributes and morph
 * targets; copies at seams come after them. The geometry stays the same object; its groups and draw range are adapted. Needs
 * `init`.
 * @param targetVertexCount  Number of vertices of the whole target before it was cut.
 * @returns `pieces`, the cut part and which of its triangles may be painted; `split.sources`, for each vertex of the geometry the
 * vertex of `pieces` that it copies; and `split.uvs`, its UV.
 */
export function cutGeometry(
  geometry: BufferGeometry,
  part: PartRange,
  cut: CutTarget,
  targetVertexCount: number,
): { pieces: CutPart; split: SplitPart } {
  const pieces = cutPart(part, cut, targetVertexCount);
  const split = splitPart(pieces.geometry, pieces.result);
  const remade = atOnce(remake(geometry, { pieces, split }, part.firstTriangle));
  if (remade) replace(geometry, remade);
  return { pieces, split };
}
