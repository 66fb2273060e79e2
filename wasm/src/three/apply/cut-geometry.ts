import type { BufferGeometry } from 'three';
import type { CutTarget } from '../../api/index.js';
import { type PreparedPart, preparePart } from '../../parts/prepare.js';
import type { PartRange } from '../../parts/split-part.js';
import { atOnce, remake, replace } from './remake.js';

/**
 * Replaces the triangles and vertices of a part's geometry by the cut ones. New vertices are blends in all attributes and morph
 * targets; copies at seams come after them. The geometry stays the same object; its groups and draw range are adapted. Needs
 * `init`.
 * @returns what the vertices and triangles of the geometry are now: UVs, zones, and which triangles may be painted.
 */
export function cutGeometry(geometry: BufferGeometry, part: PartRange, cut: CutTarget): PreparedPart {
  // What is cut has triangles of its own.
  const prepared = preparePart({ ...part, localIndices: [] }, cut, cut, false);
  const remade = atOnce(remake(geometry, prepared, part.firstTriangle));
  if (remade) replace(geometry, remade);
  return prepared;
}
