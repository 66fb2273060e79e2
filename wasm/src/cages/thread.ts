// What runs in a worker of a browser.
import type { Request } from '../worker/protocol.js';
import { serve } from './serve.js';

addEventListener('message', async ({ data }: MessageEvent<Request>) => {
  const { reply, move } = await serve(data, (progress) => postMessage(progress));
  postMessage(reply, { transfer: move });
});
