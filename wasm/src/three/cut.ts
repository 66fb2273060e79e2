import { type BufferGeometry, DataUtils, type TypedArray } from 'three';
import type { CutTarget } from '../index.js';
import { blend, blendSkin, ruleOf } from '../parts/blend.js';
import { type CutPart, cutPart } from '../parts/cut-part.js';
import { type PartGeometry, type SplitPart, splitPart } from '../parts/split-part.js';
import { type Attribute, likeAttribute, remakeGeometry, splitGeometry, valuesOf } from './split.js';

/** glTF's names of attributes that are not blended by a simple mean. */
const semantics: Record<string, string> = {
  normal: 'NORMAL',
  tangent: 'TANGENT',
  skinIndex: 'JOINTS_0',
  skinWeight: 'WEIGHTS_0',
};
const nameOf = (semantic: string): string => Object.keys(semantics).find((name) => semantics[name] === semantic) ?? '';

type Values = Parameters<typeof blend>[0];

/** The ranges of a part in the arrays of a target, and whether the winding of its triangles was reversed because it is mirrored. */
export type PartRange = Omit<PartGeometry, 'localIndices'>;

/**
 * Replaces the triangles and vertices of a part's geometry by the cut ones. New vertices are blends in all attributes and morph
 * targets; copies at seams come after them. The geometry stays the same object; its groups and draw range are adapted. Needs
 * `init`.
 * @param ownCount  Number of vertices of the whole target before it was cut.
 * @returns `pieces`, the cut part and which of its triangles may be painted; `split.sources`, for each vertex of the geometry the
 * vertex of `pieces` that it copies; and `split.uvs`, its UV.
 */
export function cutGeometry(
  geometry: BufferGeometry,
  part: PartRange,
  cut: CutTarget,
  ownCount: number,
): { pieces: CutPart; split: SplitPart } {
  const pieces = cutPart(part, cut, ownCount);
  if (pieces.blends.sources.length > 0) blendGeometry(geometry, pieces, part.firstTriangle);
  const split = splitPart(pieces.geometry, pieces.result);
  if (split.copies > 0) splitGeometry(geometry, split);
  return { pieces, split };
}

function blendGeometry(
  geometry: BufferGeometry,
  { geometry: { localIndices }, blends, origins }: CutPart,
  firstTriangle: number,
): void {
  const skin = blendSkin((semantic) => {
    const attribute = geometry.getAttribute(nameOf(semantic)) as Attribute | undefined;
    return attribute && (valuesOf(attribute) as Values);
  }, blends);
  const cornerAt = (corner: number) => {
    const piece = origins.findIndex((t) => t - firstTriangle >= corner / 3);
    return 3 * (piece < 0 ? origins.length : piece);
  };
  const moved = ({ start, count }: { start: number; count: number }) => ({
    start: cornerAt(start),
    count: cornerAt(start + count) - cornerAt(start),
  });
  geometry.groups = geometry.groups.map((group) => ({ ...group, ...moved(group) }));
  if (Number.isFinite(geometry.drawRange.count) || geometry.drawRange.start > 0)
    Object.assign(geometry.drawRange, moved(geometry.drawRange));

  remakeGeometry(geometry, Uint32Array.from(localIndices), (attribute, name, isMorph) => {
    const semantic = semantics[name] ?? name;
    const pulls = isMorph ? undefined : skin.get(semantic);
    const values = valuesOf(attribute) as Values;
    // The delta of a direction is not a direction itself.
    const rule = isMorph && geometry.morphTargetsRelative ? 'mean' : ruleOf(semantic, values, attribute.normalized);
    const isHalf = 'isFloat16BufferAttribute' in attribute;
    const blended: TypedArray =
      pulls ??
      blend(isHalf ? Float32Array.from(values, DataUtils.fromHalfFloat) : values, attribute.itemSize, blends, rule);
    return likeAttribute(attribute, isHalf && !pulls ? Uint16Array.from(blended, DataUtils.toHalfFloat) : blended);
  });
}
