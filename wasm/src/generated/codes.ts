// Made by wasm/tools/generate.mjs from core/include/cagecast/codes.def. Do not edit.

/** What the core finds wrong. */
export type CoreCode =
  /** A mesh without vertices or without triangles. */
  | 'emptyMesh'
  /** The number of position floats is not a multiple of three. */
  | 'positionsNotTriples'
  /** The number of indices is not a multiple of three. */
  | 'indicesNotTriples'
  /** The cage has no UVs. */
  | 'missingUvs'
  /** UVs are not two per vertex. */
  | 'uvCountMismatch'
  /** Groups are not one per vertex. */
  | 'groupCountMismatch'
  /** UVs per corner are not two per index. */
  | 'cornerUvCountMismatch'
  /** An index is not less than the number of vertices; `at` is its place in `indices`. */
  | 'indexOutOfRange'
  /** A coordinate is not a finite number; `at` is its place in `positions`. */
  | 'nonFinitePosition'
  /** A UV is not a finite number; `at` is its place in `uvs`. */
  | 'nonFiniteUv'
  /** Every triangle of the cage has zero area. */
  | 'noUsableCageTriangle'
  /**
   * More vertices or triangles than the limit (`at` says how many), or a coordinate too far from the origin for the
   * size of the target (`at` is its place in `positions`).
   */
  | 'tooLarge'
  /** The value of `option` is out of its range, or a lock names a segment or a group that does not exist (`at`). */
  | 'badOption'
  /** The given zones or segments do not belong to this target; `at` is the number of zones. */
  | 'resultMismatch'
  /** The work or its result does not fit into memory; nothing was computed. */
  | 'outOfMemory';
