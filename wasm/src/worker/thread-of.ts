import type { Reply, Thread } from './protocol.js';

/** A worker of a browser as a thread. */
export function threadOf(
  worker: Worker,
  onReply: (reply: Reply) => void,
  onFailure: (message: string) => void,
): Thread {
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
}
