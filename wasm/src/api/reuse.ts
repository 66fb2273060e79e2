import type { Reusable } from '../core/engine.js';
import { CagecastError, show } from './error.js';

/** An option of functions that return arrays. */
export interface Reuse<Result> {
  /**
   * An earlier result of the same function that is no longer needed. It becomes the new result and is returned: typed arrays of the
   * right length are overwritten, others are replaced, so that repeated calls allocate little. The arguments of the call may use
   * the same arrays. If the call throws, the earlier result is unchanged.
   */
  reuse?: Result | undefined;
}

/** The arrays of all results. */
const types = {
  uvs: Float32Array,
  cornerUvs: Float32Array,
  zones: Uint8Array,
  triangles: Uint32Array,
  distances: Float32Array,
  segments: Uint32Array,
  cosmeticTriangles: Uint8Array,
  recovery: Uint32Array,
  indices: Uint32Array,
} as const;
const names = Object.keys(types) as (keyof typeof types)[];

/** Which of them a function returns. */
const projected: readonly (keyof typeof types)[] = ['uvs', 'cornerUvs', 'zones', 'triangles', 'distances', 'segments'];
const namesOf = {
  transfer: [...projected, 'cosmeticTriangles'],
  project: [...projected, 'recovery', 'indices'],
  classify: ['zones', 'cosmeticTriangles'],
} as const satisfies Record<string, readonly (keyof typeof types)[]>;

/**
 * Checks that `reuse` is a result of the function and can be overwritten.
 * @returns its arrays by name.
 * @throws {CagecastError} `badOption`
 */
export function checkReuse(fn: keyof typeof namesOf, reuse: unknown): Reusable {
  const arrays: Reusable = {};
  if (reuse === undefined) return arrays;
  const wrong = (text: string, cause?: unknown) =>
    new CagecastError('badOption', `${fn}: options.reuse${text}; pass an earlier result of ${fn}()`, 0, { cause });
  if (typeof reuse !== 'object' || reuse === null) throw wrong(` is ${show(reuse)}`);
  const buffers: ArrayBufferLike[] = [];
  const own: readonly string[] = namesOf[fn];
  for (const name of names) {
    const array = (reuse as Record<string, unknown>)[name];
    if (!own.includes(name)) {
      if (array !== undefined) throw wrong(`.${name} is ${show(array)}, which this function does not return`);
      continue;
    }
    if (!(array instanceof types[name])) throw wrong(`.${name} is ${show(array)}, not a ${types[name].name}`);
    if (buffers.includes(array.buffer)) throw wrong(`.${name} shares its memory with another of its arrays`);
    buffers.push(array.buffer);
    arrays[name] = array;
  }
  try {
    // A frozen object throws here, before anything is written.
    Object.assign(reuse, reuse);
  } catch (cause) {
    throw wrong(` cannot be written to (${String(cause)})`, cause);
  }
  return arrays;
}

/** Returns the result, written into the earlier one if there is one to reuse. */
export const handOver = <Result extends object>(result: Result, reuse: Result | undefined): Result =>
  reuse ? Object.assign(reuse, result) : result;
