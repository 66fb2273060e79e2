import { reasonOf } from '../state/wording';

/** What a worker that is asked once answers, or an error message. */
export type Reply<Answer> = Answer | { message: string };

/** A request, and the name of the lock that the worker holds while it lives. */
interface Asked<Request> {
  request: Request;
  lock: string;
}

const kLook = 1000; // milliseconds from look to look whether a worker lives

/**
 * Asks a worker that was started for it, and ends it: the page must not stop for what takes long.
 * @param signal Ends it before it answers.
 * @throws Error with the message of the worker, or one that says it could not be started, or was ended by the browser.
 */
export async function askWorker<Answer extends object>(
  worker: Worker,
  request: unknown,
  transfer: Transferable[] = [],
  signal?: AbortSignal,
): Promise<Answer> {
  let watching: ReturnType<typeof setInterval> | undefined;
  try {
    const reply = await new Promise<Reply<Answer>>((resolve, reject) => {
      signal?.throwIfAborted();
      signal?.addEventListener('abort', () => reject(signal.reason));
      const lock = `cagecast worker ${Math.random()}`;
      worker.onmessage = ({ data }: MessageEvent<Reply<Answer>>) => resolve(data);
      worker.onmessageerror = () => reject(new Error('there is not enough memory for what a worker has made'));
      worker.onerror = ({ message }) =>
        reject(new Error(`a worker could not be started${message ? `: ${message}` : ''}`));
      worker.postMessage({ request, lock } satisfies Asked<unknown>, transfer);
      watching = watch(lock, () => reject(new Error('the browser has ended a worker, likely for lack of memory')));
    });
    if ('message' in reply) throw new Error(reply.message);
    return reply;
  } finally {
    clearInterval(watching);
    worker.terminate();
  }
}

/** Watches a lock: browsers do not tell of workers that they end. @param ended Called when it was held, and is not any more. */
function watch(lock: string, ended: () => void): ReturnType<typeof setInterval> {
  let wasHeld = false;
  let misses = 0;
  return setInterval(async () => {
    const { held = [] } = (await navigator.locks?.query()) ?? {};
    const isHeld = held.some(({ name }) => name === lock);
    wasHeld ||= isHeld;
    // Its answer may be on the way.
    misses = wasHeld && !isHeld ? misses + 1 : 0;
    if (misses > 1) ended();
  }, kLook);
}

/** In such a worker: answers requests by a function. @param transferOf What of an answer is handed over instead of copied. */
export function answerBy<Request, Answer extends object>(
  answer: (request: Request) => Promise<Answer>,
  transferOf: (answer: Answer) => Transferable[] = () => [],
): void {
  addEventListener('message', async ({ data: { request, lock } }: MessageEvent<Asked<Request>>) => {
    void navigator.locks?.request(lock, () => new Promise(() => {})); // until it ends
    try {
      const answered = await answer(request);
      postMessage(answered, { transfer: transferOf(answered) });
    } catch (error) {
      postMessage({ message: reasonOf(error) });
    }
  });
}
