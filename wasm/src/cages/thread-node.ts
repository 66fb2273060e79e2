// What runs in a worker thread of Node.
import { parentPort } from 'node:worker_threads';
import type { Request } from '../worker/protocol.js';
import { serve } from './serve.js';

parentPort?.on('message', async (request: Request) => {
  const { reply, move } = await serve(request, (progress) => parentPort?.postMessage(progress));
  parentPort?.postMessage(reply, move);
});
