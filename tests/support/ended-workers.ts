import { Worker } from 'node:worker_threads';

/** Counts the workers that are ended while something runs. @param work  Is given what tells their number so far. */
export async function countingEnds(work: (ended: () => number) => Promise<void>): Promise<void> {
  const { terminate } = Worker.prototype;
  let ended = 0;
  Worker.prototype.terminate = function () {
    ended++;
    return terminate.call(this);
  };
  try {
    await work(() => ended);
  } finally {
    Worker.prototype.terminate = terminate;
  }
}
