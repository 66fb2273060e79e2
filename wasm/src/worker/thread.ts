// What runs in a worker of a browser.
import type { Request } from './protocol.js';
import { serve } from './serve.js';

addEventListener('message', async ({ data }: MessageEvent<Request>) => {
  const { reply, move } = await serve(data);
  postMessage(reply, { transfer: move });
});
