import { useCore } from '../core/engine.js';
import { CagecastError, isRecord, show } from '../core/error.js';
import { type CoreOptions, type CoreOverrides, type CoreValue, nameOf, namesOf } from '../core/module.js';
import { plainArray, showArray } from '../core/typed-arrays.js';
import {
  type ClassifyStage,
  type ClassifySteps,
  optionTable,
  type ProjectStage,
  type ProjectSteps,
} from '../generated/options.js';
import { type Fn, faultOfNames, type OptionName, optionNames, optionsOf, partListsOf } from './option-names.js';
import { checkParts, type PartNames, type Parts } from './parts.js';

/**
 * A named set of values for all options. `paper` is the method as published: *Cage-based Texture Transfer with Geometric
 * Filtering* (SIGGRAPH Posters '26, DOI 10.1145/3799825.3818741). `default` adds steps for bodies, cars and cages with many UV charts;
 * docs/method.md describes them.
 */
export type Preset = 'default' | 'paper';

/** An override for a segment: its score decides (`auto`), it is never culled (`keep`), or always (`exclude`). */
export type Lock = 'auto' | 'keep' | 'exclude';

/** Overrides by the number of a segment, as in `result.segments`. They count more than those by `parts`. */
export type Locks = Readonly<Record<number, Lock>>;

/**
 * Where the target is never painted (−1) or always (1), whatever the method says; 0 leaves it to the method. For what no lock can
 * name, such as the eyes of a scan in one piece. −1 overrides 1. Segments, their ratios and holes are not affected.
 *
 * A vertex of −1 gets `Zone.Culled`, and no triangle at it is painted. A vertex of 1 gets `Zone.Cosmetic`, and a triangle is painted
 * if its vertices say so then. Triangles are decided after vertices: the vertices of a painted triangle of 1 become cosmetic, and
 * those all of whose triangles are −1 become culled.
 *
 * Where the cage has no place for what is painted, as over a hole, it shows the nearest of the cage, stretched.
 */
export interface Masks {
  /** 1 per target vertex. Vertices that lie at the same place may differ. */
  vertices?: Int8Array | undefined;
  /** 1 per target triangle. */
  triangles?: Int8Array | undefined;
}

/** Options of `project`. An option that is not given has the value of the preset. */
export interface ProjectOptions extends ProjectStage {
  /** Parts that are not there. Default: none. */
  parts?: Pick<Parts, 'ignore'> | undefined;
  /** The values of all options that are not given. Default: `default`. */
  preset?: Preset | undefined;
  /** Switches for measuring single steps; not part of the stable interface. */
  steps?: ProjectSteps | undefined;
}

/** Options of `classify`. An option that is not given has the value of the preset. */
export interface ClassifyOptions extends ClassifyStage {
  /** The values of all options that are not given. Default: the preset of the projection. */
  preset?: Preset | undefined;
  /** Switches for measuring single steps; not part of the stable interface. */
  steps?: ClassifySteps | undefined;
  /** Groups that are always or never painted, by number. Default: none. */
  parts?: Pick<Parts<number>, 'keep' | 'exclude'> | undefined;
  /** Segments that are always or never painted. Default: none. */
  locks?: Locks | undefined;
  /** Vertices and triangles that are always or never painted. Default: none. */
  masks?: Masks | undefined;
}

/** Options of `transfer` and `cutBorders`. An option that is not given has the value of the preset. */
export interface TransferOptions extends ProjectStage, ClassifyStage {
  /** The values of all options that are not given. Default: `default`. */
  preset?: Preset | undefined;
  /** Switches for measuring single steps; not part of the stable interface. */
  steps?: (ProjectSteps & ClassifySteps) | undefined;
  /** Parts that are not there, that are always painted, or never. Default: none. */
  parts?: Parts | undefined;
  /** Segments that are always or never painted. Default: none. */
  locks?: Locks | undefined;
  /** Vertices and triangles that are always or never painted. Default: none. */
  masks?: Masks | undefined;
}

type AllOf<T> = { [Name in keyof T]-?: NonNullable<T[Name]> };

/** The value of every option in a preset. */
export interface PresetOptions extends AllOf<ProjectStage & ClassifyStage> {
  steps: AllOf<ProjectSteps & ClassifySteps>;
}

/** Checked options, as the core takes them. */
interface CheckedOptions {
  preset: Preset;
  core: CoreOptions;
  overrides: CoreOverrides;
}

const kPresets: readonly Preset[] = ['default', 'paper'];
const kLockNames: readonly Lock[] = ['auto', 'keep', 'exclude'];

/** The C++ enumeration of a choice. */
function typeOf(name: string): string | undefined {
  const entry = optionTable[name as OptionName];
  return 'type' in entry ? entry.type : undefined;
}

/**
 * Returns the value of every option in a preset, except `parts`, `locks` and `masks`.
 * @throws {CagecastError} `notInitialised`, `badOption`
 */
export function presetOptions(preset: Preset = 'default'): PresetOptions {
  const { steps, ...options } = presetOf('presetOptions', 'preset', preset);
  return { ...readable(options), steps: readable(steps) } as PresetOptions;
}

/** Options as people read them: choices by name. */
function readable(options: Record<string, CoreValue>): object {
  const entries = Object.entries(options).map(([name, value]) => {
    const type = typeOf(name);
    if (type !== undefined) return [name, useCore('presetOptions', (core) => nameOf(core, type, value))];
    // C++ has 32-bit floats: 0.2 is 0.20000000298 there.
    return [name, typeof value === 'number' ? Number(value.toPrecision(7)) : value];
  });
  return Object.fromEntries(entries);
}

function presetOf(fn: string, name: string, preset: unknown): CoreOptions {
  if (!kPresets.includes(preset as Preset))
    throw new CagecastError(
      'badOption',
      fn,
      `${name} = ${show(preset)} is unknown; there are: ${kPresets.map(show).join(', ')}`,
      { argument: name.split('.')[0] },
    );
  return useCore(fn, ({ module }) => module.presetOptions(module['Preset']![preset as Preset]!));
}

/**
 * Checks the types of options, and fills in those that are not given. The core checks the ranges of numbers.
 * @param preset  The preset if the options name none.
 * @param names   Of the target's groups.
 * @throws {CagecastError} `badOption`
 */
export function checkOptions(
  fn: Fn,
  options: unknown = {},
  preset: Preset = 'default',
  names?: PartNames,
): CheckedOptions {
  const given = checkNames(fn, 'options', options, optionNames(fn));
  const { steps: givenSteps = {} } = given;
  const steps = checkNames(fn, 'options.steps', givenSteps, optionsOf(fn, true));
  const bad = (reason: string) => new CagecastError('badOption', fn, reason);
  const chosen = (given['preset'] ?? preset) as Preset;
  const core = presetOf(fn, 'options.preset', chosen);
  for (const name of optionsOf(fn, false))
    if (given[name] !== undefined) core[name] = checkValue(fn, 'options', name, given[name]);
  for (const name of optionsOf(fn, true))
    if (steps[name] !== undefined) core.steps[name] = checkValue(fn, 'options.steps', name, steps[name]);
  return {
    preset: chosen,
    core,
    overrides: {
      parts: checkParts(fn, given['parts'], partListsOf(fn), names, bad),
      locks: checkLocks(fn, given['locks']),
      masks: checkMasks(fn, given['masks']),
    },
  };
}

function checkNames(fn: string, where: string, given: unknown, known: readonly string[]): Record<string, unknown> {
  const fault = faultOfNames(fn, where, given, known);
  if (fault !== undefined) throw new CagecastError('badOption', fn, fault);
  return given as Record<string, unknown>;
}

function checkValue(fn: string, where: string, name: OptionName, value: unknown): CoreValue {
  const wrong = (is: string) => new CagecastError('badOption', fn, `${where}.${name} = ${show(value)} is ${is}`);
  const type = typeOf(name);
  if (type !== undefined) {
    const choices = useCore(fn, (core) => namesOf(core, type));
    if (!choices.includes(value as string)) throw wrong(`unknown; there are: ${choices.map(show).join(', ')}`);
    return useCore(fn, ({ module }) => module[type]![value as string]!);
  }
  if (optionTable[name].kind === 'toggle') {
    if (typeof value !== 'boolean') throw wrong('not true or false');
    return value;
  }
  if (typeof value !== 'number') throw wrong('not a number');
  return value;
}

function checkLocks(fn: string, locks: unknown = {}): CoreOverrides['locks'] {
  const wrong = (text: string) => new CagecastError('badOption', fn, `options.locks${text}`);
  if (!isRecord(locks)) throw wrong(` is ${show(locks)}, not an object of numbers and locks`);
  return Object.entries(locks).map(([segment, lock]) => {
    if (segment === 'groups')
      throw wrong('.groups is not there any more; give the numbers of groups as options.parts.keep and .exclude');
    // Segments have 32-bit numbers.
    if (!/^(0|[1-9][0-9]*)$/.test(segment) || Number(segment) >= 2 ** 32)
      throw wrong(` has the key ${show(segment)}, which is not the number of a segment`);
    if (!kLockNames.includes(lock as Lock))
      throw wrong(`[${segment}] = ${show(lock)} is unknown; there are: ${kLockNames.map(show).join(', ')}`);
    return { segment: Number(segment), lock: useCore(fn, ({ module }) => module['Lock']![lock as Lock]!) };
  });
}

/** Checks the types of masks; the core checks their lengths and values. */
function checkMasks(fn: string, masks: unknown = {}): CoreOverrides['masks'] {
  const wrong = (text: string) => new CagecastError('badOption', fn, `options.masks${text}`);
  if (!isRecord(masks)) throw wrong(` is ${show(masks)}, not an object`);
  const out: CoreOverrides['masks'] = {};
  for (const [field, value] of Object.entries(masks)) {
    if (field !== 'vertices' && field !== 'triangles')
      throw wrong(`.${field} is unknown; there are: vertices, triangles`);
    if (value === undefined) continue;
    const array = plainArray(value, 'Int8Array');
    if (!array) throw wrong(`.${field} is ${showArray(value, 'Int8Array')}, not an Int8Array`);
    out[field] = array;
  }
  return out;
}
