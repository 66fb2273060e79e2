// Checks the files that run.ts sends it, one after the other, and is ended where one takes more than its share.
import { Worker } from 'node:worker_threads';
import { check, type Files, Mark } from './check.js';

/** What a file of less than a megabyte may take: two seconds of its loader, and what starts and ends it. */
const kLimits = { milliseconds: 3000, megabytes: 500 };

export interface Answer {
  fault?: string;
  isRead: boolean;
  /** Whether it left its mark on the process, which reads no others then. */
  isMarked?: boolean;
  /** Of the processor. */
  milliseconds: number;
  megabytes: number;
}

// Readers say more than a pipe takes.
for (const name of ['log', 'warn', 'error'] as const) console[name] = () => {};

const began = new Float64Array(new SharedArrayBuffer(16));
new Worker(new URL('watchdog.mjs', import.meta.url), { workerData: { began: began.buffer, limits: kLimits } });

const cpu = (): number => {
  const { user, system } = process.cpuUsage();
  return (user + system) / 1000;
};
const memory = (): number => process.memoryUsage.rss() / 2 ** 20;

process.on('message', async ({ files, isFree }: { files: Files; isFree?: boolean }) => {
  const [cpuBefore, memoryBefore] = [cpu(), memory()];
  // The first file of a process pays for what all load.
  if (!isFree) began.set([cpuBefore, memoryBefore]);
  const answer: Answer = { isRead: false, milliseconds: 0, megabytes: 0 };
  try {
    answer.isRead = await check(files);
  } catch (error) {
    answer.fault = (error as Error)?.message ?? String(error);
    answer.isMarked = error instanceof Mark;
  }
  began[0] = 0;
  answer.milliseconds = cpu() - cpuBefore;
  answer.megabytes = memory() - memoryBefore;
  process.send!(answer);
});
