// The functions of worker/index.ts on the thread that calls them, for hosts without workers.
import type * as offThread from './index.js';
import { WorkerQueue } from './queue.js';
import { serve } from './serve.js';

const queue = new WorkerQueue((onReply) => ({
  post: (request) => void serve(request).then(({ reply }) => onReply(reply)),
  terminate: () => undefined,
  setBusy: () => undefined,
}));

export const transfer: typeof offThread.transfer = (cage, target, options = {}) =>
  queue.withOptions('transfer', [cage, target], options);

export const inspect: typeof offThread.inspect = (cage, target, options = {}) =>
  queue.withOptions('inspect', [cage, target], options);

export const prepareParts: typeof offThread.prepareParts = (cage, target, options = {}) =>
  queue.withOptions('prepareParts', [cage, target], options);
