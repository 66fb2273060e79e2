import type { Spawn } from './protocol.js';
import { threadOf } from './thread-of.js';

/** Starts a worker in a browser. */
export const spawn: Spawn = (onReply, onFailure) =>
  // Bundlers find the worker's script only in this form.
  threadOf(new Worker(new URL('./worker-thread.js', import.meta.url), { type: 'module' }), onReply, onFailure);
