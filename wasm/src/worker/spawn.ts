import type { Spawn, Thread } from './protocol.js';
import { serve } from './serve.js';
import { threadOf, threadOfNode } from './thread-of.js';

/** Starts a worker. */
export const spawn: Spawn = (onReply, onFailure) => {
  const url = import.meta.url.replace(/[^/]*$/, 'worker-thread.js');
  if (typeof Worker !== 'function') return threadOfNode(url, onReply, onFailure) ?? threadHere(onReply);
  // Bundlers find the worker's script only in this form.
  const start = () => new Worker(new URL('./worker-thread.js', import.meta.url), { type: 'module' });
  return threadOf(start, url, onReply, onFailure);
};

/** For hosts without workers, such as edge functions: each call is carried out on the thread that makes it, after what runs now. */
function threadHere(onReply: Parameters<Spawn>[0]): Thread {
  let isEnded = false;
  return {
    post(request, move) {
      void serve(structuredClone(request, { transfer: move })).then(({ reply }) => isEnded || onReply(reply));
    },
    terminate: () => void (isEnded = true),
    setBusy: () => undefined,
  };
}
