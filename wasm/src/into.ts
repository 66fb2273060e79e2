import type { Reusable } from './bindings.js';
import { CagecastError, show } from './error.js';

/** An option of calls that answer with arrays. */
export interface Into<Answer> {
  /**
   * An earlier answer of the same function that is no longer needed. Its typed arrays are written over where they have the
   * length that is needed, else new ones take their place, and it is itself what is returned: no memory is to be had for them, and
   * none to be collected. They may be those of the arguments too. If the call throws, it stays as it was.
   */
  into?: Answer | undefined;
}

/** The arrays of all answers. */
const types = {
  uvs: Float32Array,
  cornerUvs: Float32Array,
  zones: Uint8Array,
  triangles: Uint32Array,
  distances: Float32Array,
  segments: Uint32Array,
  cosmeticTriangles: Uint8Array,
  restores: Uint32Array,
  indices: Uint32Array,
} as const;
const names = Object.keys(types) as (keyof typeof types)[];

/** Which of them a function answers with. */
const projected: readonly (keyof typeof types)[] = ['uvs', 'cornerUvs', 'zones', 'triangles', 'distances', 'segments'];
const namesOf = {
  transfer: [...projected, 'cosmeticTriangles'],
  project: [...projected, 'restores', 'indices'],
  classify: ['zones', 'cosmeticTriangles'],
} as const satisfies Record<string, readonly (keyof typeof types)[]>;

/**
 * Checks that `into` is an answer of the function, and can be written to.
 * @returns its arrays by name.
 * @throws {CagecastError} `badOption`
 */
export function checkInto(fn: keyof typeof namesOf, into: unknown): Reusable {
  const arrays: Reusable = {};
  if (into === undefined) return arrays;
  const wrong = (text: string, cause?: unknown) =>
    new CagecastError('badOption', `${fn}: options.into${text}; give an earlier answer of ${fn}()`, 0, { cause });
  if (typeof into !== 'object' || into === null) throw wrong(` is ${show(into)}`);
  const buffers: ArrayBufferLike[] = [];
  const own: readonly string[] = namesOf[fn];
  for (const name of names) {
    const array = (into as Record<string, unknown>)[name];
    if (!own.includes(name)) {
      if (array !== undefined) throw wrong(`.${name} is ${show(array)}, and no answer of this function`);
      continue;
    }
    if (!(array instanceof types[name])) throw wrong(`.${name} is ${show(array)}, not a ${types[name].name}`);
    if (buffers.includes(array.buffer)) throw wrong(`.${name} shares its memory with another of its arrays`);
    buffers.push(array.buffer);
    arrays[name] = array;
  }
  try {
    // Told now whether it is frozen, not when half of it is written.
    Object.assign(into, into);
  } catch (cause) {
    throw wrong(` cannot be written to (${String(cause)})`, cause);
  }
  return arrays;
}

/** Hands an answer over: in an earlier one, if there is one. */
export const handOver = <Answer extends object>(answer: Answer, into: Answer | undefined): Answer =>
  into ? Object.assign(into, answer) : answer;
