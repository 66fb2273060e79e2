import type { Matrix } from '../parts/affine.js';
import { type AccessorData, decodeFloats } from './accessor.js';
import { InputError } from './input-error.js';
import { localMatrix } from './matrix.js';

/** The extension by which a node draws many instances of its mesh. */
export const instancing = 'EXT_mesh_gpu_instancing';

/**
 * The place of the first instance in the space of its node. A vertex has one UV for all instances, so the mesh is taken once, where
 * this one is.
 * @param attribute  The accessor of TRANSLATION, ROTATION or SCALE, if there is one.
 * @throws {InputError} that begins with `place`, if there is no instance, or its place is not of finite numbers.
 */
export function firstInstance(place: string, attribute: (semantic: string) => AccessorData | null | undefined): Matrix {
  const read = (semantic: string, size: number): number[] | undefined => {
    const accessor = attribute(semantic);
    if (!accessor) return undefined;
    if (accessor.getCount() === 0) throw new InputError(`${place} has no instance`);
    const value = [...decodeFloats(accessor).subarray(0, accessor.getElementSize())];
    if (accessor.getElementSize() !== size || !value.every(Number.isFinite))
      throw new InputError(`${place}: ${semantic} of ${instancing} is not of ${size} finite numbers`);
    return value;
  };
  return localMatrix({ translation: read('TRANSLATION', 3), rotation: read('ROTATION', 4), scale: read('SCALE', 3) });
}
