import {
  BufferAttribute,
  type BufferGeometry,
  DataUtils,
  type InterleavedBufferAttribute,
  type TypedArray,
} from 'three';
import { type AttributeArray, applySplit, ruleOf, splitSkin } from '../../parts/blend.js';
import type { PreparedPart } from '../../parts/prepare.js';
import { isOfInstances } from './flags.js';
import { disposeOwn, own } from './own-attributes.js';

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/** glTF's names of attributes that are not blended by a simple mean. */
const semantics: Record<string, string> = {
  normal: 'NORMAL',
  tangent: 'TANGENT',
  skinIndex: 'JOINTS_0',
  skinWeight: 'WEIGHTS_0',
};

/** The name of an attribute in glTF; one of an own name begins with a line. */
const semanticOf = (name: string): string =>
  semantics[name] ?? (/^(position|uv\d?|color(_\d+)?)$/.test(name) ? name : `_${name}`);

/** A geometry's vertices and triangles as they will be. */
export interface Remade {
  attributes: Map<string, BufferAttribute>;
  morphs: Map<string, BufferAttribute[]>;
  indices: Uint32Array<ArrayBuffer>;
  groups: BufferGeometry['groups'];
  drawRange: BufferGeometry['drawRange'];
}

/**
 * Adds the new vertices of a part, blends and copies after the existing ones, to all attributes and morph targets. The geometry is
 * not changed yet. Yields after each attribute, for callers that share the thread.
 * @returns what `replace` takes; `undefined` if there is nothing to do.
 */
export function* remake(
  geometry: BufferGeometry,
  part: PreparedPart,
  firstTriangle: number,
): Generator<void, Remade | undefined> {
  const { cut, copies } = part;
  if (copies === 0 && !cut?.sources.length) return undefined;
  const skin = splitSkin((semantic) => {
    const attribute = geometry.getAttribute(nameOf(semantic)) as Attribute | undefined;
    return attribute && storedFor(part, attribute);
  }, part);
  const made = new Map<Attribute, BufferAttribute>();
  const extend = (attribute: Attribute, name: string, isMorph: boolean): BufferAttribute => {
    const given = isMorph ? undefined : skin.get(semanticOf(name));
    if (given) return likeAttribute(attribute, given as TypedArray);
    const known = made.get(attribute);
    if (known) return known;
    // The delta of a direction is not a direction itself.
    const isDelta = isMorph && geometry.morphTargetsRelative;
    const values = storedFor(part, attribute);
    const rule = isDelta ? 'mean' : ruleOf(semanticOf(name), values, attribute.normalized);
    const { itemSize } = attribute;
    const extended = likeAttribute(
      attribute,
      ('isFloat16BufferAttribute' in attribute
        ? splitHalves(values as Uint16Array, itemSize, part)
        : applySplit(values, itemSize, part, rule)) as TypedArray,
    );
    made.set(attribute, extended);
    return extended;
  };
  const attributes = new Map<string, BufferAttribute>();
  for (const [name, attribute] of Object.entries(geometry.attributes)) {
    const extended = isOfInstances(attribute) ? attribute : extend(attribute as Attribute, name, false);
    attributes.set(name, extended as BufferAttribute);
    yield;
  }
  const morphs = new Map<string, BufferAttribute[]>();
  for (const [name, list] of Object.entries(geometry.morphAttributes)) {
    const all: BufferAttribute[] = [];
    for (const attribute of list!) {
      all.push(extend(attribute, name, true));
      yield;
    }
    morphs.set(name, all);
  }
  // A copy, because three-mesh-bvh reorders the index of a geometry, while what is kept is in the order of the verdicts.
  const indices = part.indices.slice();
  return { attributes, morphs, indices, ...movedRanges(geometry, cut?.triangles, firstTriangle) };
}

/** Replaces what a geometry has, and has its GPU buffers made again. */
export function replace(geometry: BufferGeometry, { attributes, morphs, indices, groups, drawRange }: Remade): void {
  disposeOwn(geometry);
  for (const [name, attribute] of attributes)
    if (!isOfInstances(attribute)) geometry.setAttribute(name, own(attribute));
  for (const [name, list] of morphs) geometry.morphAttributes[name as keyof BufferGeometry['morphAttributes']] = list;
  geometry.setIndex(own(new BufferAttribute(indices, 1)));
  geometry.groups = groups;
  Object.assign(geometry.drawRange, drawRange);
}

/** Runs a generator to its end, on the spot. */
export function atOnce<T>(steps: Generator<unknown, T>): T {
  for (let step = steps.next(); ; step = steps.next()) if (step.done) return step.value;
}

const nameOf = (semantic: string): string => Object.keys(semantics).find((name) => semantics[name] === semantic) ?? '';

/** The number of vertices of a part before it was cut and split. */
const vertexCount = ({ sources, copies, cut }: PreparedPart): number =>
  sources.length - copies - (cut?.sources.length ?? 0) / 3;

/** The values of an attribute for the vertices of a part; 0 where it has less of them than there are positions. */
function storedFor(part: PreparedPart, attribute: Attribute): AttributeArray {
  const values = valuesOf(attribute) as AttributeArray;
  const length = attribute.itemSize * vertexCount(part);
  if (values.length === length) return values;
  const own = new (values.constructor as new (length: number) => AttributeArray)(length);
  own.set(values.subarray(0, length));
  return own;
}

function splitHalves(values: Uint16Array, size: number, part: PreparedPart): Uint16Array {
  const out = applySplit(values, size, part, 'heaviest');
  const means = applySplit(Float32Array.from(values, DataUtils.fromHalfFloat), size, part);
  const own = vertexCount(part);
  part.sources.forEach((source, v) => {
    if (source < own) return;
    for (let i = size * v; i < size * (v + 1); ++i) out[i] = DataUtils.toHalfFloat(means[i]!);
  });
  return out;
}

/** The groups and the draw range of a geometry whose triangles were cut into pieces. */
function movedRanges(
  geometry: BufferGeometry,
  origins: Uint32Array | undefined,
  firstTriangle: number,
): Pick<Remade, 'groups' | 'drawRange'> {
  const { groups, drawRange } = geometry;
  if (!origins) return { groups, drawRange };
  const cornerAt = (corner: number) => {
    const piece = origins.findIndex((t) => t - firstTriangle >= corner / 3);
    return 3 * (piece < 0 ? origins.length : piece);
  };
  const moved = ({ start, count }: { start: number; count: number }) => ({
    start: cornerAt(start),
    count: cornerAt(start + count) - cornerAt(start),
  });
  return {
    groups: groups.map((group) => ({ ...group, ...moved(group) })),
    drawRange: Number.isFinite(drawRange.count) || drawRange.start > 0 ? moved(drawRange) : drawRange,
  };
}

/** The same attribute for its first vertices alone. */
export const firstOf = (attribute: Attribute, count: number): BufferAttribute =>
  likeAttribute(attribute, valuesOf(attribute).slice(0, attribute.itemSize * count));

/** The values of an attribute as they are stored, one element after the other. */
function valuesOf(attribute: Attribute): TypedArray {
  if (!('isInterleavedBufferAttribute' in attribute)) return attribute.array;
  const { array, stride } = attribute.data;
  const { itemSize, offset, count } = attribute;
  const own = array.slice(0, itemSize * count);
  for (let v = 0; v < count; ++v)
    for (let k = 0; k < itemSize; ++k) own[itemSize * v + k] = array[stride * v + offset + k]!;
  return own;
}

/** An attribute of the same kind with other values. */
function likeAttribute(attribute: Attribute, values: TypedArray): BufferAttribute {
  const { itemSize, normalized, name } = attribute;
  if ('isInterleavedBufferAttribute' in attribute)
    return Object.assign(new BufferAttribute(values, itemSize, normalized), { name });
  const { usage, gpuType } = attribute;
  // Some classes of three define how values are encoded, such as half floats, so the class must be kept.
  const Class = attribute.constructor as typeof BufferAttribute;
  return Object.assign(new Class(values, itemSize, normalized), { name, usage, gpuType });
}
