import { type BufferGeometry, REVISION } from 'three';

/** Attributes that were made here, and that one geometry alone has. */
const owned = new WeakSet<object>();

/** Notes that one geometry alone has an attribute. */
export function own<Attribute extends object>(attribute: Attribute): Attribute {
  owned.add(attribute);
  return attribute;
}

/** Notes that several geometries have an attribute. */
export const disown = (attribute: object): boolean => owned.delete(attribute);

/**
 * Frees the GPU buffers of a geometry, which stays as it is and may be drawn again. Buffers of attributes that others may have, as
 * geometries of GLTFLoader do, are kept: three.js would not notice that they are gone, and would draw nothing of the others.
 * @param names  Of attributes that are taken off or replaced: only these are freed. Default: all, and the index.
 */
export function disposeOwn(geometry: BufferGeometry, names?: readonly string[]): void {
  const { attributes, morphAttributes, index } = geometry;
  const own = Object.entries(attributes).filter(([name, one]) => owned.has(one) && names?.includes(name) !== false);
  const ownIndex = names || !owned.has(index as object) ? null : index;
  Object.assign(geometry, { attributes: Object.fromEntries(own), morphAttributes: {}, index: ownIndex });
  try {
    geometry.dispose();
  } catch (error) {
    // Up to three.js r185, WebGPURenderer stops at an attribute that is missing; its buffers are left to the garbage collector.
    if (Number.parseInt(REVISION, 10) > 185) throw error;
  } finally {
    Object.assign(geometry, { attributes, morphAttributes, index });
  }
}
