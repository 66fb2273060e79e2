import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { Job, Queue } from 'bullmq';
import { Redis } from 'ioredis';
import { asFailure, publicOf, type Reason, reasonOf, redisTrouble } from './failure.ts';
import { kinds } from './kinds/index.ts';
import type { Facts } from './kinds/kind.ts';
import { patiently, tellTrouble } from './patience.ts';
import { settings } from './settings.ts';
import { checkedDone, checkedJob, type Done, isRecord, type JobData, type Written } from './shape.ts';
import { isThere, shown } from './storage.ts';

const { version } = JSON.parse(readFileSync(new URL(import.meta.resolve('cagecast/package.json')), 'utf8'));

export type CatalogueJob = Job<JobData, Done>;

/** A line of the results. */
export interface Result extends Facts, Partial<Written> {
  key: string;
  kind: string;
  status: 'done' | 'failed';
  /** Where its inputs are, by name, without the signatures of URLs. */
  inputs: Record<string, string>;
  settings: Record<string, unknown>;
  ms?: number;
  cpuMs?: number;
  reason?: Reason;
  error?: string;
}

/**
 * Identifies a job by all that its result depends on: content, not names, and the place of its output if that is an address. Whoever
 * asks for the same again gets the same job.
 */
export function keyOf({ kind, inputs, settings, output }: JobData): string {
  const sorted = (value: unknown): unknown =>
    Array.isArray(value)
      ? value.map(sorted)
      : value instanceof Object
        ? Object.entries(value)
            .map(([name, one]) => [name, sorted(one)])
            .sort(([a], [b]) => (String(a) < String(b) ? -1 : 1))
        : value;
  const hashes = Object.entries(inputs).map(([name, { sha256 }]) => [name, sha256]);
  const place = output === undefined ? [] : [addressOf(output)];
  const all = JSON.stringify([version, kind, kinds[kind]!.version, hashes.sort(), sorted(settings), ...place]);
  return `${kind}-${createHash('sha256').update(all).digest('hex').slice(0, 32)}`;
}

/** What of a signed address is the same every night: all but what looks like a signature. */
export function addressOf(output: string): string {
  const url = new URL(output);
  for (const name of [...url.searchParams.keys()])
    if (/^(x-amz|x-goog)-|sig|token|expir|key|credential|policy|date|^(s[eprtv]|spr|sk[a-z]+)$/i.test(name))
      url.searchParams.delete(name);
  url.searchParams.sort();
  url.hash = '';
  return url.href;
}

/** Where a job's output is written in the output folder: spread over folders, which slow down with too many files. */
export const outputOf = (key: string, ending: string): string => `${key.replace(/-(..)/, '/$1/')}${ending}`;

/** A connection that waits for a Redis that is restarted. */
export function connect(): Redis {
  const redis = new Redis(settings.redis, {
    maxRetriesPerRequest: null,
    retryStrategy: (times) => Math.min(100 * times, 2000),
    reconnectOnError: ({ message }) => message.startsWith('READONLY'), // its name may lead to the master by now
  });
  redis.on('error', (error) => {
    const failure = asFailure(error);
    if (failure.reason === 'refused') throw failure; // a wrong password stays wrong
    tellTrouble(redisTrouble(error) ?? failure.message);
  });
  redis.on('ready', () => tellTrouble(''));
  return redis;
}

export const queueName = 'jobs';

/** The queue, and the connection that it has. */
export interface Catalogue {
  queue: Queue<JobData, Done>;
  redis: Redis;
  close(): Promise<void>;
}

/** A job that is no JSON in Redis is one without data: `checkedJob` says so. */
class JobQueue extends Queue<JobData, Done> {
  override async getJob(id: string): Promise<CatalogueJob | undefined> {
    try {
      return await super.getJob(id);
    } catch (error) {
      if (!(error instanceof SyntaxError)) throw error;
      return new Job(this, 'broken', {}, {}, id) as unknown as CatalogueJob;
    }
  }
}

export function openCatalogue(): Catalogue {
  const redis = connect();
  const queue = new JobQueue(queueName, {
    connection: redis,
    prefix: settings.prefix,
    defaultJobOptions: {
      attempts: settings.attempts,
      backoff: { type: 'exponential', delay: settings.backoff, jitter: 0.5 },
    },
  });
  queue.on('error', () => {}); // the connection tries again
  const close = async () => {
    await queue.close();
    redis.disconnect();
  };
  return { queue, redis, close };
}

/** The hash that counts for each job how often it was started and neither done nor failed: it killed its worker. */
export const startsKey = `${settings.prefix}:${queueName}:starts`;

/** Lets a job that is finished be done again. */
export async function retry(job: CatalogueJob, from: 'failed' | 'completed'): Promise<void> {
  try {
    await patiently(() => job.retry(from, { resetAttemptsMade: true }));
  } catch (error) {
    // Another program was faster, or the answer of Redis was lost and it was asked twice.
    if (!/is not in the|Missing key/.test((error as Error).message)) throw error;
  }
}

/** A finished job as a line of the results. One that is not as it should be has failed. */
export function resultOf(job: CatalogueJob, status: Result['status']): Result {
  const common = { key: String(job.id), kind: '', inputs: {}, settings: {} };
  try {
    const { kind, inputs, settings } = checkedJob(job).data;
    const places = Object.entries(inputs).map(([name, { place }]) => [name, shown(place)]);
    Object.assign(common, publicOf({ kind, inputs: Object.fromEntries(places), settings }));
    // A job that failed before it was done still has the reason.
    if (status === 'done') {
      const { facts, ...rest } = checkedDone(job.returnvalue);
      return { ...facts, ...common, status, ...rest };
    }
  } catch (error) {
    const { reason, message } = asFailure(error);
    return { ...common, status: 'failed', reason, error: message };
  }
  const facts = isRecord(job.progress) ? (job.progress as Facts) : {};
  const error = publicOf(String(job.failedReason ?? 'unexpected: no reason is known'));
  return { ...facts, ...common, status, reason: reasonOf(error), error };
}

/** A result as it is now: one whose output is gone or was changed has failed. */
export async function presentResult(result: Result): Promise<Result> {
  if (result.status !== 'done' || (await isThere(result))) return result;
  return { ...result, status: 'failed', reason: 'lost', error: `lost: ${result.output} is gone, or is another file` };
}

/** The results of all jobs that are done or failed, as far as Redis has them, page by page. */
export async function* finishedJobs({ queue }: Catalogue): AsyncGenerator<Result> {
  const page = 1000;
  for (const [state, status] of [['completed', 'done'] as const, ['failed', 'failed'] as const])
    for (let at = 0, ids: string[] = []; at === 0 || ids.length === page; at += page) {
      ids = await patiently(() => queue.getRanges([state], at, at + page - 1, true));
      const jobs = await Promise.all(ids.map((id) => patiently(() => queue.getJob(id))));
      for (const job of jobs) if (job) yield resultOf(job, status);
    }
}
