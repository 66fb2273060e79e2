import { Worker } from 'node:worker_threads';
import type { Spawn } from './protocol.js';

/** Starts a worker thread in Node. */
export const spawn: Spawn = (onReply, onFailure) => {
  // Do not inherit the flags of this process: some, such as --input-type, are invalid for a file, and none is needed.
  const worker = new Worker(new URL('./worker-thread-node.js', import.meta.url), { execArgv: [] });
  worker.on('message', onReply);
  worker.on('error', (error) => onFailure(error.message));
  worker.unref();
  return {
    post: (request, move) => worker.postMessage(request, move),
    terminate: () => void worker.terminate(),
    setBusy: (busy) => (busy ? worker.ref() : worker.unref()),
  };
};
