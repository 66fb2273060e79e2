import { lstatSync } from 'node:fs';
import { realpath } from 'node:fs/promises';
import { basename, dirname, extname, join, relative, resolve } from 'node:path';
import { matcher } from '../../core/patterns.js';
import { InputError, naming } from '../../scene/input-error.js';
import { isOutside, readBeside, readBytes, standard } from '../io/files.js';
import { isObject, parseObject, refuseUnknown } from '../model/json.js';
import type { ReadOptions } from '../model/reading.js';
import { kSettingNames, type Layer, type Settings, settingsOf } from '../model/settings.js';
import { shown } from '../model/text.js';

/** The name under which configuration files are found. */
export const configName = 'cagecast.config.json';

interface ConfigFile {
  /** As it is shown: from the current folder, or absolute if it is not below. */
  path: string;
  common: Settings;
  characters: { matches: (name: string) => boolean; settings: Settings }[];
}

/** Finds the configuration files of targets, and reads each once. */
export class Configuration {
  readonly #given: string | false | undefined;
  readonly #reading: ReadOptions;
  readonly #byPath = new Map<string, Promise<ConfigFile>>();
  readonly #byFolder = new Map<string, string | undefined>();

  /** @param given  The file for all targets; `false` for none; by default, the nearest from the folder of a target upwards. */
  constructor(given: string | false | undefined, reading: ReadOptions) {
    this.#given = given;
    this.#reading = reading;
  }

  /**
   * What the file says of a target: of all, then by the characters that match, in their order. Nothing if there is no file.
   * @throws {InputError} that names the file, the member and its value.
   */
  async layersFor(target: string): Promise<Layer[]> {
    if (this.#given === false) return [];
    const path = this.#given ?? this.#find(resolve(target === standard ? '.' : dirname(target)));
    if (path === undefined) return [];
    const file = await this.#read(path);
    const name = basename(target);
    const own = file.characters.filter(({ matches }) => matches(name) || matches(basename(name, extname(name))));
    const config = { path: file.path, folder: this.#given === undefined ? dirname(path) : undefined };
    return [file.common, ...own.map(({ settings }) => settings)].map((settings) => ({ settings, config }));
  }

  #find(folder: string): string | undefined {
    if (!this.#byFolder.has(folder)) {
      const path = join(folder, configName);
      const parent = dirname(folder);
      this.#byFolder.set(folder, isThere(path) ? path : parent === folder ? undefined : this.#find(parent));
    }
    return this.#byFolder.get(folder);
  }

  #read(path: string): Promise<ConfigFile> {
    const known = this.#byPath.get(path) ?? this.#readNew(path);
    this.#byPath.set(path, known);
    return known;
  }

  #readNew(path: string): Promise<ConfigFile> {
    const shown = relative('.', path).startsWith('..') ? path : relative('.', path);
    const folder = dirname(path);
    return naming(shown, async () => {
      if (this.#given !== undefined)
        return { path: shown, ...parseConfig(await readBytes(path, this.#reading.limits), folder) };
      // The file itself may be a link to anywhere. What it leads to may be secret, which an error would print.
      const bytes = await readBeside(path, folder, { ...this.#reading, allowOutside: true });
      try {
        return { path: shown, ...parseConfig(bytes, folder) };
      } catch (error) {
        if (!isOutside(await realpath(path), await realpath(folder))) throw error;
        throw new InputError('is a link to what is no configuration; --config shows what is wrong with it');
      }
    });
  }
}

/** Whether there is a file, or a link, even one that leads nowhere. If the path cannot be followed, reading the model tells why. */
function isThere(path: string): boolean {
  try {
    return lstatSync(path, { throwIfNoEntry: false }) !== undefined;
  } catch {
    return false;
  }
}

function parseConfig(bytes: Uint8Array, folder: string): Omit<ConfigFile, 'path'> {
  const text = new TextDecoder().decode(bytes);
  const all = parseObject(text);
  refuseUnknown(all, [...kSettingNames, 'characters']);
  const { characters = {} } = all;
  if (!isObject(characters))
    throw new InputError(`"characters" is ${shown(characters)}, not an object of patterns and settings`);
  return {
    common: settingsOf(all, folder),
    characters: inOrder(text).map((pattern) =>
      naming(`"characters" "${pattern}"`, () => {
        const given = characters[pattern];
        if (!isObject(given)) throw new InputError(`is ${shown(given)}, not an object of settings`);
        refuseUnknown(given, kSettingNames);
        return { matches: matcher(pattern), settings: settingsOf(given, folder) };
      }),
    ),
  };
}

/** The names of the characters in the order of the file. Objects put integers first; with a NUL before them, they keep their place. */
function inOrder(text: string): string[] {
  const { characters = {} } = parseObject(text.replace(/"(\d+)"(?=\s*:)/g, '"\\u0000$1"'));
  return Object.keys(characters as object).map((name) => name.replace('\0', ''));
}
