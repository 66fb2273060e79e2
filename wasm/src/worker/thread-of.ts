import type { WorkerOptions } from 'node:worker_threads';
import { nodeModule } from '../core/node.js';
import type { Reply, Request, Thread } from './protocol.js';

type OnFailure = (message: string) => void;

/**
 * Whether this host starts workers from files beside a script: browsers, Node, Deno and Bun do. Edge functions do not, although some have
 * the names of Node, nor does a script without an address.
 */
export const hasWorkers = (): boolean =>
  import.meta.url !== undefined &&
  globalThis.navigator?.userAgent !== 'Cloudflare-Workers' &&
  (typeof Worker === 'function' || nodeModule('node:worker_threads') !== undefined);

/** A worker of a browser, Deno or Bun as a thread. @param url  Of a file in the folder where the script should be. */
export function threadOf<Message = Request, Answer = Reply>(
  start: () => Worker,
  url: string,
  onReply: (reply: Answer) => void,
  onFailure: OnFailure,
): Thread<Message> {
  const worker = startFromAnywhere(start, url);
  worker.onmessage = ({ data }: MessageEvent<Answer>) => onReply(data);
  worker.onerror = (event) => {
    event.preventDefault();
    onFailure(event.message ?? `its script could not be loaded; without a bundler that finds it, it is ${url}`);
  };
  return {
    post: (message, move) => worker.postMessage(message, move),
    terminate: () => worker.terminate(),
    setBusy: () => undefined,
  };
}

/** Starts a worker. Browsers start none from another origin, such as a CDN in an import map: there, a script of the page's own imports it. */
function startFromAnywhere(start: () => Worker, url: string): Worker {
  try {
    return start();
  } catch (error) {
    const isElsewhere = /^https?:/.test(url) && new URL(url).origin !== globalThis.location?.origin;
    if (!isElsewhere) throw error;
    const script = URL.createObjectURL(new Blob([`import ${JSON.stringify(url)};`], { type: 'text/javascript' }));
    return new Worker(script, { type: 'module' });
  }
}

/** Starts a worker thread in Node. @param options  Of Node. @throws Error if this is another host. */
export function threadOfNode<Message = Request, Answer = Reply>(
  url: string,
  onReply: (reply: Answer) => void,
  onFailure: OnFailure,
  // Do not inherit the flags of this process: some, such as --input-type, are invalid for a file, and none is needed.
  options: WorkerOptions = { execArgv: [] },
): Thread<Message> {
  const threads = nodeModule('node:worker_threads');
  if (!threads)
    throw new Error(
      'it has no workers, nor process.getBuiltinModule, as Node 20.16 has; cagecast, and cagecast/cages with worker: false, need none',
    );
  const worker = new threads.Worker(new URL(url), options);
  worker.on('message', onReply);
  worker.on('error', (error) => onFailure(error.message));
  worker.unref();
  return {
    post: (message, move) => worker.postMessage(message, move),
    terminate: () => void worker.terminate(),
    setBusy: (busy) => (busy ? worker.ref() : worker.unref()),
  };
}

type Post<Answer> = (message: Answer, move?: ArrayBuffer[]) => void;

/** In a worker: listens to messages. @param serve  Answers one by means of `post`. */
export function listen<Message = Request, Answer = Reply>(
  serve: (message: Message, post: Post<Answer>) => Promise<void>,
): void {
  const port = typeof postMessage === 'function' ? undefined : nodeModule('node:worker_threads')?.parentPort;
  if (port)
    port.on('message', (message: Message) => void serve(message, (reply, move) => port.postMessage(reply, move)));
  else
    addEventListener(
      'message',
      ({ data }: MessageEvent<Message>) =>
        void serve(data, (reply, move = []) => postMessage(reply, { transfer: move })),
    );
}
