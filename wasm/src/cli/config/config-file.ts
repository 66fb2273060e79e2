import { existsSync, readFileSync } from 'node:fs';
import { basename, dirname, extname, join, relative, resolve } from 'node:path';
import { reasons, standard } from '../../gltf/files.js';
import { firstLine, InputError } from '../../gltf/input-error.js';
import { matcher } from '../options.js';
import { isObject, parseObject, refuseUnknown, type Settings, settingNames, settingsOf } from './settings.js';

/** The name under which configuration files are found. */
export const configName = 'cagecast.config.json';

interface ConfigFile {
  /** As it is shown: from the current folder, or absolute if it is not below. */
  path: string;
  common: Settings;
  characters: { matches: (name: string) => boolean; settings: Settings }[];
}

/** What a configuration file says of a target. */
export interface ConfigSettings extends Settings {
  /** The file. */
  path: string;
}

/** Finds the configuration files of targets, and reads each once. */
export class Configuration {
  readonly #given: string | false | undefined;
  readonly #byPath = new Map<string, ConfigFile>();
  readonly #byFolder = new Map<string, string | undefined>();

  /** @param given  The file for all targets; `false` for none; by default, the nearest from the folder of a target upwards. */
  constructor(given?: string | false) {
    this.#given = given;
  }

  /**
   * What the file says of a target; `undefined` if there is no file. Later characters win over earlier ones, which win over what
   * holds for all; their lists of names are joined.
   * @throws {InputError} that names the file, the member and its value.
   */
  settingsFor(target: string): ConfigSettings | undefined {
    if (this.#given === false) return undefined;
    const path = this.#given ?? this.#find(resolve(target === standard ? '.' : dirname(target)));
    if (path === undefined) return undefined;
    const file = this.#read(path);
    const name = basename(target);
    const own = file.characters.filter(({ matches }) => matches(name) || matches(basename(name, extname(name))));
    const all = [file.common, ...own.map(({ settings }) => settings)];
    const joined = (list: 'keep' | 'exclude') => [...new Set(all.flatMap((settings) => settings[list] ?? []))];
    return {
      ...Object.assign({}, ...all),
      single: Object.assign({}, ...all.map(({ single }) => single)),
      keep: joined('keep'),
      exclude: joined('exclude'),
      path: file.path,
    } as ConfigSettings;
  }

  #find(folder: string): string | undefined {
    if (!this.#byFolder.has(folder)) {
      const path = join(folder, configName);
      const parent = dirname(folder);
      this.#byFolder.set(folder, existsSync(path) ? path : parent === folder ? undefined : this.#find(parent));
    }
    return this.#byFolder.get(folder);
  }

  #read(path: string): ConfigFile {
    const known = this.#byPath.get(path) ?? readConfig(path);
    this.#byPath.set(path, known);
    return known;
  }
}

function readConfig(path: string): ConfigFile {
  const shown = relative('.', path).startsWith('..') ? path : relative('.', path);
  try {
    return { path: shown, ...parseConfig(readText(path), dirname(path)) };
  } catch (error) {
    throw error instanceof InputError ? error.in(shown) : error;
  }
}

function readText(path: string): string {
  try {
    return readFileSync(path, 'utf8');
  } catch (error) {
    const reason = reasons[(error as NodeJS.ErrnoException).code ?? ''];
    throw new InputError(reason ?? `cannot be read (${firstLine(error)})`, { cause: error });
  }
}

function parseConfig(text: string, folder: string): Omit<ConfigFile, 'path'> {
  const all = parseObject(text);
  refuseUnknown(all, [...settingNames, 'characters']);
  const { characters = {} } = all;
  if (!isObject(characters)) throw new InputError('"characters" is not an object of patterns and settings');
  return {
    common: settingsOf(all, folder),
    characters: Object.entries(characters).map(([pattern, given]) => {
      try {
        if (!isObject(given)) throw new InputError('is not an object of settings');
        refuseUnknown(given, settingNames);
        return { matches: matcher(pattern), settings: settingsOf(given, folder) };
      } catch (error) {
        throw error instanceof InputError ? error.in(`"characters" "${pattern}"`) : error;
      }
    }),
  };
}
