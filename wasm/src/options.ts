import { CagecastError, show } from './error.js';

/**
 * A named set of rules. `paper` is the method as published: *Cage-based Texture Transfer with Geometric Filtering*
 * (SIGGRAPH Posters '26, DOI 10.1145/3799825.3818741).
 */
export type Preset = 'paper';

/** Options of `project`, the costly part. */
export interface ProjectOptions {
  /** The set of rules; `paper` by default. */
  preset?: Preset | undefined;
  /**
   * How a vertex finds its place on the cage: at the nearest point of its surface (`nearestPoint`, the default), or at
   * its nearest vertex with nothing filtered (`nearestVertex`), the classical baseline, for comparison.
   */
  projection?: 'nearestPoint' | 'nearestVertex' | undefined;
  /** Vertices nearer than this share of the target's diagonal are one point; 0 … 0.01, by default 0. */
  weldTolerance?: number | undefined;
}

/** Options of `classify`, the decision per segment. */
export interface ClassifyOptions {
  /** A segment may be painted if at least this share of its exposed area is covered; 0 … 1, by default 0.5. */
  threshold?: number | undefined;
}

/** Options of `transfer`. */
export interface TransferOptions extends ProjectOptions, ClassifyOptions {}

const projections = ['nearestPoint', 'nearestVertex'] as const;
const presets = ['paper'] as const;
const projectNames = ['preset', 'projection', 'weldTolerance'];
const classifyNames = ['threshold'];

/** Options with every default filled in; `projection` is the number of the core's `ProjectionMode`. */
export interface ResolvedOptions {
  preset: Preset;
  projection: number;
  weldTolerance: number;
  threshold: number;
}

/**
 * Checks options and fills in the defaults. The core checks the ranges of numbers.
 * @throws {CagecastError} `badOption`, `badThreshold`, `badWeldTolerance`
 */
export function resolveOptions(fn: 'project' | 'classify' | 'transfer', options: unknown = {}): ResolvedOptions {
  if (typeof options !== 'object' || options === null) {
    throw new CagecastError('badOption', `${fn}: options is ${show(options)}, not an object`);
  }
  const known = [...(fn === 'classify' ? [] : projectNames), ...(fn === 'project' ? [] : classifyNames)];
  for (const name of Object.keys(options)) {
    if (!known.includes(name)) {
      throw new CagecastError('badOption', `${fn}: options.${name} is not an option; there are: ${known.join(', ')}`);
    }
  }
  const { preset = 'paper', projection = 'nearestPoint', weldTolerance = 0, threshold = 0.5 } = options as TransferOptions;
  if (!presets.includes(preset)) {
    throw new CagecastError('badOption', `${fn}: options.preset = ${show(preset)} is unknown; there is: ${presets.map(show).join(', ')}`);
  }
  if (!projections.includes(projection)) {
    throw new CagecastError('badOption', `${fn}: options.projection = ${show(projection)} is unknown; there are: ${projections.map(show).join(', ')}`);
  }
  if (typeof weldTolerance !== 'number') {
    throw new CagecastError('badWeldTolerance', `${fn}: options.weldTolerance = ${show(weldTolerance)} is not a number within 0..0.01`);
  }
  if (typeof threshold !== 'number') {
    throw new CagecastError('badThreshold', `${fn}: options.threshold = ${show(threshold)} is not a number within 0..1`);
  }
  return { preset, projection: projections.indexOf(projection), weldTolerance, threshold };
}
