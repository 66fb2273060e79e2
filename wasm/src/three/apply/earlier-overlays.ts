// The overlays of an earlier transfer in a loaded model.

import { BufferAttribute, type Object3D, type Mesh as ThreeMesh } from 'three';
import type { InPlace } from '../../scene/overlay-mark.js';

/**
 * Whether something is an overlay, by the mark in its `userData`. GLTFLoader sets the same mark on geometries and materials of
 * overlays from a file, from their `extras` (gltf/overlay.ts). Lists of materials may have gaps.
 */
export const isMarked = (one?: Pick<Object3D, 'userData'>): boolean => one?.userData['cagecastOverlay'];

/**
 * Lays overlays of a loaded file that are drawn in place of triangles over them, and gives them back to their bases: what is seen stays the
 * same, and the model is whole.
 */
export function giveBackTriangles(root: Object3D): void {
  root.traverse((child) => {
    const { geometry, material, parent } = child as ThreeMesh;
    const { userData = {}, index, attributes } = geometry ?? {};
    const { geometry: base } = (parent?.children[(userData as InPlace).cagecastInPlaceOf ?? -1] ??
      {}) as Partial<ThreeMesh>;
    const position = attributes?.['position'];
    if (!base?.index || isMarked(base) || !index || !position || base.attributes['position'] !== position) return;
    const all = new Uint32Array(base.index.count + index.count);
    all.set(base.index.array);
    all.set(index.array, base.index.count);
    base.setIndex(new BufferAttribute(all, 1));
    delete (userData as InPlace).cagecastInPlaceOf;
    const one = [material].flat()[0]!;
    delete one.userData['cagecastInPlace'];
    Object.assign(one, { transparent: true, depthWrite: false, needsUpdate: true });
  });
}

/** Whether the base of an overlay is lost, so that it is a part of the model. */
export const isLost = ({ material }: ThreeMesh): boolean => [material].flat()[0]?.userData['cagecastInPlace'] === true;
