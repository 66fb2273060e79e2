import type { Document, Node, Primitive, Property } from '@gltf-transform/core';
import { type InPlace, isMarked } from '../../scene/overlay-mark.js';
import { isOfTransfer } from '../overlay.js';

/** Disposes an unused property, and then the properties that only it used. */
export function disposeUnused(document: Document, property: Property): void {
  if (property.isDisposed() || property.listParents().some((parent) => parent.propertyType !== 'Root')) return;
  const used = document.getGraph().listChildren(property);
  property.dispose();
  for (const child of used) disposeUnused(document, child);
}

/** Removes the UVs and zones of an earlier transfer from primitives. */
export function removeAttributes(document: Document, primitives: readonly Primitive[]): void {
  for (const primitive of primitives) {
    for (const semantic of primitive.listSemantics()) {
      const accessor = primitive.getAttribute(semantic)!;
      if (!isOfTransfer(semantic, accessor.getExtras())) continue;
      primitive.setAttribute(semantic, null);
      disposeUnused(document, accessor);
    }
  }
}

/** Removes the overlays of earlier transfers from the meshes of nodes, with all that only they used. */
export function removeOverlays(document: Document, nodes: Iterable<Node>): void {
  for (const node of nodes) {
    const mesh = node.getMesh()!;
    const primitives = mesh.listPrimitives();
    for (const primitive of primitives) {
      const ofMaterial = primitive.getMaterial()?.getExtras();
      if (!isMarked(primitive.getExtras(), ofMaterial)) continue;
      const base = primitives[(primitive.getExtras() as InPlace).cagecastInPlaceOf ?? -1];
      const isBase = base && !isMarked(base.getExtras());
      if (isBase && base.getAttribute('POSITION') === primitive.getAttribute('POSITION')) giveBack(base, primitive);
      else if (ofMaterial?.['cagecastInPlace']) continue; // a part of the model now
      mesh.removePrimitive(primitive);
      disposeUnused(document, primitive);
    }
  }
}

/** Gives a primitive the triangles back that an overlay has in their place. */
function giveBack(base: Primitive, overlay: Primitive): void {
  const [own, more] = [base.getIndices()!, overlay.getIndices()!];
  const all = Uint32Array.from([...own.getArray()!, ...more.getArray()!]);
  const isShort = base.getAttribute('POSITION')!.getCount() < 65536;
  base.setIndices(own.clone().setArray(isShort ? Uint16Array.from(all) : all));
}
