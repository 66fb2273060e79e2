import { resolve } from 'node:path';
import { optionFlags } from '../../generated/options.js';
import { type Form, forms } from '../../gltf/glb-writer.js';
import { firstLine, InputError } from '../../gltf/input-error.js';
import type { Preset } from '../../index.js';
import type { Borders } from '../../parts/borders-option.js';
import {
  colorAttributes,
  type GivenOptions,
  holdsColors,
  infinite,
  type MaskFiles,
  presets,
  quoted,
} from '../options.js';

/** How paint may end: at existing edges of triangles, or where triangles are cut. */
export const borderKinds: readonly Borders[] = ['triangle', 'cut'];

/** What can be said of a transfer besides its files: by flags, in a configuration file, in a line of a manifest. */
export interface Settings {
  preset?: Preset;
  borders?: Borders;
  compress?: Form;
  keep?: string[];
  exclude?: string[];
  masks?: MaskFiles;
  single: GivenOptions;
}

/** The names of settings in JSON. */
export const settingNames: readonly string[] = [
  'preset',
  'borders',
  'compress',
  'keep',
  'exclude',
  'neverMask',
  'alwaysMask',
  'maskColors',
  ...optionFlags.map(({ name }) => name),
];

const choices: Readonly<Record<string, readonly string[]>> = {
  preset: presets,
  borders: borderKinds,
  compress: forms,
};

/** A value in a message. JSON has no infinite numbers. */
export const shown = (value: unknown): string =>
  quoted(typeof value === 'number' ? String(value) : JSON.stringify(value)).slice(1, -1);

/** The path that an object from JSON has by a name, from a folder on, if it has one. @throws {InputError} that names the member. */
export function pathOf(given: Readonly<Record<string, unknown>>, name: string, folder: string): string | undefined {
  const path = given[name];
  if (path === undefined) return undefined;
  if (typeof path !== 'string') throw new InputError(`"${name}" is ${shown(path)}, not a path`);
  if (path === '') throw new InputError(`"${name}" is empty`);
  return resolve(folder, path);
}

/**
 * Checks settings that were read from JSON; other members of the object are ignored.
 * @param folder  Where paths begin.
 * @throws {InputError} that names the member, its value and what it may be.
 */
export function settingsOf(given: Readonly<Record<string, unknown>>, folder: string): Settings {
  const wrong = (name: string, text: string) => new InputError(`"${name}" is ${shown(given[name])}, not ${text}`);
  const settings: Record<string, unknown> = {};
  const single: Record<string, unknown> = {};
  for (const [name, known] of Object.entries(choices)) {
    if (given[name] === undefined) continue;
    if (!known.includes(given[name] as string)) throw wrong(name, `one of ${known.join(', ')}`);
    settings[name] = given[name];
  }
  for (const name of ['keep', 'exclude']) {
    const list = given[name];
    if (list === undefined) continue;
    if (!(Array.isArray(list) && list.every((one) => typeof one === 'string'))) throw wrong(name, 'an array of names');
    settings[name] = list;
  }
  const [never, always] = ['neverMask', 'alwaysMask'].map((name) => pathOf(given, name, folder));
  const { maskColors: colors } = given;
  if (colors !== undefined && !(typeof colors === 'string' && holdsColors(colors)))
    throw wrong('maskColors', colorAttributes);
  if ((never ?? always ?? colors) !== undefined) settings['masks'] = { never, always, colors };
  for (const { name, kind, range } of optionFlags) {
    const value = given[name] === infinite && range[1] === Infinity ? Infinity : given[name];
    if (value === undefined) continue;
    if (kind === 'choice') {
      if (!(range as readonly unknown[]).includes(value)) throw wrong(name, `one of ${range.join(', ')}`);
    } else if (!(typeof value === 'number' && value >= range[0] && value <= range[1]))
      throw wrong(name, `a number within ${range[0]}..${range[1]}`);
    single[name] = value;
  }
  return { ...settings, single } as Settings;
}

/** Masks of which later ones win, each by itself; `undefined` if there are none. */
export function mergeMasks(...all: (MaskFiles | undefined)[]): MaskFiles | undefined {
  const given = all.flatMap((masks) => Object.entries(masks ?? {}).filter(([, value]) => value !== undefined));
  return given.length > 0 ? Object.fromEntries(given) : undefined;
}

/** @throws {InputError} for a member that is not among the known ones. */
export function refuseUnknown(given: object, known: readonly string[]): void {
  const unknown = Object.keys(given).find((name) => !known.includes(name));
  if (unknown !== undefined) throw new InputError(`"${unknown}" is unknown; there are: ${known.join(', ')}`);
}

export const isObject = (value: unknown): value is Record<string, unknown> =>
  typeof value === 'object' && value !== null && !Array.isArray(value);

/** Reads an object from JSON. @throws {InputError} if the text is no JSON, or not that of an object. */
export function parseObject(text: string): Record<string, unknown> {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch (error) {
    throw new InputError(`is not JSON (${firstLine(error)})`);
  }
  if (!isObject(value)) throw new InputError('is not a JSON object');
  return value;
}
