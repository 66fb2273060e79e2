import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import type { CageModel } from 'cagecast/cages';
import { matcher } from '../../wasm/src/core/patterns.js';

/** What is known of each vertex of a target, as a 1 for yes; see README.md. */
export interface Labels {
  /** Must not be painted. */
  ncz: Uint8Array;
  /** Not scored. */
  ignore: Uint8Array;
  /** Its cage says nothing about it. */
  offCage: Uint8Array;
}

const kFields = ['ncz', 'ignore', 'offCage'] as const;
/** What else a labels.json may hold. */
const kOthers = ['parts', '$schema'];
/** How many names a message lists at most. */
const kMaxNames = 20;

/** Reads a file that is an object of JSON. @throws {Error} that names it. */
export function readJson<T = Record<string, unknown>>(path: string): T {
  try {
    const value: unknown = JSON.parse(readFileSync(path, 'utf8'));
    if (typeof value === 'object' && value !== null && !Array.isArray(value)) return value as T;
  } catch (error) {
    throw new Error(`${path}: ${(error as Error).message}`);
  }
  throw new Error(`${path}: an object of JSON is expected, such as {"ncz": ["*eye*"]}`);
}

/**
 * The labels that a file of them holds, per vertex or by names of parts; labels.schema.json describes it.
 * @param path  Where it was read from.
 * @throws {Error} that names the file, the field, the value and what is expected.
 */
export function labelsOf(file: Readonly<Record<string, unknown>>, path: string, target: CageModel): Labels {
  // The samples' truth.json has more, for tests.
  const unknown =
    basename(path) === 'labels.json' && Object.keys(file).find((key) => ![...kFields, ...kOthers].includes(key));
  if (unknown)
    throw new Error(`${path}: there is no field ${JSON.stringify(unknown)}; there are ${kFields.join(', ')}`);
  if (file['ncz'] === undefined) throw new Error(`${path}: ncz is missing; it says what must not be painted`);
  const labels = kFields.map((field) => [field, perVertex(file[field] ?? [], `${path}: ${field}`, target)]);
  return Object.fromEntries(labels) as Labels;
}

function perVertex(value: unknown, what: string, target: CageModel): Uint8Array {
  const vertices = target.positions.length / 3;
  const isByName = Array.isArray(value) && value.every((entry) => typeof entry === 'string');
  if (isByName) return byName(value as string[], what, target);
  if (typeof value !== 'string' && !Array.isArray(value))
    throw new Error(`${what} is ${JSON.stringify(value)}; a string or an array is expected`);
  if (typeof value === 'string' && /[^01]/.test(value))
    throw new Error(
      `${what} is ${JSON.stringify(value)}; names belong in brackets, [${JSON.stringify(value)}], else there is a 0 or a 1 for each vertex`,
    );
  if (value.length !== vertices)
    throw new Error(
      `${what} has ${value.length} values; the target has ${vertices} vertices, and one each is expected`,
    );
  const wrong = [...(value as unknown[])].findIndex((label) => ![0, 1, '0', '1'].includes(label as number));
  if (wrong >= 0) throw new Error(`${what}[${wrong}] is ${JSON.stringify(value[wrong])}; 0 or 1 is expected`);
  return Uint8Array.from(value as unknown as number[]);
}

function byName(
  patterns: readonly string[],
  what: string,
  { positions, groups, names: all = [] }: CageModel,
): Uint8Array {
  const names = all.map((part) => [part].flat());
  const isMeant = new Uint8Array(names.length);
  for (const pattern of patterns) {
    const matches = matcher(pattern.toLowerCase());
    const found = names.flatMap((aliases, p) => (aliases.some((name) => matches(name.toLowerCase())) ? [p] : []));
    if (found.length === 0) {
      const all = [...new Set(names.flat())];
      const more = all.length > kMaxNames ? ` and ${all.length - kMaxNames} more` : '';
      throw new Error(
        `${what}: nothing is named ${JSON.stringify(pattern)}; there are ${all.slice(0, kMaxNames).join(', ')}${more}`,
      );
    }
    for (const p of found) isMeant[p] = 1;
  }
  return Uint8Array.from({ length: positions.length / 3 }, (_, v) => isMeant[groups?.[v] ?? 0] ?? 0);
}
