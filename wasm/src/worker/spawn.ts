import type { Reply, Spawn } from './protocol.js';

/** Starts a worker in a browser. */
export const spawn: Spawn = (onReply, onFailure) => {
  // Bundlers find the worker's script only in this form.
  const worker = new Worker(new URL('./worker-thread.js', import.meta.url), { type: 'module' });
  worker.onmessage = ({ data }: MessageEvent<Reply>) => onReply(data);
  worker.onerror = (event) => {
    event.preventDefault();
    onFailure(event.message ?? 'its script could not be loaded');
  };
  return {
    post: (request, move) => worker.postMessage(request, move),
    terminate: () => worker.terminate(),
    setBusy: () => undefined,
  };
};
