import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { type Job, Queue } from 'bullmq';
import { Redis } from 'ioredis';
import { type Reason, reasonOf } from './failure.ts';
import { kinds } from './kinds/index.ts';
import type { Facts } from './kinds/kind.ts';
import { settings } from './settings.ts';
import { shown } from './storage.ts';

const { version } = JSON.parse(readFileSync(new URL(import.meta.resolve('cagecast/package.json')), 'utf8'));

/** What a job is to do, as it is kept in Redis. */
export interface JobData {
  kind: string;
  /** Where each input is, and the hash of its bytes. */
  inputs: Record<string, { place: string; sha256: string }>;
  settings: Record<string, unknown>;
  /** A URL for PUT; by default a file in the output folder, named by the job's key. */
  output?: string;
}

/** What a job that is done leaves in Redis. */
export interface Done {
  facts: Facts;
  output?: string;
  ms: number;
  cpuMs: number;
}

export type CatalogueJob = Job<JobData, Done>;

/** A line of the results. */
export interface Result extends Facts {
  key: string;
  kind: string;
  status: 'done' | 'failed';
  /** Where its inputs are, by name, without the signatures of URLs. */
  inputs: Record<string, string>;
  settings: Record<string, unknown>;
  output?: string;
  ms?: number;
  cpuMs?: number;
  reason?: Reason;
  error?: string;
}

/**
 * Identifies a job by all that its result depends on: content, not names. Whoever asks for the same again gets the same job.
 */
export function keyOf({ kind, inputs, settings }: JobData): string {
  const sorted = (value: unknown): unknown =>
    Array.isArray(value)
      ? value.map(sorted)
      : value instanceof Object
        ? Object.entries(value)
            .map(([name, one]) => [name, sorted(one)])
            .sort(([a], [b]) => (String(a) < String(b) ? -1 : 1))
        : value;
  const hashes = Object.entries(inputs).map(([name, { sha256 }]) => [name, sha256]);
  const all = JSON.stringify([version, kind, kinds[kind]!.version, hashes.sort(), sorted(settings)]);
  return `${kind}-${createHash('sha256').update(all).digest('hex').slice(0, 32)}`;
}

/** Where a job's output is written in the output folder: spread over folders, which slow down with too many files. */
export const outputOf = (key: string, ending: string): string => `${key.replace(/-(..)/, '/$1/')}${ending}`;

/** A connection that waits for a Redis that is restarted. */
export function connect(): Redis {
  const redis = new Redis(settings.redis, {
    maxRetriesPerRequest: null,
    retryStrategy: (times) => Math.min(100 * times, 2000),
  });
  redis.on('error', () => {}); // it tries again
  return redis;
}

export const queueName = 'jobs';

/** The queue, and the connection that it has. */
export interface Catalogue {
  queue: Queue<JobData, Done>;
  redis: Redis;
  close(): Promise<void>;
}

export function openCatalogue(): Catalogue {
  const redis = connect();
  const queue = new Queue<JobData, Done>(queueName, {
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

/** A finished job as a line of the results. */
export function resultOf(
  { id, data, returnvalue, failedReason, progress }: CatalogueJob,
  status: Result['status'],
): Result {
  const { kind, inputs, settings } = data;
  const places = Object.entries(inputs).map(([name, { place }]) => [name, shown(place)]);
  const common = { key: id!, kind, inputs: Object.fromEntries(places), settings };
  // A job that failed before it was done still has the reason.
  if (status === 'done') {
    const { facts, ...rest } = returnvalue;
    return { ...common, status, ...facts, ...rest };
  }
  const facts = progress instanceof Object ? (progress as Facts) : {};
  return { ...common, status, ...facts, reason: reasonOf(failedReason), error: failedReason };
}

/** The results of all jobs that are done or failed, as far as Redis has them, page by page. */
export async function* finishedJobs({ queue }: Catalogue): AsyncGenerator<Result> {
  const page = 1000;
  for (const [state, status] of [['completed', 'done'] as const, ['failed', 'failed'] as const])
    for (let at = 0, jobs: CatalogueJob[] = []; at === 0 || jobs.length === page; at += page) {
      jobs = await queue.getJobs([state], at, at + page - 1, true);
      for (const job of jobs) if (job) yield resultOf(job, status);
    }
}
