import { show } from './error.js';

// Typed arrays as they are, whatever their owner has done to them: a proxy, a changed prototype or a property `length` would
// otherwise say something else when they are checked than when they are read.

const typedArray = Object.getPrototypeOf(Uint8Array.prototype) as object;
const getter = <Value>(name: PropertyKey) =>
  Object.getOwnPropertyDescriptor(typedArray, name)!.get as (this: unknown) => Value;
const kindOf = getter<string | undefined>(Symbol.toStringTag);
const bufferOf = getter<ArrayBuffer>('buffer');
const offsetOf = getter<number>('byteOffset');
const lengthOf = getter<number>('length');

const constructors = { Float32Array, Uint32Array, Uint16Array, Uint8Array, Uint8ClampedArray, Int8Array };
type Constructors = typeof constructors;

/** The name of a type of arrays that Cagecast takes. */
export type ArrayKind = keyof Constructors;

/** An array of a kind. */
type ArrayOf<Kind extends ArrayKind> = InstanceType<Constructors[Kind]>;

/**
 * A plain view of the memory of a typed array, of any realm. One in shared memory is copied, as another thread could change it after
 * it was checked.
 * @returns `undefined` if the value is not an array of one of these kinds itself, but another value or a proxy.
 */
export function plainArray<Kind extends ArrayKind>(value: unknown, ...kinds: Kind[]): ArrayOf<Kind> | undefined {
  const kind = kinds.find((name) => name === kindOf.call(value)); // `undefined` for a proxy
  if (kind === undefined) return undefined;
  const length = lengthOf.call(value);
  const type = constructors[kind] as unknown as new (...args: unknown[]) => ArrayOf<Kind>;
  if (length === 0) return new type(0); // its memory may have been taken away
  const buffer = bufferOf.call(value);
  const view = new type(buffer, offsetOf.call(value), length);
  return typeof SharedArrayBuffer === 'function' && (buffer as unknown) instanceof SharedArrayBuffer
    ? new type(view)
    : view;
}

/** Describes a value that is not an array of one of these kinds. */
export function showArray(value: unknown, ...kinds: ArrayKind[]): string {
  const looksRight = kinds.some((kind) => value instanceof constructors[kind]);
  return looksRight ? 'a proxy or imitation' : show(value);
}

const setArray = Uint8Array.prototype.set;

/** Writes values into a typed array; whoever owns it may have replaced its own `set`. */
export function overwrite(array: ArrayBufferView, values: ArrayLike<number>): void {
  setArray.call(array as Uint8Array, values);
}

/** The number of elements of a typed array. */
export const realLength = (array: ArrayBufferView): number => lengthOf.call(array);

/** The memory of a typed array. */
export const realBuffer = (array: ArrayBufferView): ArrayBufferLike => bufferOf.call(array);
