import { classify, cutBorders, init, project, splitVertices, transfer } from '../api/index.js';
import { inspect } from '../inspect/index.js';
import { prepareParts } from '../parts/prepare.js';
import { answer } from './answer.js';
import type { Reply, Request } from './protocol.js';

const functions = {
  init: () => undefined,
  transfer,
  project,
  classify,
  splitVertices,
  cutBorders,
  prepareParts,
  inspect,
} as Record<string, (...args: unknown[]) => unknown>;

/** Carries out a call. @returns the reply, and the buffers in it that are to be moved, not copied. */
export function serve(request: Request): Promise<{ reply: Reply; move: ArrayBuffer[] }> {
  return answer(request, async (fn, args) => {
    await init();
    return functions[fn]!(...args);
  });
}
