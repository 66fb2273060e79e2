import type { Spawn } from './protocol.js';
import { threadOf, threadOfNode } from './thread-of.js';

/** Starts a worker. */
export const spawn: Spawn = (onReply, onFailure) => {
  const url = import.meta.url.replace(/[^/]*$/, 'worker-thread.js');
  if (typeof Worker !== 'function') return threadOfNode(url, onReply, onFailure);
  // Bundlers find the worker's script only in this form.
  const start = () => new Worker(new URL('./worker-thread.js', import.meta.url), { type: 'module' });
  return threadOf(start, url, onReply, onFailure);
};
