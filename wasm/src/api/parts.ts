import { isRecord, show } from '../core/error.js';
import type { PartNumbers } from '../core/module.js';
import { matcher } from '../core/patterns.js';
import { plainArray } from '../core/typed-arrays.js';
import { faultOfNames, kPartLists, type PartList } from './option-names.js';

/** Names of parts, by number: of each one, or several. */
export type PartNames = readonly (string | readonly string[])[];

/**
 * A part: a pattern for its name, or its number. Of a mesh, its name in `names`, and the number of its group; of a model, the name of its
 * node, of a node above, of its mesh or its material, and its number among the drawn ones.
 */
export type PartOf = number | string;

/**
 * What counts of a target, part by part. A pattern is the whole name, without regard to case or Unicode form; `*` stands for any text.
 * One without `*` must match. Of several lists that have a part, the first counts.
 */
export interface Parts<Part = PartOf> {
  /** Parts that are not there: not painted, not in the way, not counted. Default: none. */
  ignore?: readonly Part[] | undefined;
  /** Parts that are painted wherever the cage covers them, whatever the rules say. Default: none. */
  keep?: readonly Part[] | undefined;
  /** Parts that stay bare. Default: none. */
  exclude?: readonly Part[] | undefined;
}

/** How many names a message lists at most. */
const kMaxNames = 20;

/** A part as patterns know it. */
export interface NamedPart {
  names: readonly (string | undefined)[];
  /** The names of the nodes above it. */
  above?: readonly (string | undefined)[] | undefined;
}

/** The numbers of the parts of a name, else of the parts below a node of this name. */
export function numbersNamed(pattern: string, all: readonly NamedPart[]): number[] {
  if (/^\*+$/.test(pattern)) return [...all.keys()]; // also those without a name
  const matches = matcher(pattern);
  const isNamed = (names: NamedPart['names'] = []) => names.some((name) => name !== undefined && matches(name));
  const own = [...all.keys()].filter((n) => isNamed(all[n]!.names));
  return own.length > 0 ? own : [...all.keys()].filter((n) => isNamed(all[n]!.above));
}

/** The same; `wrong` makes the error if there are none, and the pattern has no `*`. */
export function partsNamed(pattern: string, all: readonly NamedPart[], wrong: (text: string) => Error): number[] {
  const found = numbersNamed(pattern, all);
  if (found.length > 0 || pattern.includes('*')) return found;
  const names = [...new Set(all.flatMap((one) => one.names))].filter((name) => name !== undefined && name !== '');
  const more = names.length > kMaxNames ? ` and ${names.length - kMaxNames} more` : '';
  const there = names.length > 0 ? `there are ${names.slice(0, kMaxNames).join(', ')}${more}` : 'no part has a name';
  throw wrong(`nothing is named ${show(pattern)}; ${there}`);
}

const isNumber = (part: unknown): part is number =>
  Number.isInteger(part) && (part as number) >= 0 && (part as number) < 2 ** 32;

/** What is wrong with `parts`, as the reason of a `badOption`; nothing if they can be used. */
export function faultOfParts(fn: string, given: unknown): string | undefined {
  if (given === undefined || given === null) return undefined;
  const fault = faultOfNames(fn, 'options.parts', given, kPartLists);
  if (fault !== undefined) return fault;
  for (const [list, patterns] of Object.entries(given as object)) {
    if (patterns === undefined || patterns === null) continue;
    if (!Array.isArray(patterns)) return `options.parts.${list} is ${show(patterns)}, not an array of names`;
    const bad = patterns.findIndex((part) => typeof part !== 'string' && !isNumber(part));
    if (bad >= 0)
      return `options.parts.${list}[${bad}] = ${show(patterns[bad])} is neither a name nor the number of a part`;
  }
  return undefined;
}

/**
 * Checks `parts`, and finds the groups that its patterns name.
 * @param lists  Those that the function takes.
 * @param names  Of the groups.
 * @param bad    Makes the error of a bad option.
 */
export function checkParts(
  fn: string,
  given: unknown,
  lists: readonly PartList[],
  names: PartNames = [],
  bad: (reason: string) => Error,
): PartNumbers {
  if (given === undefined || given === null) return {};
  const wrong = (text: string) => bad(`options.parts${text}`);
  if (!isRecord(given)) throw wrong(` is ${show(given)}, not an object`);
  // Checked with the mesh, later.
  const all = Array.isArray(names)
    ? names.map((own) => ({ names: [own].flat().filter((one) => typeof one === 'string') }))
    : [];
  const out: PartNumbers = {};
  for (const [list, parts] of Object.entries(given)) {
    if (!(lists as readonly string[]).includes(list))
      throw wrong(`.${list} is not an option; ${fn} takes: ${lists.join(', ')}`);
    if (parts === undefined || parts === null) continue;
    const values: unknown = plainArray(parts, 'Uint32Array') ?? parts;
    if (!Array.isArray(values) && !(values instanceof Uint32Array))
      throw wrong(`.${list} is ${show(values)}, not an array of numbers and names`);
    out[list as keyof PartNumbers] = Uint32Array.from(
      Array.from(values as ArrayLike<unknown>).flatMap((part, i) => {
        if (typeof part === 'string') return partsNamed(part, all, (text) => wrong(`.${list}[${i}]: ${text}`));
        if (isNumber(part)) return [part];
        throw wrong(`.${list}[${i}] = ${show(part)} is neither the number of a group nor a name`);
      }),
    );
  }
  return out;
}
