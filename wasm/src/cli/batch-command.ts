import { appendFileSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Worker } from 'node:worker_threads';
import { firstLine, InputError } from '../gltf/input-error.js';
import { counted } from '../inspect/finding.js';
import type { Verdict } from '../inspect/index.js';
import { isWritten, type Job, writtenBy } from './batch-jobs.js';
import type { Outcome } from './batch-worker.js';
import { isWorse, verdicts } from './inspect-command.js';
import { canonicalPath, writing } from './output.js';
import { jsonText, oneLine } from './print.js';
import type { Progress } from './progress.js';
import type { TransferCommand } from './transfer/command.js';

/** The arguments of `cagecast batch`. */
interface BatchCommand {
  jobs: readonly Job[];
  /** Where lines are added, one per job; if none, on the standard output. */
  results?: string | undefined;
  /** Whether jobs are skipped that `results` says are done. */
  resume: boolean;
  /** The verdict from which on the batch fails; the jobs inspect cages then. */
  failOn?: 'usable' | 'unfit' | undefined;
  workers?: number | undefined;
  /** Called with each error of a job. */
  onError?: ((error: string) => void) | undefined;
}

/** A line of the results. */
type ResultLine = { target: string; output: string | null; report?: string; key: string } & (
  | Outcome
  | { status: 'skipped'; verdict?: Verdict }
);

/** What became of the jobs of a batch. */
interface BatchSummary {
  jobs: number;
  done: number;
  failed: number;
  skipped: number;
  /** How many cages got a verdict that `failOn` names, or a worse one. */
  misfits: number;
  /** The configuration files that settings come from. */
  configs: string[];
  seconds: number;
}

/**
 * Runs jobs, each in one of some threads. A job that fails does not stop the others.
 * @param write  Takes each line as soon as its job has ended.
 * @throws {InputError} if the results cannot be read or written.
 */
export async function batchCommand(
  { jobs, results, resume, failOn, workers, onError }: BatchCommand,
  write: (line: string) => void,
  progress: Progress,
): Promise<BatchSummary> {
  const began = performance.now();
  if (results !== undefined) openResults(results);
  const before = resume ? readResults(results!) : noResults();
  const configs = [...new Set(jobs.flatMap(({ command }) => command.rules.config ?? []))];
  const summary: BatchSummary = { jobs: jobs.length, done: 0, failed: 0, skipped: 0, misfits: 0, configs, seconds: 0 };
  const keys = new Set(jobs.map(({ key }) => key));
  /** Whether the last line about the target of a job that was done is of this job, or of another one of this batch. */
  const isLast = ({ key, command }: Job) => {
    const last = before.last.get(command.target);
    return last && (last.key === key ? last.status !== 'failed' : keys.has(last.key));
  };
  const take = (job: Job, outcome: Outcome | { status: 'skipped'; verdict?: Verdict }) => {
    const { target, output = null, report } = job.command;
    const line: ResultLine = { target, output, ...(report && { report }), key: job.key, ...outcome };
    ++summary[line.status];
    if (line.status === 'failed') onError?.(line.error);
    if (failOn && 'verdict' in line && !isWorse(failOn, line.verdict!)) ++summary.misfits;
    const text = jsonText(line);
    if (results === undefined) write(text);
    else if (line.status !== 'skipped' || !isLast(job)) append(results, text);
    const ended = summary.done + summary.failed + summary.skipped;
    progress.share(`${ended} of ${jobs.length} jobs, ${summary.failed} failed`, ended / jobs.length);
  };
  const waiting: Job[] = [];
  for (const job of jobs) {
    const known = before.lines.get(job.key);
    if (job.error !== undefined) take(job, { status: 'failed', ms: 0, error: job.error });
    else if (
      known &&
      (failOn === undefined || ('verdict' in known && verdicts.includes(known.verdict!))) &&
      isWritten(job) &&
      writtenBy(job).every((path) => before.writers.get(canonicalPath(path)) === job.key)
    )
      take(job, { status: 'skipped', ...('verdict' in known && { verdict: known.verdict! }) });
    else waiting.push(job);
  }
  if (resume) for (const { command } of waiting) removeLeftovers([command.output, command.report]);
  const count = Math.min(workers ?? availableParallelism(), waiting.length);
  await Promise.all(Array.from({ length: count }, () => work(waiting, take)));
  progress.clear();
  return { ...summary, seconds: (performance.now() - began) / 1000 };
}

/** Runs jobs in a thread, one after another, until none is waiting. A thread that dies is replaced. */
async function work(waiting: Job[], take: (job: Job, outcome: Outcome) => void): Promise<void> {
  let worker: Worker | undefined;
  try {
    for (let job = waiting.shift(); job; job = waiting.shift()) {
      worker ??= new Worker(fileURLToPath(import.meta.url), { argv: [] });
      const outcome = await ask(worker, job.command);
      if (outcome === undefined) worker = undefined;
      take(
        job,
        outcome ?? { status: 'failed', ms: 0, error: `${job.command.target}: its thread died, as if out of memory` },
      );
    }
  } finally {
    waiting.length = 0; // If a line could not be taken, the other threads end, too.
    await worker?.terminate();
  }
}

/** The answer of a worker; `undefined` if it died. */
function ask(worker: Worker, command: TransferCommand): Promise<Outcome | undefined> {
  return new Promise((resolve) => {
    const answered = (outcome: Outcome) => end(outcome);
    const died = () => end(undefined);
    const end = (outcome: Outcome | undefined) => {
      // Not removeAllListeners: Worker has some of its own.
      worker.off('message', answered).off('error', died).off('exit', died);
      resolve(outcome);
    };
    worker.on('message', answered).on('error', died).on('exit', died);
    worker.postMessage(command);
  });
}

/** What the results of earlier runs say. */
interface EarlierResults {
  /** The last line of each job that was done, by its key. */
  lines: Map<string, ResultLine>;
  /** The keys of the jobs that wrote files last, by the canonical path of the file. */
  writers: Map<string, string>;
  /** The last lines, by target. */
  last: Map<string, ResultLine>;
}

const noResults = (): EarlierResults => ({ lines: new Map(), writers: new Map(), last: new Map() });

/** Reads the results of earlier runs. A line that was not written to its end is left out. */
function readResults(path: string): EarlierResults {
  const { lines, writers, last } = noResults();
  if (!existsSync(path)) return { lines, writers, last };
  const text = readText(path);
  for (const one of text.split('\n')) {
    try {
      const line = JSON.parse(one) as ResultLine;
      if (typeof line.key !== 'string') continue;
      last.set(line.target, line);
      if (line.status !== 'done') continue;
      lines.set(line.key, line);
      for (const file of [line.output, line.report]) if (file) writers.set(canonicalPath(file), line.key);
    } catch {
      // Cut off when the batch was killed.
    }
  }
  if (text !== '' && !text.endsWith('\n')) append(path, '\n');
  return { lines, writers, last };
}

function readText(path: string): string {
  try {
    return readFileSync(path, 'utf8');
  } catch (error) {
    throw new InputError(`cannot be read (${firstLine(error)})`, { cause: error }).in(path);
  }
}

/** Finds out before the first job whether results can be written. Makes their folder. */
function openResults(path: string): void {
  writing(path, () => mkdirSync(dirname(path), { recursive: true }));
  append(path, '');
}

const append = (path: string, text: string): void => writing(path, () => appendFileSync(path, text));

/** Removes files under temporary names that a batch left when it was killed. */
function removeLeftovers(paths: readonly (string | undefined)[]): void {
  for (const path of paths) {
    if (path === undefined) continue;
    const real = canonicalPath(path);
    const folder = dirname(real);
    if (!existsSync(folder)) continue;
    for (const name of readdirSync(folder))
      if (name.startsWith(`.${basename(real)}.`) && name.endsWith('.tmp')) rmSync(join(folder, name), { force: true });
  }
}

/** A summary for people. */
export function describeBatch({ jobs, done, failed, skipped, misfits, configs, seconds }: BatchSummary): string {
  const parts = [
    `${done} done`,
    `${failed} failed`,
    ...(skipped > 0 ? [`${skipped} done before`] : []),
    ...(misfits > 0 ? [`${misfits} with a cage that does not fit as demanded`] : []),
  ];
  const from = configs.length > 0 ? `; settings from ${configs.join(', ')}` : '';
  return oneLine(`${counted(jobs, 'job')}: ${parts.join(', ')}; ${seconds.toFixed(1)} s${from}`);
}
