// Flags that several commands have, as commander parses them.
import { type Command, InvalidArgumentError, Option } from 'commander';
import { templateNames } from '../../cages/template-names.js';
import { optionValues } from '../../generated/options.js';
import { defaultLimits, type ReadLimits } from '../../gltf/checks/read-limits.js';
import { type FormatLimits, formatDefaults } from '../../gltf/formats/limits.js';
import type { UvSetChoice } from '../../scene/uv-sets.js';
import { standard } from '../io/files.js';
import { UsageError } from '../model/failures.js';
import type { ReadOptions } from '../model/reading.js';
import {
  colorAttributes,
  holdsColors,
  kChoices,
  kSettingNames,
  type Layer,
  type Settings,
  settingsOf,
} from '../model/settings.js';
import { kAutoCage, type Region } from '../model/sources.js';
import { areBounds, boundsText, type UvBounds } from '../model/uv-bounds.js';
import { Configuration, configName } from './config-file.js';

/** The flags that say what is painted. */
export interface SettingFlags extends Pick<Settings, 'threshold' | 'keep' | 'exclude' | 'borders' | 'compress'> {
  /** Other options, by their names. */
  set?: Settings & CageSettings;
  mask?: Pick<Settings, 'neverMask' | 'alwaysMask' | 'maskColors'>;
  config?: string | undefined;
}

/** Options of `--set` that say which part of a cage counts. */
interface CageSettings {
  cageUvs?: UvSetChoice;
  uvBounds?: UvBounds;
  referenceCage?: string;
}

/** The flags that say how files are read. */
export interface ReadFlags {
  allowOutside?: boolean;
  /** Names of parts of the target that are left out. */
  ignore?: string[];
  limit?: Partial<ReadLimits & FormatLimits>;
}

/** The flags that say what is printed. */
export interface PrintFlags {
  json?: boolean;
  quiet?: boolean;
}

/** An option with a parser of its value. */
export const parsed = <Value>(
  flags: string,
  text: string,
  parse: (value: string, before: Value | undefined) => Value,
): Option => new Option(flags, text).argParser(parse);

/** Parses an option that may be repeated. */
export const oneMore = (value: string, before: string[] = []): string[] => [...before, value];

/** An option that is one of some words. Settings have no default here: a configuration may say otherwise. */
const choice = (flags: string, text: string, words: readonly string[]): Option =>
  new Option(flags, `${text} (default: ${words[0]})`).choices(words);

export const bordersFlag = (): Option =>
  choice(
    '--borders <HOW>',
    'where paint ends: at edges of triangles, or exactly, where they are cut',
    kChoices.borders,
  );

const kOutputFlags = [
  bordersFlag(),
  choice('--compress <HOW>', 'how painted meshes are compressed; keep: as in TARGET', kChoices.compress),
  parsed(
    '--region <CAGE=PAINT>',
    'another cage with its texture, for triangles that no cage before it paints; may be repeated',
    regionOf,
  ).default([], 'none'),
];

/** The flag for a report about a cage. */
export const reportFlag = (): Option =>
  parsed(
    '--report <REPORT>',
    'an .html page with pictures, or what --json prints as .json',
    endingIn('.html', '.json'),
  );

/** What counts, by name; `--ignore` is one of the flags for reading. */
const kPartFlags = [
  parsed(
    '--keep <NAME>',
    'paint parts of this node, mesh or material wherever the cage covers them, whatever rules and names say. The whole name, in any case; * matches any text; a node that holds others means all below it; may be repeated',
    oneMore,
  ),
  parsed('--exclude <NAME>', 'never paint parts of this name; as --keep', oneMore),
];

const kCageFileFlags = [
  parsed(
    '-o, --output <CAGE.glb>',
    'where to write the cage; - for the standard output',
    endingIn('.glb'),
  ).makeOptionMandatory(),
  reportFlag(),
];

/** Options of `--set` about the cage alone. */
const kCageSettings =
  "cageUvs=SET (the UV set of the cage that the texture was drawn in, by its number, from 0, or its name; default: that of its own texture, else as its name tells, else the first), uvBounds=U0,V0,U1,V1 (the part of the cage's UVs that the texture covers; nothing is painted outside; default: all, and the texture covers 0..1), referenceCage=CAGE (another version of the cage; where its UVs have no triangle, --cage counts as having a hole)";

const kThreshold = optionValues.find(({ name }) => name === 'threshold')!;
const kOthers = optionValues.filter((option) => option !== kThreshold);
const kSetNames: readonly string[] = [
  'preset',
  ...kOthers.map(({ name }) => name),
  'cageUvs',
  'uvBounds',
  'referenceCage',
];

/** Flags that were called otherwise. */
const kRenamed: Record<string, string> = {
  html: '--report REPORT.html',
  normal: '--map normal=MAP',
  orm: '--map orm=MAP',
  templateLandmarks: '--landmarks template=T.json',
  failOn: '--at-least VERDICT',
};

/** A text as commander has it: from a small letter on, without a full stop. */
const clause = (text: string): string => `${text[0]!.toLowerCase()}${text.slice(1).replace(/\.$/, '')}`;

const kSettingFlags = [
  parsed('--threshold <SHARE>', `${clause(kThreshold.text)}; default: ${kThreshold.standard}`, numberWithin(0, 1)),
  parsed(
    '--set <NAME=VALUE>',
    `set another option, as in code: preset (default or paper: values of the options that are not given), ${kOthers.map(({ name, standard }) => `${name} (default: ${standard})`).join(', ')}, ${kCageSettings}; may be repeated`,
    optionOf,
  ),
  parsed(
    '--mask <KIND=SOURCE>',
    "paint by a mask in TARGET's own UVs: never=IMAGE never where it is white, always=IMAGE there, whatever the rules say; colors=ATTRIBUTE, such as COLOR_0, never red vertices, always green ones; may be repeated",
    maskOf,
  ),
  new Option(
    '--config <FILE>',
    `settings for all files, and by their names; none reads none (default: the nearest ${configName})`,
  ),
];

const kReadFlags = [
  parsed(
    '--ignore <NAME>',
    'leave parts of this name out, as if they were not there; as --keep. What a viewer does not draw is left out, too, as are cages, markers and collision shapes, by their names, unless --keep names them',
    oneMore,
  ),
  new Option(
    '--allow-outside',
    `read also files outside the folder of the glTF, or found ${configName}, that names them`,
  ),
  parsed(
    '--limit <NAME=VALUE>',
    `what reading a file may cost; may be repeated (default: ${Object.entries(defaultLimits)
      .map(([name, value]) => `${name}=${value}`)
      .join(', ')}; of other formats also ${Object.entries(formatDefaults)
      .map(([name, value]) => (typeof value === 'number' ? `${name}=${value}` : `${name}, ${value}`))
      .join('; ')})`,
    limitOf,
  ),
];

const kPrintFlags = [new Option('--json', 'print JSON'), new Option('--quiet', 'print nothing but errors')];

/** Groups of flags, by their heading in the help. */
const kGroups = {
  Output: kOutputFlags,
  Parts: kPartFlags,
  Painting: kSettingFlags,
  'Cage file': kCageFileFlags,
  Reading: kReadFlags,
  Printing: kPrintFlags,
};

/** Groups of the commands that transfer; `inspect` has all but the first. */
export const transferGroups = ['Output', 'Parts', 'Painting', 'Reading', 'Printing'] as const;

/** Adds groups of flags, after the flags that a command has for itself. */
export function addFlags(command: Command, ...headings: (keyof typeof kGroups)[]): Command {
  for (const heading of headings)
    for (const option of kGroups[heading]) command.addOption(option.helpGroup(`${heading}:`));
  return command;
}

/** The name that stands for no configuration; a file of it is ./none. */
const kNoConfig = 'none';

/** What the flags say of settings. */
const flagsLayer = (flags: SettingFlags): Layer => ({
  settings: {
    ...Object.fromEntries(Object.entries({ ...flags, ...flags.set }).filter(([name]) => kSettingNames.includes(name))),
    ...flags.mask,
  },
  isFlags: true,
});

/** Returns what finds the settings of a target: those of its configuration file, then flags. */
export function layersFor(flags: SettingFlags & ReadFlags): (target: string) => Promise<Layer[]> {
  const files = new Configuration(flags.config === kNoConfig ? false : flags.config, readingOf(flags));
  return async (target) => [...(await files.layersFor(target)), flagsLayer(flags)];
}

/** How files are read, by the flags. */
export const readingOf = ({ allowOutside = false, limit }: ReadFlags): ReadOptions => ({
  allowOutside,
  limits: { ...defaultLimits, ...limit },
});

/** The flags that say which cage is meant. */
export interface AroundFlags {
  cage?: string | undefined;
  template?: string | undefined;
}

/** The flag for a cage that is fitted. */
export const templateFlag = (): Option =>
  new Option(
    '--template <TEMPLATE>',
    `instead of a cage: one that is fitted first, as by fit: ${templateNames.join(', ')}, or a file; auto chooses`,
  );

export const eitherCage = 'give either --cage or --template';

/** Where a cage comes from, by its flags. @throws {UsageError} */
export function aroundOf({ cage, template }: AroundFlags, target: string) {
  if (cage !== undefined && template !== undefined) throw new UsageError(eitherCage);
  return template === undefined
    ? { cage: cage ?? target, isOwnCage: cage === undefined }
    : { cage: kAutoCage, template, isOwnCage: false };
}

interface InputFlags extends SettingFlags, AroundFlags {
  texture?: string | undefined;
  region?: readonly Region[];
}

/** Why a command that paints with the whole cage does not take some of `--set`, if they are given. */
export const wholeCageFault = ({ uvBounds, referenceCage }: CageSettings = {}): string | undefined =>
  (uvBounds ?? referenceCage) === undefined
    ? undefined
    : 'uvBounds and referenceCage are options of transfer, inspect and batch alone';

/** The files that flags name as inputs. */
export const inputsOf = ({ cage, template, texture, region = [], set = {}, mask = {}, config }: InputFlags): string[] =>
  [
    template,
    ...[cage, ...region.map((one) => one.cage)].filter((path) => path !== kAutoCage),
    ...[set.referenceCage, texture, ...region.map((one) => one.texture), mask.neverMask, mask.alwaysMask],
    config === kNoConfig ? undefined : config,
  ].filter((path) => path !== undefined);

/** What is wrong with flags about an output that is not given, if anything is. */
export function outputFault({
  output,
  texture,
  region = [],
  borders,
}: InputFlags & { output?: string | undefined }): string | undefined {
  if (output !== undefined) return undefined;
  if (texture !== undefined) return '--texture needs -o OUT.glb, the file to add it to';
  if (region.length > 0) return '--region needs -o OUT.glb, the file to add it to';
  return borders === 'cut' ? '--borders cut needs -o OUT.glb, the file for the cut target' : undefined;
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

/** Returns a parser for the name of a file with one of some endings, or of the standard output. */
export function endingIn(...endings: string[]): (text: string) => string {
  return (text) => {
    if (text !== standard && !endings.some((ending) => text.toLowerCase().endsWith(ending)))
      throw new InvalidArgumentError(`Its name must end in ${endings.join(' or ')}, or be -, the standard output.`);
    return text;
  };
}

function boundsOf(text: string): UvBounds {
  const bounds = text.split(',').map((number) => (number.trim() === '' ? Number.NaN : Number(number)));
  if (!areBounds(bounds)) throw new InvalidArgumentError(`It is not ${boundsText}.`);
  return bounds;
}

function regionOf(text: string, before: Region[] = []): Region[] {
  // Names of folders may have a = in them, such as run=3.
  const [, cage, texture] = /^(.+?\.(?:glb|gltf|vrm)|[^=]+)=(.+)$/i.exec(text) ?? [];
  if (cage === undefined || texture === undefined)
    throw new InvalidArgumentError('It is not the file of a cage and that of a texture, with = between them.');
  return [...before, { cage, texture }];
}

type Limits = NonNullable<ReadFlags['limit']>;

function limitOf(text: string, before: Limits = {}): Limits {
  const [name = '', value = ''] = text.split('=', 2);
  const names = Object.keys({ ...defaultLimits, ...formatDefaults });
  if (!names.includes(name)) throw new InvalidArgumentError(`There are the limits ${names.join(', ')}.`);
  if (!/^\d+$/.test(value)) throw new InvalidArgumentError(`A limit is a whole number, such as ${name}=5000.`);
  return { ...before, [name]: Number(value) };
}

/** What to write for an unknown flag that is called as an option, if it is. @param text  Commander's message. */
export function insteadOf(text: string): string {
  const [, flag = ''] = /unknown option '--([\w-]+)/.exec(text) ?? [];
  const name = flag.replace(/-(\w)/g, (_, letter: string) => letter.toUpperCase());
  if (kSetNames.includes(name)) return `; it is set by --set ${name}=VALUE`;
  const now = kRenamed[name];
  return now === undefined ? '' : `; it is ${now}`;
}

function optionOf(text: string, before: Settings & CageSettings = {}): Settings & CageSettings {
  const [, name = text, value = ''] = /^(.*?)=(.*)$/s.exec(text) ?? [];
  if (name === kThreshold.name) throw new InvalidArgumentError(`It has a flag of its own: --threshold ${value}`);
  if (!kSetNames.includes(name)) throw new InvalidArgumentError(`There are ${kSetNames.join(', ')}.`);
  if (name === 'cageUvs' && value !== '') return { ...before, cageUvs: /^\d+$/.test(value) ? Number(value) : value };
  if (name === 'uvBounds') return { ...before, uvBounds: boundsOf(value) };
  if (name === 'referenceCage' && value !== '') return { ...before, referenceCage: value };
  const word = { true: true, false: false, Infinity: 'Infinity' }[value];
  const number = value.trim() === '' ? Number.NaN : Number(value);
  try {
    return { ...before, ...settingsOf({ [name]: word ?? (Number.isNaN(number) ? value : number) }, '') };
  } catch (error) {
    throw new InvalidArgumentError((error as Error).message);
  }
}

const kMasks: Record<string, keyof Settings> = { never: 'neverMask', always: 'alwaysMask', colors: 'maskColors' };

function maskOf(text: string, before: Settings = {}): Settings {
  const [, kind = '', source = ''] = /^(\w+)=(.+)$/.exec(text) ?? [];
  const name = kMasks[kind];
  if (!name) throw new InvalidArgumentError('It is not never=IMAGE, always=IMAGE or colors=ATTRIBUTE.');
  if (kind === 'colors' && !holdsColors(source)) throw new InvalidArgumentError(`${source} is not ${colorAttributes}.`);
  return { ...before, [name]: source };
}
