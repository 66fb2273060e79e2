import type { GLTF } from '@gltf-transform/core';

/**
 * Marks overlays in their `extras`, so that they are skipped when the model is read again; and their materials, as tools that join
 * primitives keep only these. `cagecast/three` uses the same name.
 */
export const overlayMark = { cagecastOverlay: true } as const;

/**
 * Marks overlays that are drawn in place of triangles of their base, which lacks these: by the number of the base among the primitives of
 * its mesh.
 */
export interface InPlace {
  cagecastInPlaceOf?: number;
}

/** Whether a primitive is an overlay, by the `extras` of it and of its material. */
export const isMarked = (...extras: readonly (object | undefined)[]): boolean =>
  extras.some((one) => (one as Partial<typeof overlayMark> | undefined)?.cagecastOverlay);

/** The primitive whose triangles an overlay has; undefined where it has none, or tools have changed the mesh. */
export function baseOf({ extras, attributes }: GLTF.IMeshPrimitive, mesh: GLTF.IMesh): GLTF.IMeshPrimitive | undefined {
  const base = mesh.primitives[(extras as InPlace | undefined)?.cagecastInPlaceOf ?? -1];
  return base && !isMarked(base.extras) && base.attributes['POSITION'] === attributes['POSITION'] ? base : undefined;
}

/** Whether a primitive of a file is an overlay. One in place of triangles that cannot be given back is a part of the model. */
export function isOverlay(primitive: GLTF.IMeshPrimitive, mesh: GLTF.IMesh, { materials }: GLTF.IGLTF): boolean {
  const { extras, material = -1 } = primitive;
  const ofMaterial = materials?.[material]?.extras as (object & { cagecastInPlace?: boolean }) | undefined;
  return isMarked(extras, ofMaterial) && (!ofMaterial?.cagecastInPlace || baseOf(primitive, mesh) !== undefined);
}

/** The overlays that have triangles of a primitive. */
export const overlaysInPlaceOf = (primitive: GLTF.IMeshPrimitive, mesh: GLTF.IMesh): GLTF.IMeshPrimitive[] =>
  mesh.primitives.filter((one) => isMarked(one.extras) && baseOf(one, mesh) === primitive);
