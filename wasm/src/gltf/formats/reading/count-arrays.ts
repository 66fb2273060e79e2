import { exceeds } from '../../checks/read-limits.js';
import type { FormatLimits } from '../limits.js';

/** Bytes that an element of a list takes, and an object in one, at least. */
const [kElement, kObject] = [8, 56];

const typed = [
  'Int8Array',
  'Uint8Array',
  'Uint8ClampedArray',
  'Int16Array',
  'Uint16Array',
  'Int32Array',
  'Uint32Array',
  'Float32Array',
  'Float64Array',
  'BigInt64Array',
  'BigUint64Array',
] as const;

/**
 * Counts the memory of this thread, for one file, from now on: `new Float32Array(n)` and the like before they take it, and `push`.
 * No host can limit typed arrays, and few can limit anything else.
 * @returns a check: it throws once the limit `memory` was exceeded, even if a loader caught the error then.
 */
export function countArrays(limits: Pick<FormatLimits, 'memory'>): () => void {
  let bytes = 0;
  const check = () => {
    if (bytes > limits.memory)
      throw exceeds(
        `takes more than ${Math.round(limits.memory).toLocaleString('en')} bytes of memory`,
        'memory',
        limits,
      );
  };
  const count = (more: number) => {
    if (more > 0) bytes += more;
    check();
  };
  for (const name of [...typed, 'ArrayBuffer', 'Array'] as const) countConstructor(name, count);
  const { push } = Array.prototype;
  Object.defineProperty(Array.prototype, 'push', {
    value(this: unknown[], ...items: unknown[]) {
      const isObject = typeof items[0] === 'object';
      count(items.length * (isObject ? kObject : kElement));
      return push.apply(this, items);
    },
  });
  return check;
}

function countConstructor(
  name: (typeof typed)[number] | 'ArrayBuffer' | 'Array',
  count: (bytes: number) => void,
): void {
  const scope = globalThis as unknown as Record<string, typeof Float32Array>;
  const made = scope[name]!;
  const size = made.BYTES_PER_ELEMENT ?? (name === 'Array' ? kElement : 1);
  const counted: typeof made = new Proxy(made, {
    construct(target, args, own) {
      const [first] = args as [number | ArrayLike<number> | undefined];
      if (typeof first === 'number') count(first * size);
      // Of a buffer it is a view.
      else if (typeof first === 'object' && first !== null && !('byteLength' in first && !ArrayBuffer.isView(first)))
        count((first.length ?? 0) * size);
      // Made by the constructor itself, which is several times as fast to use.
      return Reflect.construct(target, args, own === counted ? target : own);
    },
  });
  scope[name] = counted;
}
