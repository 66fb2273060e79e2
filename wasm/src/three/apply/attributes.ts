import type { BufferAttribute, BufferGeometry, InterleavedBufferAttribute } from 'three';

/** The attribute with the `Zone` of each vertex. GLTFLoader gives `_NCZ` the same name. */
export const zoneAttribute = '_ncz';

export type Attribute = BufferAttribute | InterleavedBufferAttribute;

/** The numbers of an attribute, decoded, to be read only: its own array if that has nothing else. */
export function valuesOf(attribute: Attribute): Float32Array {
  const { count, itemSize, array } = attribute;
  if (array instanceof Float32Array && !('isInterleavedBufferAttribute' in attribute)) return array;
  const values = new Float32Array(count * itemSize);
  // Half floats are decoded by these, not by `getComponent`.
  const get = (['getX', 'getY', 'getZ', 'getW'] as const).slice(0, itemSize);
  for (let k = 0; k < get.length; ++k) for (let i = 0; i < count; ++i) values[i * itemSize + k] = attribute[get[k]!](i);
  return values;
}

/** How a morph target moves the positions of a geometry; `undefined` if there is none. */
export function targetDeltas(geometry: BufferGeometry, target: number): Float32Array | undefined {
  const shape = geometry.morphAttributes.position?.[target];
  if (!shape) return undefined;
  const values = valuesOf(shape as Attribute);
  if (geometry.morphTargetsRelative) return values;
  return valuesOf(geometry.getAttribute('position') as Attribute).map((x, i) => values[i]! - x);
}
