// What runs in a worker.
import { listen } from '../worker/thread-of.js';
import { serve } from './serve-cages.js';

listen(async (request, post) => {
  const { reply, move } = await serve(request, post);
  post(reply, move);
});
