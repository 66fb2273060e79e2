import { resolve } from 'node:path';
import { firstLine, InputError } from '../../scene/input-error.js';
import { shown } from './text.js';

/** An object from JSON. */
export type Json = Readonly<Record<string, unknown>>;

export const isObject = (value: unknown): value is Json =>
  typeof value === 'object' && value !== null && !Array.isArray(value);

/** Reads an object from JSON. @throws {InputError} if the text is no JSON, or not that of an object. */
export function parseObject(text: string): Json {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch (error) {
    throw new InputError(`is not JSON (${firstLine(error)})`);
  }
  if (!isObject(value)) throw new InputError('is not a JSON object');
  return value;
}

/** @throws {InputError} for a member that is not among the known ones. */
export function refuseUnknown(given: Json, known: readonly string[]): void {
  const unknown = Object.keys(given).find((name) => !known.includes(name));
  if (unknown !== undefined) throw new InputError(`"${unknown}" is unknown; there are: ${known.join(', ')}`);
}

/** The path that an object has by a name, from a folder on, if it has one. @throws {InputError} that names the member. */
export function pathOf(given: Json, name: string, folder: string): string | undefined {
  const path = given[name];
  if (path === undefined) return undefined;
  if (typeof path !== 'string') throw new InputError(`"${name}" is ${shown(path)}, not a path`);
  if (path === '') throw new InputError(`"${name}" is empty`);
  return resolve(folder, path);
}
