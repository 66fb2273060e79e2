/** The time of each step, in milliseconds of wall time. */
export interface Timings {
  /** Checking the input and welding the target's vertices. */
  weld: number;
  /** Building the search trees of cage and target, and the cage's boundary loops. */
  build: number;
  /** Step 1: the nearest point of the cage for every point of the target. */
  project: number;
  /** Step 2: rays against the target. */
  occluded: number;
  /** Steps 2′ and 3: where rays meet the cage. */
  covered: number;
  /**
   * Steps 4, 5′ and 5″: connected components, their areas and twins; with steps 1 to 3 of interior samples, and writing the results
   * of all steps per vertex.
   */
  segments: number;
  /** Step 6: more rays from occluded points. */
  recheck: number;
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
