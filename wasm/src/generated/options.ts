// Made by wasm/tools/generate.mjs from core/include/cagecast/options.def. Do not edit.

/** Options that `project` reads. */
export interface ProjectStage {
  /**
   * Where UVs are kept: per vertex, or also per triangle corner, so that no triangle stretches across a seam of the
   * texture. `vertex` or `corner`. Default: `corner`; in the preset `paper`: `vertex`.
   */
  seams?: 'vertex' | 'corner' | undefined;
  /**
   * Vertices closer together than this count as one point. 0 to 0.01, as a share of the target's diagonal. Default:
   * `0`.
   */
  weldTolerance?: number | undefined;
  /**
   * How far beyond the cage the target can still occlude a point. At least 0, as a share of the target's diagonal.
   * Default: `0.03`; in the preset `paper`: `Infinity`.
   */
  occlusionReach?: number | undefined;
  /**
   * How far a point may poke out of the cage and still count as covered. 0 to 1, as a share of the target's diagonal.
   * Default: `0.0025`; in the preset `paper`: `0`.
   */
  pokeThrough?: number | undefined;
}

/** Options that `classify` reads. */
export interface ClassifyStage {
  /**
   * A segment is painted only if at least this share of its exposed area is covered by the cage. 0 to 1. Default:
   * `0.5`.
   */
  threshold?: number | undefined;
  /**
   * A segment is painted only if at least this share of its whole area is covered; needs a floor. 0 to 1. Default:
   * `0.2`.
   */
  minCovered?: number | undefined;
}

/** Switches of the steps in `project`, for measuring them. */
export interface ProjectSteps {
  /**
   * How a vertex finds its place on the cage: at the nearest point of the surface, or, as a baseline, at the nearest
   * vertex with nothing filtered. `nearestPoint` or `nearestVertex`. Default: `nearestPoint`.
   */
  projection?: 'nearestPoint' | 'nearestVertex' | undefined;
  /**
   * Step 4′: large triangles of small segments near a hole are sampled inside instead of at their corners. True or
   * false. Default: `true`; in the preset `paper`: `false`.
   */
  interiorSamples?: boolean | undefined;
  /**
   * Step 4′: a hole is near a segment if it is no farther than the cage; otherwise only within 0.01 of the diagonal.
   * True or false. Default: `true`; in the preset `paper`: `false`.
   */
  farLoops?: boolean | undefined;
  /**
   * Step 5′: covered area counts less the deeper it lies under the cage; also finds the twins among segments. True or
   * false. Default: `true`; in the preset `paper`: `false`.
   */
  depthWeighting?: boolean | undefined;
  /**
   * Step 6: restores occluded points that can be seen from the cage in another direction. True or false. Default:
   * `true`; in the preset `paper`: `false`.
   */
  secondLook?: boolean | undefined;
  /**
   * Step 6: points whose triangles all have copies in reverse winding look to both sides. True or false. Default:
   * `true`; in the preset `paper`: `false`.
   */
  bothSides?: boolean | undefined;
  /**
   * Step 6: only the exposed points of a segment decide to which side its points look. True or false. Default: `true`;
   * in the preset `paper`: `false`.
   */
  exposedSide?: boolean | undefined;
  /**
   * Step 7: restores uncovered points unless the hole over them is meant for them. True or false. Default: `true`; in
   * the preset `paper`: `false`.
   */
  holes?: boolean | undefined;
}

/** Switches of the steps in `classify`, for measuring them. */
export interface ClassifySteps {
  /**
   * Step 5′: what a segment needs besides the threshold: nothing, enough covered area, or enough depth-weighted area.
   * `none` or `area` or `depth`. Default: `depth`; in the preset `paper`: `none`.
   */
  floor?: 'none' | 'area' | 'depth' | undefined;
  /**
   * Step 5′: with floor 'depth', this share of the covered area of all segments is enough as well. 0 to 1. Default:
   * `0.005`.
   */
  minOfAll?: number | undefined;
  /**
   * Step 5′: a segment that minOfAll lets pass is uncovered in at most this share of its exposed area. 0 to 1. Default:
   * `0.25`.
   */
  maxUncovered?: number | undefined;
  /**
   * Step 5′: twins with scores near 1 are judged together; needs a floor. True or false. Default: `true`; in the preset
   * `paper`: `false`.
   */
  twins?: boolean | undefined;
  /**
   * Step 5″: culls small segments that a hole of the cage is meant for; needs holes. True or false. Default: `true`; in
   * the preset `paper`: `false`.
   */
  holeContents?: boolean | undefined;
  /**
   * Step 8: a triangle is painted if one corner is cosmetic and the others are cosmetic or occluded; otherwise all
   * three must be cosmetic. True or false. Default: `true`; in the preset `paper`: `false`.
   */
  partialTriangles?: boolean | undefined;
}

/** Every option: which function reads it, whether it is in `steps`, and what its values are. */
export const optionTable = {
  threshold: { stage: 'classify', isStep: false, kind: 'share' },
  seams: { stage: 'project', isStep: false, kind: 'choice', type: 'Seams' },
  weldTolerance: { stage: 'project', isStep: false, kind: 'length' },
  occlusionReach: { stage: 'project', isStep: false, kind: 'length' },
  pokeThrough: { stage: 'project', isStep: false, kind: 'length' },
  minCovered: { stage: 'classify', isStep: false, kind: 'share' },
  projection: { stage: 'project', isStep: true, kind: 'choice', type: 'ProjectionMode' },
  interiorSamples: { stage: 'project', isStep: true, kind: 'toggle' },
  farLoops: { stage: 'project', isStep: true, kind: 'toggle' },
  depthWeighting: { stage: 'project', isStep: true, kind: 'toggle' },
  secondLook: { stage: 'project', isStep: true, kind: 'toggle' },
  bothSides: { stage: 'project', isStep: true, kind: 'toggle' },
  exposedSide: { stage: 'project', isStep: true, kind: 'toggle' },
  holes: { stage: 'project', isStep: true, kind: 'toggle' },
  floor: { stage: 'classify', isStep: true, kind: 'choice', type: 'Floor' },
  minOfAll: { stage: 'classify', isStep: true, kind: 'share' },
  maxUncovered: { stage: 'classify', isStep: true, kind: 'share' },
  twins: { stage: 'classify', isStep: true, kind: 'toggle' },
  holeContents: { stage: 'classify', isStep: true, kind: 'toggle' },
  partialTriangles: { stage: 'classify', isStep: true, kind: 'toggle' },
} as const;

/** The command's flags, one for each option outside `steps`. */
export const optionFlags = [
  {
    name: 'threshold',
    flag: '--threshold',
    kind: 'share',
    range: [0, 1],
    text: 'A segment is painted only if at least this share of its exposed area is covered by the cage.',
  },
  {
    name: 'seams',
    flag: '--seams',
    kind: 'choice',
    range: ['vertex', 'corner'],
    text: 'Where UVs are kept: per vertex, or also per triangle corner, so that no triangle stretches across a seam of the texture.',
  },
  {
    name: 'weldTolerance',
    flag: '--weld-tolerance',
    kind: 'length',
    range: [0, 0.01],
    text: 'Vertices closer together than this count as one point.',
  },
  {
    name: 'occlusionReach',
    flag: '--occlusion-reach',
    kind: 'length',
    range: [0, Infinity],
    text: 'How far beyond the cage the target can still occlude a point.',
  },
  {
    name: 'pokeThrough',
    flag: '--poke-through',
    kind: 'length',
    range: [0, 1],
    text: 'How far a point may poke out of the cage and still count as covered.',
  },
  {
    name: 'minCovered',
    flag: '--min-covered',
    kind: 'share',
    range: [0, 1],
    text: 'A segment is painted only if at least this share of its whole area is covered; needs a floor.',
  },
] as const;
