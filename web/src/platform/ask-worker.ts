import { reasonOf } from '../state/wording';

/** What a worker that is asked once answers, or an error message. */
export type Reply<Answer> = Answer | { message: string };

/**
 * Asks a worker that was started for it, and ends it: the page must not stop for what takes long.
 * @throws Error with the message of the worker, or one that says it could not be started.
 */
export async function askWorker<Answer extends object>(
  worker: Worker,
  request: unknown,
  transfer: Transferable[] = [],
): Promise<Answer> {
  try {
    const reply = await new Promise<Reply<Answer>>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<Reply<Answer>>) => resolve(data);
      worker.onerror = ({ message }) =>
        reject(new Error(`a worker could not be started${message ? `: ${message}` : ''}`));
      worker.postMessage(request, transfer);
    });
    if ('message' in reply) throw new Error(reply.message);
    return reply;
  } finally {
    worker.terminate();
  }
}

/** In such a worker: answers requests by a function. @param transferOf What of an answer is handed over instead of copied. */
export function answerBy<Request, Answer extends object>(
  answer: (request: Request) => Promise<Answer>,
  transferOf: (answer: Answer) => Transferable[] = () => [],
): void {
  addEventListener('message', async ({ data }: MessageEvent<Request>) => {
    try {
      const answered = await answer(data);
      postMessage(answered, { transfer: transferOf(answered) });
    } catch (error) {
      postMessage({ message: reasonOf(error) });
    }
  });
}
