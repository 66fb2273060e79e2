import { BufferAttribute, type BufferGeometry, type InterleavedBufferAttribute, type TypedArray } from 'three';
import { gather, type SplitPart } from '../parts/split-part.js';

export type Attribute = BufferAttribute | InterleavedBufferAttribute;

/** Adds copies of vertices to a geometry, in all attributes and morph targets. The geometry stays the same object. */
export function splitGeometry(geometry: BufferGeometry, { sources, indices }: SplitPart): void {
  remakeGeometry(geometry, indices, (attribute) =>
    likeAttribute(attribute, gather(valuesOf(attribute) as Float32Array, attribute.itemSize, sources)),
  );
}

/** The values of an attribute as they are stored, one element after the other. */
export function valuesOf(attribute: Attribute): TypedArray {
  if (!('isInterleavedBufferAttribute' in attribute)) return attribute.array;
  const { array, stride } = attribute.data;
  const { itemSize, offset, count } = attribute;
  const own = array.slice(0, itemSize * count);
  for (let i = 0; i < own.length; ++i) own[i] = array[stride * Math.floor(i / itemSize) + offset + (i % itemSize)]!;
  return own;
}

/** An attribute of the same kind with other values. */
export function likeAttribute(attribute: Attribute, values: TypedArray): BufferAttribute {
  const { itemSize, normalized } = attribute;
  // Some classes of three define how values are encoded, such as half floats, so the class must be kept.
  const Class = (
    'isInterleavedBufferAttribute' in attribute ? BufferAttribute : attribute.constructor
  ) as typeof BufferAttribute;
  const made = new Class(values, itemSize, normalized);
  made.name = attribute.name;
  if (!('isInterleavedBufferAttribute' in attribute)) {
    made.usage = attribute.usage;
    made.gpuType = attribute.gpuType;
  }
  return made;
}

/** Replaces all attributes, morph targets and triangles of a geometry, and has its GPU buffers made again. */
export function remakeGeometry(
  geometry: BufferGeometry,
  indices: Uint32Array,
  remake: (attribute: Attribute, name: string, isMorph: boolean) => BufferAttribute,
): void {
  geometry.dispose();
  for (const [name, attribute] of Object.entries(geometry.attributes))
    geometry.setAttribute(name, remake(attribute, name, false));
  for (const [name, morphs] of Object.entries(geometry.morphAttributes)) {
    geometry.morphAttributes[name as keyof typeof geometry.morphAttributes] = morphs!.map((morph) =>
      remake(morph, name, true),
    );
  }
  geometry.setIndex(new BufferAttribute(indices, 1));
}
