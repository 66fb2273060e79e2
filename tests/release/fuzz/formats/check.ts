// What holds of any file that somebody takes for a model: it is read, or refused by an error for people; and nothing else changes.
import assert from 'node:assert/strict';
import { CagecastError } from 'cagecast';
import { checkGltf, checkImage, fileKind, toGlb } from 'cagecast/gltf';
import { validate } from '../../../support/gltf.js';

/** A model and the files beside it, by their names; the model is the first. */
export type Files = Record<string, Uint8Array>;

const kObjects = [
  Object,
  Array,
  Function,
  String,
  Number,
  Boolean,
  Symbol,
  BigInt,
  Map,
  Set,
  WeakMap,
  WeakSet,
  Promise,
  RegExp,
  Date,
  Error,
  ArrayBuffer,
  DataView,
  Uint8Array,
  Uint16Array,
  Uint32Array,
  Int32Array,
  Float32Array,
  Float64Array,
].flatMap((one) => [one, one.prototype]);
const kWatched: object[] = [
  globalThis,
  Math,
  JSON,
  Reflect,
  Object.getPrototypeOf(Uint8Array.prototype),
  console,
  ...kObjects,
];
/** All that every other program in the process can see: the properties of each object. */
const visible = () =>
  kWatched.map((one) => {
    const all: Record<PropertyKey, PropertyDescriptor> = Object.getOwnPropertyDescriptors(one);
    return new Map(Reflect.ownKeys(all).map((key) => [key, all[key]!.value ?? all[key]!.get] as const));
  });

/** The names of properties that are not as before. */
function changed(before: ReturnType<typeof visible>): string[] {
  return visible().flatMap((now, i) => {
    const then = before[i]!;
    const keys = now.size === then.size ? [...now.keys()] : [...now.keys(), ...then.keys()];
    return keys.filter((key) => !Object.is(now.get(key), then.get(key)) || !then.has(key)).map(String);
  });
}
// Some globals are made when they are first asked for, and one by the validator.
for (const key of Reflect.ownKeys(globalThis)) void Reflect.get(globalThis, key);
await validate(new Uint8Array(20)).catch(() => {});

/** Whether a call ends as calls may: with an answer, or with one line of `CagecastError`. */
async function answerOf<T>(call: () => T | Promise<T>): Promise<T | undefined> {
  try {
    return await call();
  } catch (error) {
    assert.ok(error instanceof CagecastError, `not a CagecastError: ${(error as Error)?.stack ?? String(error)}`);
    assert.equal(error.code, 'badArgument', error.message);
    assert.match(error.message, /^[^\n]{10,1000}$/);
    return undefined;
  }
}

/** That a file has changed what others in the process see. */
export class Mark extends Error {}

/** Calls what may not fail. */
function mustHold(what: string, call: () => void): void {
  try {
    call();
  } catch (error) {
    assert.fail(`${what}: ${(error as Error).message}`);
  }
}

/**
 * Reads a file by all doors of a file.
 * @returns whether it is a model, or an image, that can be read.
 * @throws what does not hold.
 */
export async function check(files: Files): Promise<boolean> {
  const before = visible();
  const [bytes] = Object.values(files) as [Uint8Array];
  const kind = fileKind(bytes);
  await answerOf(() => checkImage(bytes));
  const isGltf = await answerOf(() => {
    checkGltf(bytes);
    return true;
  });
  const glb = await answerOf(() => toGlb(bytes, { read: async (name) => files[name] }));
  const names = changed(before);
  if (names.length > 0) throw new Mark(`it changes what others in the process see: ${names.join(', ')}`);
  if (glb) {
    mustHold('what it makes is refused', () => checkGltf(glb));
    const [worst] = await validate(glb);
    assert.ok(worst === undefined, `it makes a GLB that is not valid: ${worst}`);
  }
  return isGltf === true || glb !== undefined || kind?.name === 'an image';
}
