import type { Spawn } from './protocol.js';
import { threadOf } from './thread-of-node.js';

/** Starts a worker thread in Node. */
export const spawn: Spawn = (onReply, onFailure) =>
  threadOf(new URL('./worker-thread-node.js', import.meta.url), onReply, onFailure);
