import { CagecastError } from '../index.js';
import type { Reply, Request } from './protocol.js';

/** Carries out a call. @returns the reply, and the buffers in it that are to be moved, not copied. */
export async function answer(
  { id, fn, args }: Request,
  call: (fn: string, args: unknown[]) => unknown,
): Promise<{ reply: Reply; move: ArrayBuffer[] }> {
  try {
    const result = await call(fn, args);
    const arrays = Object.values(result ?? {}).filter((value): value is ArrayBufferView<ArrayBuffer> =>
      ArrayBuffer.isView(value),
    );
    return { reply: { id, result }, move: arrays.map((array) => array.buffer) };
  } catch (error) {
    const { code, message, at } =
      error instanceof CagecastError ? error : { code: 'internal' as const, message: String(error), at: 0 };
    return { reply: { id, error: { code, message, at } }, move: [] };
  }
}
