// Made by wasm/tools/generate.mjs from core/include/cagecast/options.def. Do not edit.

/** Options that `project` reads. */
export interface ProjectStage {
  /**
   * Whether UVs are given per vertex only, or also per triangle corner, so that no triangle stretches across a seam of
   * the texture. `vertex` or `corner`. Default: `corner`; in the preset `paper`: `vertex`.
   */
  seams?: 'vertex' | 'corner' | undefined;
  /**
   * Vertices of one group (primitive) that are closer together than this count as one point, and so do chains of them.
   * 0 to 0.01, as a share of the target's diagonal. Default: `0`.
   */
  weldTolerance?: number | undefined;
  /**
   * How far beyond the cage the target can still occlude a point. At least 0, as a share of the target's diagonal.
   * Default: `0.03`; in the preset `paper`: `Infinity`.
   */
  occlusionReach?: number | undefined;
  /**
   * How far a point may poke out of the cage, not at the border of a hole, and still count as covered. 0 to 1, as a
   * share of the target's diagonal. Default: `0.0025`; in the preset `paper`: `0`.
   */
  pokeThrough?: number | undefined;
  /**
   * Whether what comes into view when the face moves (an eyelid, the inner side of a lip) is painted as well, judged by
   * the target's poses. True or false. Default: `true`; in the preset `paper`: `false`.
   */
  motion?: boolean | undefined;
}

/** Options that `classify` reads. */
export interface ClassifyStage {
  /**
   * A segment (a connected part of the model) is painted only if the cage covers at least this share of its exposed
   * area (which no other surface hides). 0 to 1. Default: `0.5`.
   */
  threshold?: number | undefined;
  /**
   * A segment is painted only if its covered area, times the covered share of its exposed area, is at least this share
   * of its whole area. A large segment that is clearly covered where it is exposed is painted anyway. No effect with
   * the preset paper. 0 to 1. Default: `0.2`.
   */
  minCovered?: number | undefined;
}

/** Switches for single steps in `project`, for measuring them. */
export interface ProjectSteps {
  /**
   * Where a vertex takes its UV from: the nearest point on the surface of the cage, or, as a baseline without any
   * filtering, the nearest vertex of the cage. `nearestPoint` or `nearestVertex`. Default: `nearestPoint`.
   */
  projection?: 'nearestPoint' | 'nearestVertex' | undefined;
  /**
   * Step 7: judges large triangles by samples inside them instead of by their corners, in segments of few points near a
   * hole. True or false. Default: `true`; in the preset `paper`: `false`.
   */
  interiorSamples?: boolean | undefined;
  /**
   * Step 9: casts more rays from occluded points, and recovers a point if rays in other directions reach the cage
   * freely. True or false. Default: `true`; in the preset `paper`: `false`.
   */
  recheck?: boolean | undefined;
  /**
   * Step 10: culls small segments that holes of the cage are meant for, and recovers uncovered points that no hole is
   * meant for. True or false. Default: `true`; in the preset `paper`: `false`.
   */
  holes?: boolean | undefined;
}

/** Switches for single steps in `classify`, for measuring them. */
export interface ClassifySteps {
  /**
   * Step 8: besides the threshold, requires enough covered area of a segment, not deep under the cage. True or false.
   * Default: `true`; in the preset `paper`: `false`.
   */
  floor?: boolean | undefined;
  /**
   * Step 11: paints a triangle if at least one corner is cosmetic and the others are cosmetic or occluded; if false,
   * all three must be cosmetic. True or false. Default: `true`; in the preset `paper`: `false`.
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
  motion: { stage: 'project', isStep: false, kind: 'toggle' },
  minCovered: { stage: 'classify', isStep: false, kind: 'share' },
  projection: { stage: 'project', isStep: true, kind: 'choice', type: 'ProjectionMode' },
  interiorSamples: { stage: 'project', isStep: true, kind: 'toggle' },
  floor: { stage: 'classify', isStep: true, kind: 'toggle' },
  recheck: { stage: 'project', isStep: true, kind: 'toggle' },
  holes: { stage: 'project', isStep: true, kind: 'toggle' },
  partialTriangles: { stage: 'classify', isStep: true, kind: 'toggle' },
} as const;

/** The values of each option outside `steps`, for the command and its configurations. */
export const optionValues = [
  {
    name: 'threshold',
    kind: 'share',
    range: [0, 1],
    standard: 0.5,
    paper: 0.5,
    text: 'A segment (a connected part of the model) is painted only if the cage covers at least this share of its exposed area (which no other surface hides).',
  },
  {
    name: 'seams',
    kind: 'choice',
    range: ['vertex', 'corner'],
    standard: 'corner',
    paper: 'vertex',
    text: 'Whether UVs are given per vertex only, or also per triangle corner, so that no triangle stretches across a seam of the texture.',
  },
  {
    name: 'weldTolerance',
    kind: 'length',
    range: [0, 0.01],
    standard: 0,
    paper: 0,
    text: 'Vertices of one group (primitive) that are closer together than this count as one point, and so do chains of them.',
  },
  {
    name: 'occlusionReach',
    kind: 'length',
    range: [0, Infinity],
    standard: 0.03,
    paper: Infinity,
    text: 'How far beyond the cage the target can still occlude a point.',
  },
  {
    name: 'pokeThrough',
    kind: 'length',
    range: [0, 1],
    standard: 0.0025,
    paper: 0,
    text: 'How far a point may poke out of the cage, not at the border of a hole, and still count as covered.',
  },
  {
    name: 'motion',
    kind: 'toggle',
    range: [false, true],
    standard: true,
    paper: false,
    text: "Whether what comes into view when the face moves (an eyelid, the inner side of a lip) is painted as well, judged by the target's poses.",
  },
  {
    name: 'minCovered',
    kind: 'share',
    range: [0, 1],
    standard: 0.2,
    paper: 0.2,
    text: 'A segment is painted only if its covered area, times the covered share of its exposed area, is at least this share of its whole area. A large segment that is clearly covered where it is exposed is painted anyway. No effect with the preset paper.',
  },
] as const;
