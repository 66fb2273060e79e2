// npm run submit -- MANIFEST.jsonl [--wait]

import { setTimeout } from 'node:timers/promises';
import { parseArgs } from 'node:util';
import { command } from './command.ts';
import { Failure } from './failure.ts';
import { addressOf, type Catalogue, type CatalogueJob, keyOf, presentResult, resultOf, retry } from './jobs.ts';
import { readManifest } from './manifest.ts';
import { patiently } from './patience.ts';
import { doneBefore } from './results.ts';
import { fromCaller } from './settings.ts';
import { checkedJob, type JobData } from './shape.ts';
import { isThere } from './storage.ts';

/** How many jobs are looked up, and go to Redis, at once. */
const chunk = 500;
/** How many wrong jobs are told: a line of a manifest can stand for a million. */
const mostErrors = 1000;

/** What became of a manifest's lines. */
export interface Submission {
  new: number;
  /** Done, failed or waiting: nothing happens. */
  known: number;
  /** Failed for a reason that may pass, and tried again now. */
  again: number;
  /** Done, but their outputs are gone or were changed since: done again now. */
  lost: number;
  /** How many jobs of the manifest cannot be used, and why, for the first of them. */
  wrong: number;
  errors: string[];
  /** Of all jobs in the manifest. */
  keys: Set<string>;
}

interface Wanted {
  key: string;
  data: JobData;
}

/** What there is of a job now: its output and Redis were asked. */
type State = 'none' | 'left' | 'done' | 'lost' | 'failed';
type Before = Awaited<ReturnType<typeof doneBefore>>;

/** Turns a manifest into jobs. Known ones are not done again if their output is there. */
export async function submit(path: string, catalogue: Catalogue): Promise<Submission> {
  const keys = new Set<string>();
  const summary: Submission = { new: 0, known: 0, again: 0, lost: 0, wrong: 0, errors: [], keys };
  const before = await doneBefore();
  const places = new Map<string, string>();
  let some: Wanted[] = [];
  const send = async () => {
    const states = await Promise.all(some.map((wanted) => prepare(wanted, catalogue, before)));
    const fresh = some.filter((_, i) => states[i] === 'new' || states[i] === 'renew');
    const jobs = fresh.map(({ key, data }) => ({ name: data.kind, data, opts: { jobId: key } }));
    await patiently(() => catalogue.queue.addBulk(jobs)); // ignores a key that somebody else added meanwhile
    for (const state of states) ++summary[state === 'renew' ? 'lost' : state];
    some = [];
  };
  for await (const entry of readManifest(path)) {
    const error = 'error' in entry ? entry.error : placeTaken(entry.data, places);
    if ('error' in entry || error !== undefined) {
      if (++summary.wrong <= mostErrors) summary.errors.push(`line ${entry.line}: ${error}`);
      continue;
    }
    const key = keyOf(entry.data);
    if (keys.has(key)) ++summary.known;
    else some.push({ key, data: entry.data });
    keys.add(key);
    if (some.length === chunk) await send();
  }
  await send();
  return summary;
}

/** What is wrong with a job that would replace the output of another one. */
function placeTaken(data: JobData, places: Map<string, string>): string | undefined {
  if (data.output === undefined) return undefined;
  const [address, key] = [addressOf(data.output), keyOf(data)];
  const other = places.get(address) ?? key;
  places.set(address, other);
  return other === key ? undefined : `its "output" is that of another job in the manifest, which it would replace`;
}

/** Prepares Redis for a job that is wanted. @returns how it counts; `new` and `renew` have to be added. */
async function prepare(
  { key, data }: Wanted,
  { queue }: Catalogue,
  before: Before,
): Promise<'new' | 'renew' | 'known' | 'again' | 'lost'> {
  const [state, job] = await stateOf(key, { queue, before });
  if (!job) return state === 'none' ? 'new' : state === 'lost' ? 'renew' : 'known';
  const isOther = !isJobOf(job, key);
  const again = state === 'failed' && (isOther || mayPass(job));
  if (!again && !isOther && state !== 'lost') return 'known';
  await patiently(() => job.updateData(data)); // URLs that are signed anew
  if (state === 'left') return 'again';
  const from = job.returnvalue === null || job.returnvalue === undefined ? 'failed' : 'completed';
  await retry(job, from);
  return state === 'lost' ? 'lost' : 'again';
}

/** What is in Redis under a key, if anything, and what it is worth. */
async function stateOf(
  key: string,
  { queue, before }: { queue: Catalogue['queue']; before: Before },
): Promise<[State, CatalogueJob?]> {
  const was = before.get(key);
  if (was && (await isThere(was))) return ['done'];
  const job = (await patiently(() => queue.getJob(key))) as CatalogueJob | undefined;
  if (!job) return [was ? 'lost' : 'none'];
  if (!job.finishedOn) return ['left', job];
  const isDone = job.returnvalue !== null && job.returnvalue !== undefined;
  const { status } = await presentResult(resultOf(job, isDone ? 'done' : 'failed'));
  return [status === 'done' ? 'done' : isDone ? 'lost' : 'failed', job];
}

/** Whether a failed job is tried again when it is submitted again. An expired signature looks like a missing input. */
function mayPass(job: CatalogueJob): boolean {
  const { reason } = resultOf(job, 'failed');
  return reason === 'missing' || (reason !== 'crash' && new Failure(reason!, '').mayPass);
}

/** Whether what Redis has under a key is the job with this key: anybody may have put something else there. */
function isJobOf(job: CatalogueJob, key: string): boolean {
  try {
    return keyOf(checkedJob(job).data) === key;
  } catch {
    return false;
  }
}

/** Waits until no job is left. */
export async function untilDone({ queue }: Catalogue, tell: (text: string) => void = () => {}): Promise<void> {
  for (;;) {
    const { completed = 0, failed = 0, ...counts } = await patiently(() => queue.getJobCounts());
    const left = Object.values(counts).reduce((sum, n) => sum + n, 0);
    tell(`${left} left, ${completed} done, ${failed} failed`);
    if (left === 0) return;
    await setTimeout(500);
  }
}

/** What has become of the jobs of a manifest: each is looked at, with its output. */
export async function tally(
  { queue }: Catalogue,
  { keys }: Submission,
): Promise<{ done: number; failed: number; neither: number }> {
  const before = await doneBefore();
  const counts = { done: 0, failed: 0, neither: 0 };
  const all = [...keys];
  for (let at = 0; at < all.length; at += chunk) {
    const states = await Promise.all(all.slice(at, at + chunk).map((key) => stateOf(key, { queue, before })));
    for (const [state] of states) ++counts[state === 'done' || state === 'failed' ? state : 'neither'];
  }
  return counts;
}

/** Shows progress where somebody looks. */
export const onTerminal = (text: string): void => {
  if (process.stderr.isTTY) process.stderr.write(`\r${text}   `);
};

export const describe = ({ new: fresh, known, again, lost, wrong }: Submission): string =>
  [
    `${fresh} new jobs, ${known} known`,
    again > 0 ? `${again} tried again` : '',
    lost > 0 ? `${lost} done again, as their outputs are gone or were changed` : '',
    wrong > 0 ? `${wrong} that cannot be used` : '',
  ]
    .filter(Boolean)
    .join(', ');

if (import.meta.filename === process.argv[1])
  await command(async (catalogue) => {
    const { positionals, values } = parseArgs({ allowPositionals: true, options: { wait: { type: 'boolean' } } });
    if (positionals.length !== 1) throw new Failure('broken', 'usage: npm run submit -- MANIFEST.jsonl [--wait]');
    const summary = await submit(fromCaller(positionals[0]!), catalogue);
    for (const error of summary.errors) console.error(error);
    if (summary.wrong > summary.errors.length) console.error(`and ${summary.wrong - summary.errors.length} more`);
    console.log(describe(summary));
    if (!values.wait) return summary.wrong > 0 ? 1 : 0;
    await untilDone(catalogue, onTerminal);
    const { done, failed, neither } = await tally(catalogue, summary);
    const rest = neither > 0 ? `, ${neither} neither: their outputs or Redis have lost them; submit again` : '';
    console.log(`${done} done, ${failed} failed${rest}`);
    return failed + neither + summary.wrong > 0 ? 1 : 0;
  });
