// What runs in a worker.
import { serve } from './serve.js';
import { listen } from './thread-of.js';

listen(async (request, post) => {
  const { reply, move } = await serve(request);
  post(reply, move);
});
