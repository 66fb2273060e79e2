// Made by wasm/tools/generate.mjs from core/include/cagecast/codes.def. Do not edit.

/** Errors that the core reports. */
export type CoreCode =
  /** A mesh has no vertices or no triangles. */
  | 'emptyMesh'
  /** The number of position floats (`at`) is not a multiple of three. */
  | 'positionsNotTriples'
  /** The number of indices (`at`; 0 from `splitVertices`) is not a multiple of three. */
  | 'indicesNotTriples'
  /** The cage has no UVs. */
  | 'missingUvs'
  /** There are not two UV floats per vertex; `at` is their number. */
  | 'uvCountMismatch'
  /** There is not one group per vertex; `at` is their number. */
  | 'groupCountMismatch'
  /** There are not two UV floats per index; `at` is their number. */
  | 'cornerUvCountMismatch'
  /** An index is not less than the number of vertices; `at` is its position in `indices`. */
  | 'indexOutOfRange'
  /** A coordinate is not a finite number; `at` is its position in `positions`. */
  | 'nonFinitePosition'
  /** A UV is not a finite number; `at` is its position in `uvs`. */
  | 'nonFiniteUv'
  /** There are not as many floats per pose as in `positions`; `at` is their number. */
  | 'poseCountMismatch'
  /**
   * A coordinate of a pose is not a finite number, or too far from the origin (see `tooLarge`); `at` is its position in
   * `poses`.
   */
  | 'badPose'
  /** Every triangle of the cage has zero area. */
  | 'noUsableCageTriangle'
  /**
   * More vertices or triangles than the limit (`at` says how many), or a coordinate too far from the origin, for the
   * size of the target or for distances to fit a float (`at` is its position in `positions`).
   */
  | 'tooLarge'
  /**
   * The value of `option` is out of its range, or a lock (`at`) names a segment or a group that does not exist, or is
   * none of the three; or the masks are not as many as the vertices or triangles (`at` is their number), or one of them
   * (`at`) is none of the three.
   */
  | 'badOption'
  /** The given zones, segments or holes do not belong together or to this target; `at` is the number of zones. */
  | 'resultMismatch'
  /**
   * Cutting borders takes more than its limit, which follows from the number of triangles and of border edges of the
   * cage (`at`).
   */
  | 'bordersTooComplex'
  /** More vertices of the target lie within `weldTolerance` of each other than the limit, an average of 2000. */
  | 'weldToleranceTooLarge'
  /**
   * Rays and searches met more triangles than a limit, which follows from the size of the target: triangles of target
   * or cage lie in each other in thousands of layers.
   */
  | 'tooComplex'
  /** There is not enough memory for the call or its result; nothing was computed. */
  | 'outOfMemory';
