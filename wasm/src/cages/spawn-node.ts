import type { Spawn } from '../worker/protocol.js';
import { threadOf } from '../worker/thread-of-node.js';

/** Starts a worker thread in Node. */
export const spawn: Spawn = (onReply, onFailure) =>
  threadOf(new URL('./cages-thread-node.js', import.meta.url), onReply, onFailure);
