import type { Spawn } from '../worker/protocol.js';
import { threadOf, threadOfNode } from '../worker/thread-of.js';

/** Starts a worker. */
export const spawn: Spawn = (onReply, onFailure) => {
  const url = import.meta.url.replace(/[^/]*$/, 'cages-thread.js');
  if (typeof Worker !== 'function') {
    const thread = threadOfNode(url, onReply, onFailure);
    if (!thread)
      throw new Error('it has no workers, nor process.getBuiltinModule, as Node 20.16 has; use cagecast/cages/sync');
    return thread;
  }
  // Bundlers find the worker's script only in this form.
  const start = () => new Worker(new URL('./cages-thread.js', import.meta.url), { type: 'module' });
  return threadOf(start, url, onReply, onFailure);
};
