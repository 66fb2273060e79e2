import type { CallOptions } from '../../worker/index.js';

/** Options of a call that does not block. */
export interface Calling extends Pick<CallOptions, 'signal'> {
  /** How far the call is: a share 0..1 that never falls, and the step. An error in it rejects the call. */
  onProgress?: ((share: number, stage: string) => void) | undefined;
}

/** Milliseconds of a task: a frame has 16, of which the page needs some. */
const kTask = 8;

/** Ends the task. Timers would wait at least 4 ms. */
export function nextTask(): Promise<void> {
  const { port1, port2 } = new MessageChannel();
  return new Promise((resolve) => {
    port1.onmessage = () => {
      port1.close();
      resolve();
    };
    port2.postMessage(undefined);
  });
}

/** Runs a generator to its end, in short tasks. @throws the reason of the signal, between two tasks. */
export async function runInTasks<T>(steps: Generator<unknown, T>, signal: AbortSignal | undefined): Promise<T> {
  for (;;) {
    await nextTask();
    signal?.throwIfAborted();
    for (const began = performance.now(); performance.now() - began < kTask; ) {
      const step = steps.next();
      if (step.done) return step.value;
    }
  }
}
