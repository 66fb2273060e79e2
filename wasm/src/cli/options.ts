import type { GLTF } from '@gltf-transform/core';
import { type Command, InvalidArgumentError, Option } from 'commander';
import { optionFlags } from '../generated/options.js';
import { type Part, partsBelow } from '../gltf/extract-file.js';
import { InputError } from '../gltf/input-error.js';
import { type Lock, type Preset, type PresetOptions, presetOptions, type TransferOptions } from '../index.js';
import type { Finding } from '../inspect/finding.js';
import type { ReadModel, Sources } from './run.js';
import { cut, listed } from './table.js';

export const presets: readonly Preset[] = ['default', 'paper'];

/** Options of `transfer` that were given; the preset has the others. */
export type GivenOptions = Partial<Omit<PresetOptions, 'steps'>>;

/** Where the target is never or always painted: files of images in its own UVs, and an attribute of colours. */
export interface MaskFiles {
  never?: string | undefined;
  always?: string | undefined;
  colors?: string | undefined;
}

/** The options of a transfer, from the command line. */
export interface Rules {
  preset: Preset;
  single: GivenOptions;
  /** Names of nodes or materials, `*` for any text, whose parts are always painted. */
  keep: string[];
  /** The same for parts that are never painted. */
  exclude: string[];
  /** How late each of these patterns is said, which decides where both match: below 0 in a file, 0 by a flag, 1 in a manifest. */
  ranks?: Record<'keep' | 'exclude', number[]>;
  /** Those of both that may match nothing. */
  optional?: string[];
  masks?: MaskFiles;
  /** The configuration file that some of it comes from. */
  config?: string;
  /** The masks that it names. */
  configMasks?: readonly ('never' | 'always')[];
  /** Where their files have to be: the configuration may be a stranger's if nobody named it. */
  maskFolder?: string;
}

/** The options if nothing is said. */
export const defaultRules: Rules = { preset: 'default', single: {}, keep: [], exclude: [] };

/** The flags of these options, as commander parses them. */
export interface RuleFlags extends GivenOptions {
  preset: Preset;
  keep: string[];
  exclude: string[];
  neverMask?: string;
  alwaysMask?: string;
  maskColors?: string;
}

/** The files that these flags name. */
export const maskInputs = ({ neverMask, alwaysMask }: RuleFlags): (string | undefined)[] => [neverMask, alwaysMask];

/** Adds the flags of all options to a command; those in core/include/cagecast/options.def come from there. */
export function addRuleFlags(command: Command): Command {
  const oneMore = (name: string, before: string[]) => [...before, name];
  command.addOption(
    new Option('--preset <NAME>', 'values of the options that are not given').choices(presets).default('default'),
  );
  for (const option of optionFlags) {
    const { flag, kind, range } = option;
    command.addOption(
      kind === 'choice'
        ? new Option(`${flag} <HOW>`, helpOf(option)).choices(range)
        : new Option(`${flag} <SHARE>`, helpOf(option)).argParser(numberWithin(range[0], range[1])),
    );
  }
  return command
    .addOption(
      new Option(
        '--keep <NAME>',
        'keep parts of this node or material even if the rules would cull them (* matches any text); a node that holds others means all below it; may be repeated',
      )
        .default([], 'none')
        .argParser(oneMore),
    )
    .addOption(
      new Option('--exclude <NAME>', 'never paint parts of this node or material; as for --keep; may be repeated')
        .default([], 'none')
        .argParser(oneMore),
    )
    .option('--never-mask <IMAGE>', "never paint where this image, in TARGET's own UVs, is white")
    .option('--always-mask <IMAGE>', 'paint where this one is white, whatever the rules say')
    .addOption(
      new Option(
        '--mask-colors <ATTRIBUTE>',
        'never paint red vertices, always green ones; by an attribute such as COLOR_0',
      ).argParser((name) => {
        if (!holdsColors(name)) throw new InvalidArgumentError(`It is not ${colorAttributes}.`);
        return name;
      }),
    );
}

/** What holds colours, and whether a name is of that kind. */
export const colorAttributes = 'COLOR_0, COLOR_1, … or an attribute of an own name, which begins with _';
export const holdsColors = (name: string): boolean => /^(COLOR_\d+|_.+)$/.test(name);

/** What a flag does, its range and its defaults. Words in commander's help begin in lower case and end without a full stop. */
function helpOf({ kind, range, standard, paper, text }: (typeof optionFlags)[number]): string {
  const limits = range[1] === Infinity ? `at least ${range[0]}` : `${range[0]} to ${range[1]}`;
  return [
    `${text[0]!.toLowerCase()}${text.slice(1).replace(/\.$/, '')}`,
    ...(kind === 'choice' ? [] : [kind === 'length' ? `a share of the target's diagonal, ${limits}` : limits]),
    `default: ${standard}${standard === paper ? '' : `, or ${paper} with --preset paper`}`,
  ].join('; ');
}

/** Returns a parser for a whole number within two others. @param unit  What is counted, for its message: " of texels". */
export function wholeNumberWithin(least: number, most: number, unit = ''): (text: string) => number {
  return (text) => {
    const value = Number(text);
    if (!/^\d+$/.test(text) || value < least || value > most)
      throw new InvalidArgumentError(`It is not a whole number${unit} within ${least}..${most}.`);
    return value;
  };
}

/** Returns a parser for a number within two others. */
export function numberWithin(least: number, most: number): (text: string) => number {
  return (text) => {
    const value = Number(text);
    if (text.trim() === '' || !(value >= least && value <= most))
      throw new InvalidArgumentError(`It is not a number within ${least}..${most}.`);
    return value;
  };
}

export function rulesOf({ preset, keep, exclude, neverMask, alwaysMask, maskColors, ...flags }: RuleFlags): Rules {
  const given = optionFlags.map(({ name }) => [name, flags[name]] as const).filter(([, value]) => value !== undefined);
  const isMasked = [neverMask, alwaysMask, maskColors].some((flag) => flag !== undefined);
  const masks = { never: neverMask, always: alwaysMask, colors: maskColors };
  return { preset, keep, exclude, single: Object.fromEntries(given), ...(isMasked && { masks }) };
}

/** How JSON writes a number without end. */
export const infinite = 'Infinity';

/** All options that a transfer was made with, for a report. */
export interface EffectiveOptions
  extends Omit<PresetOptions, 'occlusionReach'>,
    Pick<Sources, 'uvBounds' | 'referenceCage'> {
  preset: Preset;
  occlusionReach: number | typeof infinite;
  keep: string[];
  exclude: string[];
  /** If there are any. */
  masks?: MaskFiles | undefined;
  /** The configuration file that some of them come from. */
  config: string | null;
}

/** The options in full; needs `init`. */
export function effectiveOptions({
  rules: { preset, single, keep, exclude, masks, config },
  uvBounds,
  referenceCage,
}: Pick<Sources, 'rules' | 'uvBounds' | 'referenceCage'>): EffectiveOptions {
  const all = { ...presetOptions(preset), ...single };
  const occlusionReach = Number.isFinite(all.occlusionReach) ? all.occlusionReach : infinite;
  // JSON leaves out what is undefined.
  return { preset, ...all, occlusionReach, keep, exclude, masks, uvBounds, referenceCage, config: config ?? null };
}

/** Says which configuration file settings come from; empty if there is none. */
export const configLine = (config: string | null | undefined): string => (config ? `settings from ${config}` : '');

/** The numbers of the parts that a pattern names. The name of a node that no part has stands for all parts below it. */
export function partsNamed(pattern: string, json: GLTF.IGLTF, parts: readonly Part[]): number[] {
  const matches = matcher(pattern);
  const own = [...parts.keys()].filter((p) => parts[p]!.aliases.some(matches));
  const isAbove = () => (json.nodes ?? []).map(({ name }) => name !== undefined && matches(name));
  return own.length > 0 ? own : partsBelow(json, parts, isAbove());
}

/**
 * The options of `transfer`. Names of parts become locks by group, because each part is a group.
 * @param leftOut  Whether each part is excluded if nothing is said of it. Default: none is.
 * @throws {InputError} if nothing has a given name, or a part is both kept and excluded in one place.
 */
export function transferOptions(
  { preset, single, keep, exclude, ranks, optional = [], config }: Rules,
  { file: { json }, extracted: { parts } }: ReadModel,
  leftOut: readonly boolean[] = [],
): TransferOptions {
  const saidOf = new Map<number, { lock: Lock; pattern: string; rank: number }>();
  for (const [lock, patterns] of [
    ['keep', keep],
    ['exclude', exclude],
  ] as const) {
    for (const [i, pattern] of patterns.entries()) {
      const rank = ranks?.[lock][i] ?? 0;
      const found = partsNamed(pattern, json, parts).filter((p) => parts[p]!.vertexCount > 0);
      if (found.length === 0 && !optional.includes(pattern)) throw noSuchName(`--${lock} ${pattern}`, parts);
      for (const p of found) {
        const said = saidOf.get(p);
        if (said && said.lock !== lock && said.rank === rank) {
          const place = rank < 0 ? ` (in ${config})` : '';
          const name = quoted(parts[p]!.name);
          throw new InputError(`--${said.lock} ${said.pattern} and --${lock} ${pattern} both match ${name}${place}`);
        }
        if (!said || rank >= said.rank) saidOf.set(p, { lock, pattern, rank });
      }
    }
  }
  const said = [...saidOf].map(([p, { lock }]): [number, Lock] => [p, lock]);
  const unsaid = leftOut.flatMap((is, p): [number, Lock][] => (is ? [[p, 'exclude']] : []));
  const groups = Object.fromEntries([...unsaid, ...said]);
  return { preset, ...single, locks: { groups } };
}

/** No part has the name that a flag gives. */
export function noSuchName(flag: string, parts: readonly { aliases: string[] }[]): InputError {
  const names = [...new Set(parts.flatMap(({ aliases }) => aliases))];
  const shown = names.map((name) => cut(name, kMaxCharacters));
  return new InputError(`${flag}: no node or material has this name; there are: ${listed(shown, kMaxNames)}`);
}

/** What to do about a finding, with the flags that reverse its verdicts, if there are any. */
export function adviceOn({ advice, places = [], locks }: Finding): string {
  const locked = places.filter(({ segment }) => locks?.segments?.[segment] !== undefined);
  const flags = new Set(locked.map(({ segment, part }) => `--${locks!.segments![segment]} "${part}"`));
  return flags.size === 0 ? advice : `${advice} To override: ${[...flags].join(' ')}`;
}

/** How many names a message lists at most. */
const kMaxNames = 20;
/** How many characters of a name a message shows at most. */
const kMaxCharacters = 60;

/** A name in a message. */
export const quoted = (name: string): string => `"${cut(name, kMaxCharacters)}"`;

/**
 * Returns a test whether a name matches a pattern, in which `*` matches any text. Takes time in proportion to name and pattern at
 * most, times each other: a regular expression would try all ways to share a name among the stars.
 */
export function matcher(pattern: string): (name: string) => boolean {
  const [first = '', ...pieces] = pattern.split('*');
  const last = pieces.pop();
  return (text) => {
    if (last === undefined) return text === first;
    if (text.length < first.length + last.length || !text.startsWith(first) || !text.endsWith(last)) return false;
    // Each piece where it first occurs: if a name matches at all, it matches so.
    let at = first.length;
    for (const piece of pieces) {
      const found = text.indexOf(piece, at);
      if (found < 0) return false;
      at = found + piece.length;
    }
    return at <= text.length - last.length;
  };
}
