import type { Spawn } from '../worker/protocol.js';
import { threadOf } from '../worker/thread-of.js';

/** Starts a worker in a browser. */
export const spawn: Spawn = (onReply, onFailure) =>
  // Bundlers find the worker's script only in this form.
  threadOf(new Worker(new URL('./cages-thread.js', import.meta.url), { type: 'module' }), onReply, onFailure);
