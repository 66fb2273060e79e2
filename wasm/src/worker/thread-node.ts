// What runs in a worker thread of Node.
import { parentPort } from 'node:worker_threads';
import type { Request } from './protocol.js';
import { serve } from './serve.js';

parentPort?.on('message', async (request: Request) => {
  const { reply, move } = await serve(request);
  parentPort?.postMessage(reply, move);
});
