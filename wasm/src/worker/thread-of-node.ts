import { Worker } from 'node:worker_threads';
import type { Reply, Thread } from './protocol.js';

/** Starts a worker thread in Node. */
export function threadOf(script: URL, onReply: (reply: Reply) => void, onFailure: (message: string) => void): Thread {
  // Do not inherit the flags of this process: some, such as --input-type, are invalid for a file, and none is needed.
  const worker = new Worker(script, { execArgv: [] });
  worker.on('message', onReply);
  worker.on('error', (error) => onFailure(error.message));
  worker.unref();
  return {
    post: (request, move) => worker.postMessage(request, move),
    terminate: () => void worker.terminate(),
    setBusy: (busy) => (busy ? worker.ref() : worker.unref()),
  };
}
