import { answer } from '../worker/answer.js';
import type { Reply, Request } from '../worker/protocol.js';
import { excludedByName, findLandmarks, fitCage, init, makeCage, refineCage } from './sync.js';

const functions = {
  init: () => undefined,
  makeCage,
  fitCage,
  findLandmarks,
  refineCage,
  excludedByName,
} as Record<string, (...args: unknown[]) => unknown>;

/** Milliseconds between two messages about progress: smooth for people. */
const kPause = 40;

/**
 * Carries out a call. Its last argument are the options, to which `onProgress` is added.
 * @returns the reply, and the buffers in it that are to be moved, not copied.
 */
export function serve(request: Request, post: (reply: Reply) => void): Promise<{ reply: Reply; move: ArrayBuffer[] }> {
  let last = -Infinity;
  let lastStage = '';
  const onProgress = (share: number, stage: string) => {
    const now = performance.now();
    if (now - last < kPause && stage === lastStage && share < 1) return;
    [last, lastStage] = [now, stage];
    post({ id: request.id, progress: [share, stage] });
  };
  return answer(request, async (fn, args) => {
    await init();
    const options = args.at(-1);
    return functions[fn]!(
      ...args.slice(0, -1),
      typeof options === 'object' && options !== null ? { ...options, onProgress } : options,
    );
  });
}
