import { type BufferGeometry, DataUtils, type TypedArray } from 'three';
import type { CutTarget } from '../index.js';
import { blend, blendSkin, ruleOf } from '../parts/blend.js';
import { type CutPart, cutPart } from '../parts/cut-part.js';
import { type PartGeometry, type SplitPart, splitPart } from '../parts/split-part.js';
import { type Attribute, likeAttribute, remakeGeometry, splitGeometry, valuesOf } from './split.js';

/** glTF's names of what is not just a mean where triangles are cut. */
const semantics: Record<string, string> = {
  normal: 'NORMAL',
  tangent: 'TANGENT',
  skinIndex: 'JOINTS_0',
  skinWeight: 'WEIGHTS_0',
};
const nameOf = (semantic: string): string => Object.keys(semantics).find((name) => semantics[name] === semantic) ?? '';

type Values = Parameters<typeof blend>[0];

/** Where a part lies in the arrays of a target, and whether its triangles were turned on the way there, as it is mirrored. */
export type PartRange = Omit<PartGeometry, 'localIndices'>;

/**
 * Gives the geometry of a part of a target its triangles and vertices as it was cut: new vertices are blends of others in all
 * attributes and morph targets, copies at seams come after them. It stays the same object; groups and the range that is drawn
 * follow. Needs `init`.
 * @param ownCount  Vertices of the whole target before it was cut.
 * @returns the part as it was cut, `pieces`, with which of its triangles may be painted; and of each vertex that the geometry has
 * now which of the pieces' it is, `split.sources`, and its UV, `split.uvs`.
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
    // What is added to a direction is none itself.
    const rule = isMorph && geometry.morphTargetsRelative ? 'mean' : ruleOf(semantic, values, attribute.normalized);
    const isHalf = 'isFloat16BufferAttribute' in attribute;
    const blended: TypedArray =
      pulls ??
      blend(isHalf ? Float32Array.from(values, DataUtils.fromHalfFloat) : values, attribute.itemSize, blends, rule);
    return likeAttribute(attribute, isHalf && !pulls ? Uint16Array.from(blended, DataUtils.toHalfFloat) : blended);
  });
}
