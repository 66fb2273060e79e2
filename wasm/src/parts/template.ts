/** A mesh with UVs, as a template is. */
export interface TemplateMesh {
  positions: Float32Array;
  uvs: Float32Array;
  indices: Uint32Array;
}

/** A closed outline in UVs: its corners, at least 3. */
export type Outline = readonly (readonly [u: number, v: number])[];

/** Whether a value is a region: outlines, at least one. */
export const isRegion = (value: unknown): value is Outline[] =>
  Array.isArray(value) &&
  value.length > 0 &&
  value.every(
    (outline: unknown) =>
      Array.isArray(outline) &&
      outline.length >= 3 &&
      outline.every((uv: unknown) => Array.isArray(uv) && uv.length === 2 && uv.every((x) => Number.isFinite(x))),
  );

/** What a cage's node or mesh has in its extras: docs/cages.md describes the format. */
export interface CageExtras {
  landmarks: Record<string, [number, number, number]>;
  holes: Record<string, number[]>;
  kind: 'automatic' | 'head' | 'body' | 'prop';
  regions?: Record<string, Outline[]>;
  bare?: string[];
}
