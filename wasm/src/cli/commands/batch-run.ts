import { existsSync, readdirSync, rmSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { dirname, join } from 'node:path';
import { Worker } from 'node:worker_threads';
import { isWorse, kVerdicts } from '../../inspect/finding.js';
import type { Verdict } from '../../inspect/index.js';
import type { Io } from '../io/io.js';
import { canonicalPath, isTemporary } from '../io/output.js';
import type { TransferCommand } from '../model/sources.js';
import { jsonText, oneLine } from '../model/text.js';
import { isWritten, type Job, writtenBy } from './batch-jobs.js';
import { append, noResults, openResults, type ResultLine, readResults } from './batch-results.js';
import type { Outcome } from './batch-worker.js';

/** The jobs of a batch, and how they are run. */
interface Batch {
  jobs: readonly Job[];
  /** Where lines are added, one per job; if none, on the standard output. */
  results?: string | undefined;
  /** Whether jobs are skipped that `results` says are done. */
  resume: boolean;
  /** The verdict from which on the batch fails; the jobs inspect cages then. */
  atLeast?: Verdict | undefined;
  workers?: number | undefined;
  /** Whether errors are printed instead of lines. */
  quiet?: boolean | undefined;
}

/** What became of the jobs of a batch. */
export interface BatchSummary {
  jobs: number;
  done: number;
  failed: number;
  skipped: number;
  /** Of how many targets next to nothing may be painted. */
  bare: number;
  /** How many cages got a verdict worse than `atLeast`. */
  misfits: number;
  /** The configuration files that settings come from. */
  configs: string[];
  seconds: number;
}

/**
 * Runs jobs, each in one of some threads. A job that fails does not stop the others.
 * @throws {InputError} if the results cannot be read or written.
 */
export async function runJobs(batch: Batch, io: Io): Promise<BatchSummary> {
  const { jobs, results, resume, atLeast, workers, quiet } = batch;
  const began = performance.now();
  if (results !== undefined) openResults(results);
  const before = resume ? readResults(results!) : noResults();
  const configs = [...new Set(jobs.flatMap(({ command }) => command.rules.config ?? []))];
  const summary: BatchSummary = {
    jobs: jobs.length,
    done: 0,
    failed: 0,
    skipped: 0,
    bare: 0,
    misfits: 0,
    configs,
    seconds: 0,
  };
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
    if (line.status === 'failed' && quiet) io.err(`cagecast: ${oneLine(line.error)}\n`);
    if ('note' in line) ++summary.bare;
    if (atLeast && 'verdict' in line && isWorse(line.verdict!, atLeast)) ++summary.misfits;
    if (results === undefined) {
      if (!quiet) io.out(jsonText(line));
    } else if (line.status !== 'skipped' || !isLast(job)) append(results, jsonText(line));
    const ended = summary.done + summary.failed + summary.skipped;
    io.share(`${ended} of ${jobs.length} jobs, ${summary.failed} failed`, ended / jobs.length);
  };
  const waiting: Job[] = [];
  for (const job of jobs) {
    const known = before.lines.get(job.key);
    const verdict = known && 'verdict' in known ? known.verdict : undefined;
    const isDone = (atLeast === undefined || kVerdicts.includes(verdict!)) && isWritten(job);
    if (job.error !== undefined) take(job, { status: 'failed', ms: 0, error: job.error });
    else if (known && isDone && writtenBy(job).every((path) => before.writers.get(canonicalPath(path)) === job.key))
      take(job, { status: 'skipped', ...(verdict && { verdict }) });
    else waiting.push(job);
  }
  if (resume) for (const job of waiting) removeLeftovers(writtenBy(job));
  const count = Math.min(workers ?? availableParallelism(), waiting.length);
  await Promise.all(Array.from({ length: count }, () => work(waiting, take)));
  return { ...summary, seconds: (performance.now() - began) / 1000 };
}

/** Runs jobs in a thread, one after another, until none is waiting. A thread that dies is replaced. */
async function work(waiting: Job[], take: (job: Job, outcome: Outcome) => void): Promise<void> {
  let worker: Worker | undefined;
  try {
    for (let job = waiting.shift(); job; job = waiting.shift()) {
      // Without the flags of this process, which may load more.
      worker ??= new Worker(new URL('./cli.js', import.meta.url), { argv: [], execArgv: [] });
      const outcome = await ask(worker, job.command);
      if (outcome === undefined) worker = undefined;
      const error = `${job.command.target}: its thread died, as if out of memory`;
      take(job, outcome ?? { status: 'failed', ms: 0, error });
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

/** Removes files under temporary names that a batch left when it was killed. */
function removeLeftovers(paths: readonly string[]): void {
  for (const path of paths) {
    const real = canonicalPath(path);
    const folder = dirname(real);
    if (!existsSync(folder)) continue;
    for (const name of readdirSync(folder)) if (isTemporary(name, real)) rmSync(join(folder, name), { force: true });
  }
}
