import type { Reusable } from '../core/engine.js';
import { CagecastError, show } from '../core/error.js';
import { type ArrayKind, plainArray, realBuffer, showArray } from '../core/typed-arrays.js';

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
const kTypes = {
  uvs: 'Float32Array',
  cornerUvs: 'Float32Array',
  visibility: 'Uint8Array',
  zones: 'Uint8Array',
  triangles: 'Uint32Array',
  distances: 'Float32Array',
  segments: 'Uint32Array',
  cosmeticTriangles: 'Uint8Array',
  recovery: 'Uint32Array',
  hiddenBy: 'Uint32Array',
  hiders: 'Uint32Array',
  indices: 'Uint32Array',
} as const satisfies Record<string, ArrayKind>;
const kNames = Object.keys(kTypes) as (keyof typeof kTypes)[];

/** Which of them a function returns. */
const kProjected: readonly (keyof typeof kTypes)[] = ['uvs', 'cornerUvs', 'triangles', 'distances', 'segments'];
const kNamesOf = {
  transfer: [...kProjected, 'zones', 'cosmeticTriangles'],
  project: [...kProjected, 'visibility', 'recovery', 'hiddenBy', 'hiders', 'indices'],
  classify: ['zones', 'cosmeticTriangles'],
} as const satisfies Record<string, readonly (keyof typeof kTypes)[]>;

/**
 * Checks that `reuse` is a result of the function and can be overwritten.
 * @returns its arrays by name.
 * @throws {CagecastError} `badOption`
 */
export function checkReuse(fn: keyof typeof kNamesOf, reuse: unknown): Reusable {
  const arrays: Reusable = {};
  if (reuse === undefined) return arrays;
  const wrong = (text: string, cause?: unknown) =>
    new CagecastError('badOption', fn, `options.reuse${text}; pass an earlier result of ${fn}()`, { cause });
  if (typeof reuse !== 'object' || reuse === null) throw wrong(` is ${show(reuse)}`);
  const buffers: ArrayBufferLike[] = [];
  const returned: readonly string[] = kNamesOf[fn];
  for (const name of kNames) {
    const array = (reuse as Record<string, unknown>)[name];
    if (!returned.includes(name)) {
      if (array !== undefined) throw wrong(`.${name} is ${show(array)}, which this function does not return`);
      continue;
    }
    if (!plainArray(array, kTypes[name]))
      throw wrong(`.${name} is ${showArray(array, kTypes[name])}, not a ${kTypes[name]}`);
    const own = array as Float32Array | Uint32Array | Uint8Array;
    if (buffers.includes(realBuffer(own))) throw wrong(`.${name} shares its memory with another of its arrays`);
    buffers.push(realBuffer(own));
    arrays[name] = own;
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
