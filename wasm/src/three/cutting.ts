import { DataUtils, type BufferGeometry, type TypedArray } from 'three';
import { blend, blendSkin, ruleOf, type CutPart } from '../cut/index.js';
import { likeAttribute, remakeGeometry, valuesOf, type Attribute } from './split.js';

// What cuts a scene: index.ts loads it when that is asked for.
export { cutBorders, cutPart, decideAgain, type CutTarget } from '../cut/index.js';

/** glTF's names of what is not just a mean where triangles are cut. */
const semantics: Record<string, string> = { normal: 'NORMAL', tangent: 'TANGENT', skinIndex: 'JOINTS_0', skinWeight: 'WEIGHTS_0' };
const nameOf = (semantic: string): string => Object.keys(semantics).find((name) => semantics[name] === semantic) ?? '';

type Values = Parameters<typeof blend>[0];

/**
 * Gives a geometry the triangles and vertices of its part as it was cut: new vertices are blends of others in all attributes and
 * morph targets. It stays the same object.
 * @param firstTriangle  Of the part, before.
 */
export function cutGeometry(geometry: BufferGeometry, { geometry: { localIndices }, blends, origins }: CutPart, firstTriangle: number): void {
  const skin = blendSkin((semantic) => {
    const attribute = geometry.getAttribute(nameOf(semantic)) as Attribute | undefined;
    return attribute && (valuesOf(attribute) as Values);
  }, blends);
  const cornerAt = (corner: number) => {
    const piece = origins.findIndex((t) => t - firstTriangle >= corner / 3);
    return 3 * (piece < 0 ? origins.length : piece);
  };
  const moved = ({ start, count }: { start: number; count: number }) => ({ start: cornerAt(start), count: cornerAt(start + count) - cornerAt(start) });
  geometry.groups = geometry.groups.map((group) => ({ ...group, ...moved(group) }));
  if (Number.isFinite(geometry.drawRange.count) || geometry.drawRange.start > 0) Object.assign(geometry.drawRange, moved(geometry.drawRange));

  remakeGeometry(geometry, Uint32Array.from(localIndices), (attribute, name, isMorph) => {
    const semantic = semantics[name] ?? name;
    const pulls = isMorph ? undefined : skin.get(semantic);
    const values = valuesOf(attribute) as Values;
    // What is added to a direction is none itself.
    const rule = isMorph && geometry.morphTargetsRelative ? 'mean' : ruleOf(semantic, values, attribute.normalized);
    const isHalf = 'isFloat16BufferAttribute' in attribute;
    const blended: TypedArray = pulls ?? blend(isHalf ? Float32Array.from(values, DataUtils.fromHalfFloat) : values, attribute.itemSize, blends, rule);
    return likeAttribute(attribute, isHalf && !pulls ? Uint16Array.from(blended, DataUtils.toHalfFloat) : blended);
  });
}
