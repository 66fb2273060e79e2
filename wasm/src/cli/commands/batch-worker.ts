import { parentPort } from 'node:worker_threads';
import type { Verdict } from '../../inspect/index.js';
import { Io } from '../io/io.js';
import { makeFolder } from '../io/output.js';
import { messageOf } from '../model/failures.js';
import type { TransferCommand } from '../model/sources.js';
import { cachedReading } from '../transfer/models.js';
import type { Report } from '../transfer/report.js';
import { transferToFile } from '../transfer/transfer-to-file.js';

/** What a worker found. */
export type Outcome =
  | {
      status: 'done';
      ms: number;
      counts: Report['counts'];
      triangles: Report['triangles'];
      note?: string;
      isTurned?: boolean;
      otherUvSets?: readonly number[];
      template?: string;
      verdict?: Verdict;
      findings?: string[];
    }
  | { status: 'failed'; ms: number; error: string };

/** Runs the jobs that the thread is sent, until it is ended. A cage of many jobs is read once. */
export function serveBatch(): void {
  const io = new Io({ stdout: () => {}, stderr: () => {} });
  const readCage = cachedReading();
  parentPort!.on('message', async (command: TransferCommand) => {
    const began = performance.now();
    const answer = (outcome: object) =>
      parentPort!.postMessage({ ms: Math.round(performance.now() - began), ...outcome });
    try {
      for (const path of [command.output, command.report]) if (path !== undefined) makeFolder(path);
      const { report } = await transferToFile(command, io, readCage);
      const { cage, counts, triangles, note, verdict, findings } = report;
      const inspected = verdict && { verdict, findings: findings!.map(({ code }) => code) };
      const told = {
        ...(note && { note }),
        ...(cage.isTurned && { isTurned: true }),
        ...(cage.otherUvSets && { otherUvSets: cage.otherUvSets }),
        ...(cage.template && { template: cage.template }),
      };
      answer({ status: 'done', counts, triangles, ...told, ...inspected });
    } catch (error) {
      answer({ status: 'failed', error: messageOf(error) });
    }
  });
}
