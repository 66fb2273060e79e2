import { CagecastError } from '../core/error.js';
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
    const known = error instanceof CagecastError ? error : new CagecastError('internal', fn, String(error));
    const { code, reason, argument, at } = known;
    return { reply: { id, error: [code, known.fn, reason, { argument, at }] }, move: [] };
  }
}

/** The buffers of all arrays in plain data. */
function buffersIn(data: unknown): ArrayBuffer[] {
  if (ArrayBuffer.isView(data)) return [data.buffer as ArrayBuffer];
  return typeof data === 'object' && data !== null ? Object.values(data).flatMap(buffersIn) : [];
}
