import { type ErrorDetails, show } from '../core/error.js';
import { CagecastError } from '../index.js';
import { checkGeometry } from './check-geometry.js';
import { InputError } from './input-error.js';
import { checkBytes, checkLimits, defaultLimits, type ReadLimits } from './limits.js';
import { parseGltf } from './parse.js';

/** Options of `checkGltf`. */
export interface CheckOptions {
  /** Limits other than the default ones. */
  limits?: { [Name in keyof ReadLimits]?: number | undefined } | undefined;
  /** Bytes of the files that this one refers to. Default: 0 */
  otherBytes?: number | undefined;
}

/**
 * Checks a GLB or glTF file before anything else reads it: its references, the ranges of its data, and what decoding and showing it
 * would cost. Loaders such as GLTFLoader and glTF-Transform trust a file, and a kilobyte can demand all memory. Takes about as long
 * as parsing its JSON. It decodes nothing: values of vertices and indices are not checked.
 * @param bytes  The whole file.
 * @throws {CagecastError} `badArgument` that names the element, the value and the limit.
 */
export function checkGltf(bytes: Uint8Array, { limits = {}, otherBytes = 0, ...others }: CheckOptions = {}): void {
  const wrong = (text: string, details?: ErrorDetails) => new CagecastError('badArgument', 'checkGltf', text, details);
  if (!(bytes instanceof Uint8Array)) throw wrong(`bytes is ${show(bytes)}, not a Uint8Array`, { argument: 'bytes' });
  for (const name in others) throw wrong(`${name} is not an option`);
  const isCount = (value: unknown): value is number => typeof value === 'number' && value >= 0;
  const all = { ...defaultLimits };
  for (const name in limits) {
    const value = limits[name as keyof ReadLimits] ?? all[name as keyof ReadLimits];
    if (!(name in all && isCount(value)))
      throw wrong(`limits.${name} = ${show(value)} is not a number ≥ 0 of one of ${Object.keys(all).join(', ')}`);
    all[name as keyof ReadLimits] = value;
  }
  if (!isCount(otherBytes)) throw wrong(`otherBytes = ${show(otherBytes)} is not a number ≥ 0`);
  try {
    const fileBytes = bytes.byteLength + otherBytes;
    checkBytes(fileBytes, all);
    const { json, binary } = parseGltf(bytes, all);
    const sizes = (json.buffers ?? []).map(({ uri, byteLength }, b) =>
      uri === undefined ? (b === 0 ? binary?.byteLength : undefined) : byteLength,
    );
    checkGeometry(json, sizes);
    checkLimits(json, fileBytes, all);
  } catch (error) {
    throw error instanceof InputError ? wrong(error.message, { cause: error }) : error;
  }
}
