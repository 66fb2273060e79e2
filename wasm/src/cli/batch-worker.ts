import { mkdirSync } from 'node:fs';
import { dirname } from 'node:path';
import { parentPort } from 'node:worker_threads';
import type { Verdict } from '../inspect/index.js';
import { Progress } from './progress.js';
import { cachedReading } from './run.js';
import { type TransferCommand, transferCommand } from './transfer/command.js';
import type { Report } from './transfer/report.js';
import { messageOf } from './usage.js';

/** What a worker found. */
export type Outcome =
  | {
      status: 'done';
      ms: number;
      counts: Report['counts'];
      triangles: Report['triangles'];
      verdict?: Verdict;
      findings?: string[];
    }
  | { status: 'failed'; ms: number; error: string };

/** Runs the jobs that the thread is sent, until it is ended. A cage of many jobs is read once. */
export function serveBatch(): void {
  const port = parentPort!;
  const progress = new Progress();
  progress.silence();
  const readCage = cachedReading();
  port.on('message', async (command: TransferCommand) => {
    const began = performance.now();
    const ms = () => Math.round(performance.now() - began);
    try {
      makeFolders(command);
      const { report } = await transferCommand(command, progress, readCage);
      const { counts, triangles, verdict, findings } = report;
      port.postMessage({
        status: 'done',
        ms: ms(),
        counts,
        triangles,
        ...(verdict && { verdict, findings: findings!.map(({ code }) => code) }),
      } satisfies Outcome);
    } catch (error) {
      port.postMessage({ status: 'failed', ms: ms(), error: messageOf(error) } satisfies Outcome);
    }
  });
}

/** Makes the folders that a job writes to: with `{name}` and `{dir}` in paths there may be many. */
function makeFolders({ output, report }: TransferCommand): void {
  for (const path of [output, report]) {
    try {
      if (path !== undefined) mkdirSync(dirname(path), { recursive: true });
    } catch {
      // What writes the file says what is wrong.
    }
  }
}
