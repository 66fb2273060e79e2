import type { GLTF } from '@gltf-transform/core';

/** The numbers of an accessor. Those of glTF-Transform are such, too. */
export interface AccessorData {
  /** Its components, without padding; null if it has none. */
  getArray(): ArrayData | null;
  getCount(): number;
  /** Components of an element. */
  getElementSize(): number;
  getType(): GLTF.AccessorType;
  getNormalized(): boolean;
}

export type ArrayData = Float32Array | Int8Array | Uint8Array | Int16Array | Uint16Array | Uint32Array;

/** All components of an accessor as 32-bit floats, with normalised integers decoded. */
export function decodeFloats(accessor: AccessorData): Float32Array {
  const array = accessor.getArray()!;
  if (array instanceof Float32Array) return array;
  if (!accessor.getNormalized()) return Float32Array.from(array as ArrayLike<number>);
  const most =
    2 ** (8 * array.BYTES_PER_ELEMENT - (array instanceof Int8Array || array instanceof Int16Array ? 1 : 0)) - 1;
  return Float32Array.from(array as ArrayLike<number>, (x) => Math.max(x / most, -1));
}
