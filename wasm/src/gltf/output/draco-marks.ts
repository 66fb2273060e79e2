import type { GLTF } from '@gltf-transform/core';

export const dracoExtension = 'KHR_draco_mesh_compression';

/** Marks primitives to be compressed by `packDraco`. */
export function markForDraco(primitives: readonly GLTF.IMeshPrimitive[]): void {
  for (const primitive of primitives)
    primitive.extensions = { ...primitive.extensions, [dracoExtension]: { bufferView: -1, attributes: {} } };
}

/** Takes Draco's stream from primitives whose attributes are to be stored in another form. */
export function unmarkDraco(primitives: readonly GLTF.IMeshPrimitive[]): void {
  for (const primitive of primitives) {
    delete primitive.extensions?.[dracoExtension];
    if (primitive.extensions && Object.keys(primitive.extensions).length === 0) delete primitive.extensions;
  }
}
