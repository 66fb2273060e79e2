import { BufferAttribute, type BufferGeometry, type InterleavedBufferAttribute, type TypedArray } from 'three';
import { gather, type SplitPart } from '../split-part.js';

/**
 * Gives a geometry copies of vertices, in all of its attributes and morph targets. It stays the same object, and its buffers
 * on the graphics card, if it has any, are made anew.
 */
export function splitGeometry(geometry: BufferGeometry, { sources, indices }: SplitPart): void {
  geometry.dispose();
  for (const [name, attribute] of Object.entries(geometry.attributes)) {
    if (!('isInstancedBufferAttribute' in attribute)) geometry.setAttribute(name, splitAttribute(attribute, sources));
  }
  for (const [name, morphs] of Object.entries(geometry.morphAttributes)) {
    geometry.morphAttributes[name as keyof typeof geometry.morphAttributes] = morphs!.map((morph) => splitAttribute(morph, sources));
  }
  geometry.setIndex(new BufferAttribute(indices, 1));
}

function splitAttribute(attribute: BufferAttribute | InterleavedBufferAttribute, sources: Uint32Array): BufferAttribute {
  const { itemSize, normalized } = attribute;
  // What makes the values of a class of three's own what they are, as of half floats, is in the class.
  const Class = ('isInterleavedBufferAttribute' in attribute ? BufferAttribute : attribute.constructor) as typeof BufferAttribute;
  const split = new Class(gather(valuesOf(attribute) as Float32Array, itemSize, sources), itemSize, normalized);
  split.name = attribute.name;
  if (!('isInterleavedBufferAttribute' in attribute)) {
    split.usage = attribute.usage;
    split.gpuType = attribute.gpuType;
  }
  return split;
}

/** The values of an attribute as they are stored, one element after the other. */
function valuesOf(attribute: BufferAttribute | InterleavedBufferAttribute): TypedArray {
  if (!('isInterleavedBufferAttribute' in attribute)) return attribute.array;
  const { array, stride } = attribute.data;
  const { itemSize, offset, count } = attribute;
  const own = array.slice(0, itemSize * count);
  for (let i = 0; i < own.length; ++i) own[i] = array[stride * Math.floor(i / itemSize) + offset + (i % itemSize)]!;
  return own;
}
