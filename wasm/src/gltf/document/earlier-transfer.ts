import type { Primitive, Property } from '@gltf-transform/core';
import { isOfTransfer, isOverlay } from '../overlay.js';
import type { DocumentPart } from './read.js';

/** Disposes what nothing in its document uses any more. */
export function disposeUnused(property: Property | null): void {
  if (property?.listParents().every((parent) => parent.propertyType === 'Root')) property.dispose();
}

/** Takes the UVs and zones of an earlier transfer from primitives. */
export function takeAttributes(primitives: readonly Primitive[]): void {
  for (const primitive of primitives) {
    for (const semantic of primitive.listSemantics()) {
      const accessor = primitive.getAttribute(semantic)!;
      if (!isOfTransfer(semantic, accessor.getExtras())) continue;
      primitive.setAttribute(semantic, null);
      disposeUnused(accessor);
    }
  }
}

/** Takes the overlays of earlier transfers out of the meshes of parts, with all that only they used. */
export function takeOverlays(parts: readonly DocumentPart[]): void {
  for (const mesh of new Set(parts.map(({ node }) => node.getMesh()!))) {
    for (const overlay of mesh.listPrimitives().filter((primitive) => isOverlay(primitive.getExtras()))) {
      mesh.removePrimitive(overlay);
      if (overlay.listParents().some((parent) => parent.propertyType !== 'Root')) continue;
      const material = overlay.getMaterial();
      const texture = material?.getBaseColorTexture() ?? null;
      const targets = overlay.listTargets();
      const accessors = [overlay, ...targets].flatMap((of) => of.listSemantics().map((name) => of.getAttribute(name)));
      const indices = overlay.getIndices();
      overlay.dispose();
      [...targets, ...accessors, indices, material].forEach(disposeUnused);
      if (material?.isDisposed()) disposeUnused(texture);
    }
  }
}
