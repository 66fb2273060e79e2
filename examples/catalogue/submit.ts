// npm run submit -- MANIFEST.jsonl [--wait]

import { setTimeout } from 'node:timers/promises';
import { parseArgs } from 'node:util';
import { command } from './command.ts';
import { Failure, reasonOf } from './failure.ts';
import { type Catalogue, type CatalogueJob, type JobData, keyOf } from './jobs.ts';
import { readManifest } from './manifest.ts';
import { doneBefore } from './results.ts';
import { fromCaller } from './settings.ts';

/** How many jobs go to Redis at once. */
const chunk = 500;

/** What became of a manifest's lines. */
export interface Submission {
  new: number;
  /** Done, failed or waiting: nothing happens. */
  known: number;
  /** Failed for a reason that may pass, and tried again now. */
  again: number;
  errors: string[];
  /** Of all jobs in the manifest. */
  keys: Set<string>;
}

/** Turns a manifest into jobs. Those that somebody asked for before are not done again. */
export async function submit(path: string, { queue, redis }: Catalogue): Promise<Submission> {
  const seen = new Set<string>();
  const summary: Submission = { new: 0, known: 0, again: 0, errors: [], keys: seen };
  const [before, failed] = [await doneBefore(), await failedThatMayPass(queue)];
  let waiting: { name: string; data: JobData; opts: { jobId: string } }[] = [];
  const send = async () => {
    const known = await Promise.all(waiting.map(({ opts }) => redis.exists(queue.toKey(opts.jobId))));
    const unknown = waiting.filter((_, i) => !known[i]);
    await queue.addBulk(unknown); // ignores a key that somebody else added meanwhile
    summary.new += unknown.length;
    summary.known += waiting.length - unknown.length;
    waiting = [];
  };
  for await (const entry of readManifest(path)) {
    if ('error' in entry) {
      summary.errors.push(`line ${entry.line}: ${entry.error}`);
      continue;
    }
    const key = keyOf(entry.data);
    const failure = failed.get(key);
    if (before.has(key) || seen.has(key)) ++summary.known;
    else if (failure) {
      await failure.updateData(entry.data); // URLs that are signed anew
      await failure.retry('failed', { resetAttemptsMade: true });
      ++summary.again;
    } else waiting.push({ name: entry.data.kind, data: entry.data, opts: { jobId: key } });
    seen.add(key);
    if (waiting.length === chunk) await send();
  }
  await send();
  return summary;
}

async function failedThatMayPass(queue: Catalogue['queue']): Promise<Map<string, CatalogueJob>> {
  const failed = new Map<string, CatalogueJob>();
  for (const job of await queue.getFailed(0, -1)) {
    const reason = reasonOf(job.failedReason);
    // A signature that has expired looks like an input that is missing.
    if (reason === 'missing' || new Failure(reason, '').mayPass) if (reason !== 'crash') failed.set(job.id!, job);
  }
  return failed;
}

/** Waits until no job is left. */
export async function untilDone({ queue }: Catalogue, tell: (text: string) => void = () => {}): Promise<void> {
  for (;;) {
    const { completed = 0, failed = 0, ...counts } = await queue.getJobCounts();
    const left = Object.values(counts).reduce((sum, n) => sum + n, 0);
    tell(`${left} left, ${completed} done, ${failed} failed`);
    if (left === 0) return;
    await setTimeout(500);
  }
}

/** How many jobs of a manifest have failed, tonight or earlier. */
export async function failedOf({ queue }: Catalogue, { keys }: Submission): Promise<number> {
  const failed = await queue.getRanges(['failed']);
  return failed.filter((key) => keys.has(key)).length;
}

/** Shows progress where somebody looks. */
export const onTerminal = (text: string): void => {
  if (process.stderr.isTTY) process.stderr.write(`\r${text}   `);
};

export const describe = ({ new: fresh, known, again, errors }: Submission): string =>
  `${fresh} new jobs, ${known} known${again > 0 ? `, ${again} tried again` : ''}${errors.length > 0 ? `, ${errors.length} lines that cannot be used` : ''}`;

if (import.meta.filename === process.argv[1]) {
  const { positionals, values } = parseArgs({ allowPositionals: true, options: { wait: { type: 'boolean' } } });
  if (positionals.length !== 1) throw new Error('usage: npm run submit -- MANIFEST.jsonl [--wait]');
  await command(async (catalogue) => {
    const summary = await submit(fromCaller(positionals[0]!), catalogue);
    for (const error of summary.errors) console.error(error);
    console.log(describe(summary));
    if (!values.wait) return summary.errors.length > 0 ? 1 : 0;
    await untilDone(catalogue, onTerminal);
    const failed = await failedOf(catalogue, summary);
    console.log(`${summary.keys.size - failed} done, ${failed} failed`);
    return failed + summary.errors.length > 0 ? 1 : 0;
  });
}
