import { callCore } from './engine.js';
import { CagecastError, show } from './error.js';

/**
 * A named set of rules. `paper` is the method as published: *Cage-based Texture Transfer with Geometric Filtering*
 * (SIGGRAPH Posters '26, DOI 10.1145/3799825.3818741). `default` is what was made of it for bodies, cars and cages of many
 * islands: each of its steps is an option of its own, and docs/method.md says what each does.
 */
export type Preset = 'default' | 'paper';

/** What the user of a model says of a part of it: let its areas decide, paint it whatever they are, or never paint it. */
export type Lock = 'auto' | 'keep' | 'exclude';

/** The last word about parts of the target. A lock by segment outdoes one by group. */
export interface Locks {
  /** By segment: a number in `result.segments`. */
  segments?: Readonly<Record<number, Lock>> | undefined;
  /** By group: a number in `target.groups`; 0 if the target has none. A segment is of the group of its first vertex. */
  groups?: Readonly<Record<number, Lock>> | undefined;
}

/** Options of `project`, the costly part. What is not given is as the preset says; lengths are shares of the target's diagonal. */
export interface ProjectOptions {
  /** The set of rules; `default` by default. */
  preset?: Preset | undefined;
  /**
   * How a vertex finds its place on the cage: at the nearest point of its surface (`nearestPoint`, in both presets), or at
   * its nearest vertex with nothing filtered (`nearestVertex`), the classical baseline, for comparison.
   */
  projection?: 'nearestPoint' | 'nearestVertex' | undefined;
  /** Vertices nearer than this are one point; 0 … 0.01, in both presets 0. */
  weldTolerance?: number | undefined;
  /**
   * Where UVs are kept: per vertex alone (`vertex`, in `paper`), so that a triangle across a seam of the cage's texture
   * stretches over the atlas; or in `cornerUvs` as well (`corner`, in `default`), so that none does.
   */
  seams?: 'vertex' | 'corner' | undefined;
  /** Step 2′: the target occludes a point only up to so far beyond the cage; at least 0. Infinity in `paper`. */
  occlusionReach?: number | undefined;
  /** Step 3′: a point up to so far outside the cage, not at one of its open borders, is covered; 0 … 1. 0 in `paper`. */
  pokeThrough?: number | undefined;
  /** Step 4′: in small segments near a hole, big triangles vote with what is found inside them. Not in `paper`. */
  votes?: boolean | undefined;
  /** Step 4′: a hole is near a segment if it is no farther than the cage itself; else only within 0.01. Not in `paper`. */
  farRims?: boolean | undefined;
  /** Step 5′: measures how deep under the cage lies what is covered of each segment, and which are copies of others. Not in `paper`. */
  depths?: boolean | undefined;
  /** Step 6: occluded points that are seen from the cage in another direction are restored. Not in `paper`. */
  secondLook?: boolean | undefined;
  /** Step 6: points whose triangles all have copies in reverse winding look to both sides. Not in `paper`. */
  bothSides?: boolean | undefined;
  /** Step 6: to which side a segment's points look is decided by those that are not occluded, not by all. Not in `paper`. */
  exposedSide?: boolean | undefined;
  /** Step 7: uncovered points are restored unless the hole over them is meant for them. Not in `paper`. */
  holes?: boolean | undefined;
}

/** Options of `classify`, the decision per segment. What is not given is as the preset says. */
export interface ClassifyOptions {
  /** The set of rules; by default that of the projection. */
  preset?: Preset | undefined;
  /** A segment may be painted if at least this share of its exposed area is covered; 0 … 1, in both presets 0.5. */
  threshold?: number | undefined;
  /**
   * Step 5′: what a segment needs besides, so that no leak is taken for skin: nothing (`none`, in `paper`), some of its area
   * covered (`area`), or so much of it that lies no deeper than its neighbours (`depth`, in `default`).
   */
  floor?: 'none' | 'area' | 'depth' | undefined;
  /** With a floor: the least share of the segment's area; 0 … 1. */
  minCovered?: number | undefined;
  /** With `floor: 'depth'`: the least share of all area that is covered, which is enough as well; 0 … 1. */
  minOfAll?: number | undefined;
  /** What `minOfAll` lets pass is uncovered in at most this share of its exposed area; 0 … 1. */
  maxUncovered?: number | undefined;
  /** With a floor: copies of one part that are in doubt are judged together. Not in `paper`. */
  copies?: boolean | undefined;
  /**
   * Step 5″: a small part is culled if a hole of the cage seems to be meant for it, because nothing else explains the hole, or much of
   * the part lies hidden under it. Needs `holes`. Not in `paper`.
   */
  baredParts?: boolean | undefined;
  /** Step 8: a triangle is cosmetic if one corner is and the others are that or occluded; in `paper` if all three are. */
  partialTriangles?: boolean | undefined;
  /** Segments and groups to be painted, or not, whatever their areas. */
  locks?: Locks | undefined;
}

/** Options of `transfer`. */
export interface TransferOptions extends ProjectOptions, ClassifyOptions {
  /** The set of rules; `default` by default. */
  preset?: Preset | undefined;
}

/** Everything that a preset stands for. */
export type PresetOptions = {
  [Name in Exclude<keyof TransferOptions, 'preset' | 'locks'>]-?: NonNullable<TransferOptions[Name]>;
};

/** Options that were checked. */
export interface CheckedOptions {
  preset: Preset;
  /** All of them in numbers, for the core: in the order of bridge.hpp, which is that of `allKinds`. */
  core: readonly number[];
  locks: Locks;
}

/** In the order of the core's numbers. */
const presets: readonly Preset[] = ['paper', 'default'];
const lockNames: readonly Lock[] = ['auto', 'keep', 'exclude'];

/** What an option may be: a number or a truth value, or one of several names, in the order of the core's numbers. */
type Kind = 'number' | 'boolean' | readonly string[];
const projectKinds = {
  projection: ['nearestPoint', 'nearestVertex'],
  weldTolerance: 'number',
  seams: ['vertex', 'corner'],
  occlusionReach: 'number',
  pokeThrough: 'number',
  votes: 'boolean',
  farRims: 'boolean',
  depths: 'boolean',
  secondLook: 'boolean',
  bothSides: 'boolean',
  exposedSide: 'boolean',
  holes: 'boolean',
} as const satisfies Partial<Record<keyof PresetOptions, Kind>>;
const classifyKinds = {
  threshold: 'number',
  floor: ['none', 'area', 'depth'],
  minCovered: 'number',
  minOfAll: 'number',
  maxUncovered: 'number',
  copies: 'boolean',
  baredParts: 'boolean',
  partialTriangles: 'boolean',
} as const satisfies Partial<Record<keyof PresetOptions, Kind>>;
const allKinds: Record<keyof PresetOptions, Kind> = { ...projectKinds, ...classifyKinds };
const allNames = Object.keys(allKinds) as (keyof PresetOptions)[];

/** The options of each function. */
const namesOf: Record<'project' | 'classify' | 'transfer' | 'cutBorders', readonly string[]> = {
  project: ['preset', ...Object.keys(projectKinds), 'into'],
  classify: ['preset', ...Object.keys(classifyKinds), 'locks', 'into'],
  transfer: ['preset', ...allNames, 'locks', 'into'],
  cutBorders: ['preset', ...allNames, 'locks'],
};

/** The value of an option in numbers for the core. */
export const numberOf = (core: readonly number[], name: keyof PresetOptions): number => core[allNames.indexOf(name)]!;

/** The numbers that the core takes. */
export const ranges = {
  threshold: [0, 1],
  weldTolerance: [0, 0.01],
  occlusionReach: [0, Infinity],
  pokeThrough: [0, 1],
  minCovered: [0, 1],
  minOfAll: [0, 1],
  maxUncovered: [0, 1],
} as const satisfies Partial<Record<keyof PresetOptions, readonly [number, number]>>;

/**
 * What a preset stands for: the value of every option but `preset` and `locks`.
 * @throws {CagecastError} `notInitialised`, `badOption`
 */
export function presetOptions(preset: Preset = 'default'): PresetOptions {
  const numbers = numbersOf('presetOptions', 'preset', preset);
  const entries = allNames.map((name, i) => {
    const kind = allKinds[name];
    const number = numbers[i]!;
    if (typeof kind === 'object') return [name, kind[number]];
    // The core's numbers have 24 bits: what was 0.2 there is 0.2 here.
    return [name, kind === 'boolean' ? number === 1 : Number(number.toPrecision(7))];
  });
  return Object.fromEntries(entries) as PresetOptions;
}

/** By preset, once they are known. */
const presetNumbers: number[][] = [];

/** What a preset stands for, as the core says. @returns an array of the caller's own. */
function numbersOf(fn: string, name: string, preset: unknown): number[] {
  const number = presets.indexOf(preset as Preset);
  if (number < 0)
    throw new CagecastError(
      'badOption',
      `${fn}: ${name} = ${show(preset)} is unknown; there are: ${presets.map(show).join(', ')}`,
    );
  return (presetNumbers[number] ??= callCore(fn, (core) => Array.from(core.presetOptions(number)))).slice();
}

/**
 * Checks options. The core checks the ranges of numbers, and knows what is not given.
 * @param preset  What holds if the options name none.
 * @throws {CagecastError} `badOption`
 */
export function checkOptions(
  fn: keyof typeof namesOf,
  options: unknown = {},
  preset: Preset = 'default',
): CheckedOptions {
  if (typeof options !== 'object' || options === null) {
    throw new CagecastError('badOption', `${fn}: options is ${show(options)}, not an object`);
  }
  const known = namesOf[fn];
  for (const name of Object.keys(options)) {
    if (!known.includes(name)) {
      throw new CagecastError('badOption', `${fn}: options.${name} is not an option; there are: ${known.join(', ')}`);
    }
  }
  const given = options as Record<string, unknown>;
  const chosen = (given['preset'] ?? preset) as Preset;
  const core = numbersOf(fn, 'options.preset', chosen);
  allNames.forEach((name, i) => {
    if (given[name] !== undefined) core[i] = checkOption(fn, name, allKinds[name], given[name]);
  });
  return { preset: chosen, core, locks: checkLocks(fn, given['locks']) };
}

function checkOption(fn: string, name: string, kind: Kind, value: unknown): number {
  const wrong = (is: string) => new CagecastError('badOption', `${fn}: options.${name} = ${show(value)} is ${is}`);
  if (typeof kind === 'object') {
    const number = kind.indexOf(value as string);
    if (number < 0) throw wrong(`unknown; there are: ${kind.map(show).join(', ')}`);
    return number;
  }
  if (kind === 'boolean') {
    if (typeof value !== 'boolean') throw wrong('not true or false');
    return Number(value);
  }
  if (typeof value === 'number') return value;
  const [low, high] = ranges[name as keyof typeof ranges];
  throw wrong(`not a number within ${low}..${high}`);
}

function checkLocks(fn: string, locks: unknown = {}): Locks {
  const wrong = (text: string) => new CagecastError('badOption', `${fn}: options.locks${text}`);
  if (typeof locks !== 'object' || locks === null) throw wrong(` is ${show(locks)}, not an object`);
  for (const [field, numbers] of Object.entries(locks)) {
    if (field !== 'segments' && field !== 'groups') throw wrong(`.${field} is unknown; there are: segments, groups`);
    if (numbers === undefined) continue;
    if (typeof numbers !== 'object' || numbers === null || numbers instanceof Map)
      throw wrong(`.${field} is ${show(numbers)}, not an object of numbers and locks`);
    for (const [number, lock] of Object.entries(numbers)) {
      if (!/^(0|[1-9][0-9]*)$/.test(number)) throw wrong(`.${field} has the entry ${show(number)}, which is no number`);
      if (!lockNames.includes(lock as Lock))
        throw wrong(`.${field}[${number}] = ${show(lock)} is unknown; there are: ${lockNames.map(show).join(', ')}`);
    }
  }
  return locks;
}

/**
 * The locks of all segments, in the core's numbers; none if nothing is locked.
 * @throws {CagecastError} `badOption` for a lock of something that is not there
 */
export function locksOf(
  fn: string,
  { segments = {}, groups = {} }: Locks,
  stats: readonly { group: number }[],
): Uint8Array {
  const [bySegment, byGroup] = [Object.entries(segments), Object.entries(groups)];
  if (bySegment.length === 0 && byGroup.length === 0) return new Uint8Array(0);
  const lockOf = new Map(byGroup.map(([group, lock]) => [group, lockNames.indexOf(lock)]));
  const out = Uint8Array.from(stats, ({ group }) => lockOf.get(String(group)) ?? 0);
  const known = new Set(stats.map(({ group }) => String(group)));
  const stray = byGroup.find(([group]) => !known.has(group));
  if (stray)
    throw new CagecastError(
      'badOption',
      `${fn}: options.locks.groups[${stray[0]}] = ${show(stray[1])}, but no segment is of that group`,
    );
  for (const [segment, lock] of bySegment) {
    if (!(Number(segment) in out))
      throw new CagecastError(
        'badOption',
        `${fn}: options.locks.segments[${segment}] = ${show(lock)}, but there are ${stats.length} segments`,
      );
    out[Number(segment)] = lockNames.indexOf(lock);
  }
  return out;
}
