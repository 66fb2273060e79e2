import { CagecastError } from '../index.js';
import type { Reply, Request } from './protocol.js';

/** Carries out a call. @returns the reply, and the buffers in it that are to be moved, not copied. */
export async function answer(
  { id, fn, args }: Request,
  call: (fn: string, args: unknown[]) => unknown,
): Promise<{ reply: Reply; move: ArrayBuffer[] }> {
  try {
    const result = await call(fn, args);
    return { reply: { id, result }, move: [...new Set(buffersIn(result))] };
  } catch (error) {
    const { code, message, at } =
      error instanceof CagecastError ? error : { code: 'internal' as const, message: String(error), at: 0 };
    return { reply: { id, error: { code, message, at } }, move: [] };
  }
}

/** The buffers of all arrays in plain data. */
function buffersIn(data: unknown): ArrayBuffer[] {
  if (ArrayBuffer.isView(data)) return [data.buffer as ArrayBuffer];
  return typeof data === 'object' && data !== null ? Object.values(data).flatMap(buffersIn) : [];
}
