/** A mesh with UVs, as a template is. */
export interface TemplateMesh {
  positions: Float32Array;
  uvs: Float32Array;
  indices: Uint32Array;
}

/** What a cage's node or mesh has in its extras: docs/cages.md describes the format. */
export interface CageExtras {
  landmarks: Record<string, [number, number, number]>;
  holes: Record<string, number[]>;
  kind: 'automatic' | 'head' | 'body' | 'prop';
}
