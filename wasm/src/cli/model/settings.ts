import type { Preset, PresetOptions } from '../../api/index.js';
import { optionValues } from '../../generated/options.js';
import { type Form, forms } from '../../gltf/glb-writer.js';
import type { Borders } from '../../parts/cut-part.js';
import { InputError } from '../../scene/input-error.js';
import { type Json, pathOf } from './json.js';
import { shown } from './text.js';

/** Options of `transfer` that were given; the preset has the others. */
type GivenOptions = Partial<Omit<PresetOptions, 'steps'>>;

/** What can be said of a transfer besides its files: by flags, in a configuration file, in a line of a manifest. */
export interface Settings extends GivenOptions {
  preset?: Preset;
  borders?: Borders;
  compress?: Form;
  /** Names of nodes or materials, `*` for any text, whose parts are always painted. */
  keep?: string[];
  /** The same for parts that are never painted. */
  exclude?: string[];
  /** The same for parts that are left out: neither painted nor in the way. An empty name adds what is not drawn. */
  ignore?: string[];
  /** Images in the target's own UVs that are white where it is never, or always, painted. */
  neverMask?: string;
  alwaysMask?: string;
  /** An attribute with colours: red for never, green for always. */
  maskColors?: string;
}

/** The values of settings that are one of some words. */
export const kChoices = {
  preset: ['default', 'paper'],
  borders: ['triangle', 'cut'],
  compress: forms,
} as const satisfies Partial<Record<keyof Settings, readonly string[]>>;

const kMaskNames = ['neverMask', 'alwaysMask', 'maskColors'] as const;

/** The names of settings, in JSON and of flags. */
export const kSettingNames: readonly string[] = [
  ...Object.keys(kChoices),
  ...['keep', 'exclude', 'ignore'],
  ...kMaskNames,
  ...optionValues.map(({ name }) => name),
];

/** What holds colours, and whether a name is of that kind. */
export const colorAttributes = 'COLOR_0, COLOR_1, … or an attribute of an own name, which begins with _';
export const holdsColors = (name: unknown): boolean => typeof name === 'string' && /^(COLOR_\d+|_.+)$/.test(name);

/** How JSON writes a number without end. */
const kInfinite = 'Infinity';

/**
 * Checks settings that were read from JSON; other members of the object are ignored.
 * @param folder  Where paths begin.
 * @throws {InputError} that names the member, its value and what it may be.
 */
export function settingsOf(given: Json, folder: string): Settings {
  const settings: Record<string, unknown> = {};
  const take = (name: string, isRight: (value: unknown) => boolean, text: string, value = given[name]) => {
    if (value === undefined) return;
    if (!isRight(value)) throw new InputError(`"${name}" is ${shown(given[name])}, not ${text}`);
    settings[name] = value;
  };
  const takeChoice = (name: string, words: readonly unknown[]) =>
    take(name, (value) => words.includes(value), `one of ${words.join(', ')}`);
  for (const [name, words] of Object.entries(kChoices)) takeChoice(name, words);
  const isName = (value: unknown) => typeof value === 'string' && value !== '';
  for (const name of ['keep', 'exclude'])
    take(name, (value) => Array.isArray(value) && value.every(isName), 'an array of names');
  const isText = (value: unknown) => typeof value === 'string';
  take('ignore', (value) => Array.isArray(value) && value.every(isText), 'an array of names');
  for (const name of ['neverMask', 'alwaysMask']) {
    const path = pathOf(given, name, folder);
    if (path !== undefined) settings[name] = path;
  }
  take('maskColors', holdsColors, colorAttributes);
  for (const { name, kind, range } of optionValues) {
    if (kind === 'choice' || kind === 'toggle') takeChoice(name, range);
    else {
      const [least, most] = range as readonly [number, number];
      const isWithin = (value: unknown) => typeof value === 'number' && value >= least && value <= most;
      const value = given[name] === kInfinite && most === Infinity ? Infinity : given[name];
      take(name, isWithin, `a number within ${least}..${most}`, value);
    }
  }
  return settings as Settings;
}

/** Settings of one origin. */
export interface Layer {
  settings: Settings;
  /** The configuration file that they are from, if they are from one. */
  config?: {
    path: string;
    /** Where masks have to be, if nobody named the file, which may be a stranger's. */
    folder: string | undefined;
  };
  /** Whether they are flags. */
  isFlags?: boolean;
}

type Lock = 'keep' | 'exclude';

/** A name of parts. */
interface NamedParts {
  pattern: string;
  /** How late it is said, which decides where several match. */
  rank: number;
  /** Whether it may match nothing: a configuration file speaks of many models, and not each of them has every part. */
  isOptional: boolean;
}

/** A name of parts, and whether they are kept or excluded. */
interface NameRule extends NamedParts {
  lock: Lock;
}

/** An image, and the configuration file that names it. */
interface MaskFile {
  path: string;
  config?: Layer['config'];
}

/** The options of a transfer. */
export interface Rules {
  preset: Preset;
  single: GivenOptions;
  names: NameRule[];
  ignored: NamedParts[];
  masks: { never?: MaskFile; always?: MaskFile; colors?: string };
  /** The configuration file that some of it comes from. */
  config?: string;
}

/** All settings of a transfer. */
export interface ResolvedSettings {
  rules: Rules;
  /** Whether the paint ends at existing triangle edges, or triangles are cut where it ends. */
  borders: Borders;
  /** How the geometry of the output is compressed. */
  compress: Form;
}

/**
 * Settings of which later ones win. Lists of names from configuration files are joined; a later list replaces them. Masks are replaced
 * one by one, but by flags all at once.
 */
export function resolveSettings(layers: readonly Layer[]): ResolvedSettings {
  const all = Object.assign({}, ...layers.map(({ settings }) => settings)) as Settings;
  const { preset = 'default', borders = 'triangle', compress = 'keep' } = all;
  const given = optionValues.map(({ name }) => [name, all[name]]).filter(([, value]) => value !== undefined);
  const config = layers.find((layer) => layer.config)?.config?.path;
  return {
    rules: {
      preset,
      single: Object.fromEntries(given),
      names: (['keep', 'exclude'] as const).flatMap((lock) =>
        namesOf(layers, lock).map((named) => ({ ...named, lock })),
      ),
      ignored: namesOf(layers, 'ignore'),
      masks: masksOf(layers),
      ...(config !== undefined && { config }),
    },
    borders,
    compress,
  };
}

function namesOf(layers: readonly Layer[], list: Lock | 'ignore'): NamedParts[] {
  const saying = layers.map((layer, rank) => ({ ...layer, rank })).filter(({ settings }) => settings[list]);
  const counting = saying.at(-1)?.config ? saying : saying.slice(-1);
  return counting.flatMap(({ settings, config, rank }) =>
    settings[list]!.map((pattern) => ({ pattern, rank, isOptional: config !== undefined })),
  );
}

function masksOf(layers: readonly Layer[]): Rules['masks'] {
  const saying = layers.filter(({ settings }) => kMaskNames.some((name) => settings[name] !== undefined));
  const flags = saying.findIndex(({ isFlags }) => isFlags);
  const masks: Rules['masks'] = {};
  for (const { settings, config } of saying.slice(Math.max(0, flags))) {
    const { neverMask, alwaysMask, maskColors } = settings;
    const file = (path: string) => ({ path, ...(config && { config }) });
    if (neverMask !== undefined) masks.never = file(neverMask);
    if (alwaysMask !== undefined) masks.always = file(alwaysMask);
    if (maskColors !== undefined) masks.colors = maskColors;
  }
  return masks;
}
