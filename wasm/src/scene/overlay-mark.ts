import type { GLTF } from '@gltf-transform/core';

/**
 * Marks overlays in their `extras`, so that they are skipped when the model is read again; and their materials, as tools that join
 * primitives keep only these. `cagecast/three` uses the same name.
 */
export const overlayMark = { cagecastOverlay: true } as const;

/** Whether a primitive is an overlay, by the `extras` of it and of its material. */
export const isMarked = (...extras: readonly (object | undefined)[]): boolean =>
  extras.some((one) => (one as Partial<typeof overlayMark> | undefined)?.cagecastOverlay);

/** Whether a primitive of a file is an overlay. */
export const isOverlay = ({ extras, material = -1 }: GLTF.IMeshPrimitive, { materials }: GLTF.IGLTF): boolean =>
  isMarked(extras, materials?.[material]?.extras);
