import type { Preset } from './options.js';

/** The time of each step, in milliseconds. */
export interface Timings {
  /** Checking the input and welding the target's vertices. */
  weld: number;
  /** Building the search trees of cage and target, and the cage's boundary loops. */
  build: number;
  /** Step 1: the nearest point of the cage for every point of the target. */
  project: number;
  /** Step 2: self-intersection. */
  occluded: number;
  /** Step 3: cage intersection. */
  covered: number;
  /** Steps 4, 5′ and 5″: connected components, their areas and twins. */
  segments: number;
  /** Step 6: more rays from occluded points. */
  secondLook: number;
  /** Step 7: uncovered points and the holes over them. */
  holes: number;
  /** Step 9: UVs per triangle corner. */
  seams: number;
  /** Steps 5 and 8: which segments are culled, and the zones of vertices and triangles. 0 after `project`. */
  classify: number;
  /** The whole call. */
  total: number;
}

/** The properties of one segment, a connected component of the target. Areas are in squared units of the input. */
export interface SegmentStats {
  /** Number of welded points. */
  points: number;
  /** A: its whole area. */
  area: number;
  /** E: the area that is not occluded. */
  exposedArea: number;
  /** C: the exposed area that the cage covers. */
  coveredArea: number;
  /** F = C / E, the share of the exposed area that the cage covers; 0 if nothing is exposed. */
  coverage: number;
  /** D: C, weighted less where it is unusually deep under the cage; equal to C without `steps.depthWeighting`. */
  depthWeightedArea: number;
  /** The group of its first vertex, in `target.groups`; 0 if the target has none. */
  group: number;
  /** The first segment of the same shape, or itself; itself without `steps.depthWeighting`. */
  twinOf: number;
  /**
   * How well it meets the rules of step 5, as the ratio of actual to required area: a segment with a score of at least 1 is kept,
   * unless a lock decides. Infinity if no area is required, and after `project`.
   */
  score: number;
  /** Whether none of it may be painted. `false` after `project`. */
  culled: boolean;
  /**
   * Why it is culled. `coverage`: its score is below 1, because of the threshold, the floor or its twins. `hole`: a hole of the cage
   * is meant for it. `lock`: a lock excludes it.
   */
  culledBy: 'none' | 'coverage' | 'hole' | 'lock';
}

/** What `project` and `transfer` both return. The caller owns every array. */
export interface Projected {
  /** 2 per target vertex, in every zone: its UV in the cage's texture. */
  uvs: Float32Array<ArrayBuffer>;
  /**
   * 2 per triangle corner, in the order of `target.indices`, with `seams: 'corner'`; else empty. They differ from `uvs` only where
   * a seam of the cage's texture runs through a triangle. `splitVertices` makes a mesh from them.
   */
  cornerUvs: Float32Array<ArrayBuffer>;
  /** 1 per vertex, a `Zone`. After `project` none is `Culled`, and `Cosmetic` means covered. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per vertex: the nearest triangle of the cage. */
  triangles: Uint32Array<ArrayBuffer>;
  /** 1 per vertex: the distance to it, in units of the input. */
  distances: Float32Array<ArrayBuffer>;
  /** 1 per vertex: its segment. Segments are numbered by their first vertex. */
  segments: Uint32Array<ArrayBuffer>;
  /** 1 per segment. */
  segmentStats: SegmentStats[];
  /** How long each step took. */
  timings: Timings;
  /** Peak memory during the call in bytes, without the inputs. */
  peakBytes: number;
}

/**
 * The part of a segment that lies nearest to one hole of the cage. All areas are those at this hole only, and of points only,
 * without interior samples; in squared units of the input.
 */
export interface HoleShare {
  /** The number of the hole. */
  hole: number;
  /** The number of the segment. */
  segment: number;
  /** Area that is not occluded. */
  exposedArea: number;
  /** Exposed area that the cage does not cover. */
  uncoveredArea: number;
  /**
   * Occluded area that the cage does not cover; 0 if `occlusionReach` is infinite or nothing of the segment is covered.
   */
  hiddenArea: number;
}

/** The part of the result that does not depend on the threshold: plain data that can be kept, sent or stored. */
export interface Projection extends Projected {
  /** The preset of the projection, which is also the default preset for `classify`. */
  preset: Preset;
  /**
   * 1 per vertex, with `steps.secondLook` or `steps.holes`; else empty. Whether an occluded or uncovered vertex becomes cosmetic if
   * its segment is kept: 0 never, 1 always, 2 and above if a culled segment lies behind hole number `value - 2` and explains it.
   */
  recovery: Uint32Array<ArrayBuffer>;
  /** 1 per hole and segment near it, with `steps.holes`; ordered by hole. */
  holeShares: HoleShare[];
  /** The target's indices, 3 per triangle. */
  indices: Uint32Array<ArrayBuffer>;
}

/** The part of the result that depends on the threshold. The caller owns every array. */
export interface Classification {
  /** 1 per target vertex, a `Zone`. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per target triangle: 1 if it may be painted; see `steps.partialTriangles`. */
  cosmeticTriangles: Uint8Array<ArrayBuffer>;
  /** 1 per segment, with `culled`, `culledBy` and `score`. */
  segmentStats: SegmentStats[];
}

/** The result of `transfer`. */
export interface TransferResult extends Projected, Classification {}
