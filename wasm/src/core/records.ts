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
  /** Steps 3 and 6: where rays meet the cage. */
  covered: number;
  /**
   * Steps 4 and 7: connected components and their areas; with steps 1 to 3 of interior samples, and writing the results of all steps
   * per vertex.
   */
  segments: number;
  /** Step 9: more rays from occluded points. */
  recheck: number;
  /** Step 13: what is seen in poses of the target. */
  motion: number;
  /** Step 10: uncovered points and the holes over them. */
  holes: number;
  /** Step 12: UVs per triangle corner. */
  seams: number;
  /** Steps 5, 8, 10 and 11: which segments are culled, and the zones of vertices and triangles. 0 after `project`. */
  classify: number;
  /** The whole call. */
  total: number;
}

/**
 * The ratios of a segment, by rule: of an amount that it has to the amount that the rule asks for. It meets a rule from
 * 1 on; `Infinity` if the rule asks for nothing, and after `project`.
 */
export interface Ratios {
  /** Step 5: coverage / `threshold`. */
  threshold: number;
  /** Step 8: covered area / needed area. */
  floor: number;
  /** Step 8: greatest depth allowed / depth. */
  depth: number;
  /** Step 10: area allowed in a hole / area there; the least. */
  hole: number;
}

/** The properties of one segment, a connected component of the target. Areas are in squared units of the input. */
export interface SegmentStats {
  /** Number of welded points. */
  points: number;
  /** A: its whole area. */
  area: number;
  /** The part of A beyond outer borders of the cage, occluded or not. */
  beyondArea: number;
  /** E: the area that is neither occluded nor beyond. */
  exposedArea: number;
  /** C: the exposed area that the cage covers. */
  coveredArea: number;
  /** F = C / E, the share of the exposed area that the cage covers; 0 if nothing is exposed. */
  coverage: number;
  /**
   * The mean distance of its covered area from the cage, as a share of the target's diagonal; a distance of more than one diagonal
   * counts as one. 0 if nothing is covered.
   */
  depth: number;
  /** The group of its first vertex, in `target.groups`; 0 if the target has none. */
  group: number;
  ratios: Ratios;
  /** The least of `ratios`: a segment with a score of at least 1 is kept, unless a lock decides. */
  score: number;
  /**
   * How sure the verdict is: 1 − min(score, 1 / score)⁴ / 2, so 0.5 for a score of 1, 0.9 for 1.5 or 0.67, and 1 far from it, where a
   * lock decides, or after `project`. Of verdicts with 0.9 and more, over 90 % are right under cages that are out of place by up to
   * 2 % of the target's diagonal.
   */
  confidence: number;
  /** Whether none of it may be painted. `false` after `project`, but for what is ignored. */
  culled: boolean;
  /**
   * Why it is culled. `coverage`: the cage covers too little of it, or it lies too deep: one of `ratios` but `hole` is below 1.
   * `hole`: a hole of the cage is meant for it: only `ratios.hole` is below 1. `lock`: a lock or `parts.exclude` excludes it. `ignore`:
   * `parts.ignore` names it, so it is not there: it has no points and no area.
   */
  culledBy: 'none' | 'coverage' | 'hole' | 'lock' | 'ignore';
}

/**
 * The part of a segment that lies nearest to one hole of the cage. All areas are those at this hole only, and of points only,
 * without interior samples; in squared units of the input.
 */
export interface HoleShare {
  /** The number of the hole, in the order of the cage's open edges; `inspect` lists the largest first. */
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
