import {
  CagecastError,
  classify,
  cutBorders,
  init,
  presetOptions,
  project,
  splitVertices,
  transfer,
} from '../index.js';
import type { Reply, Request } from './protocol.js';

const functions = {
  init: () => undefined,
  transfer,
  project,
  classify,
  splitVertices,
  cutBorders,
  presetOptions,
} as Record<Request['fn'], (...args: unknown[]) => unknown>;

/** Carries out a call. @returns the reply, and the buffers in it that are to be moved, not copied. */
export async function serve({ id, fn, args }: Request): Promise<{ reply: Reply; move: ArrayBuffer[] }> {
  try {
    await init();
    const result = functions[fn](...args);
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
