import { availableParallelism } from 'node:os';
import { resolve } from 'node:path';
import { Failure } from './failure.ts';

const text = (name: string, otherwise: string): string => process.env[`CATALOGUE_${name}`] || otherwise;
const list = (name: string): string[] => text(name, '').split(',').filter(Boolean);

function number(name: string, otherwise: number, least = 0, most = Number.POSITIVE_INFINITY): number {
  const value = Number(text(name, String(otherwise)));
  const range = most === Number.POSITIVE_INFINITY ? `≥ ${least}` : `from ${least} to ${most}`;
  if (!(value >= least && value <= most))
    throw new Failure('broken', `CATALOGUE_${name} is "${text(name, '')}", not a number ${range}`);
  return value;
}

function redisUrl(): string {
  const url = process.env.REDIS_URL || 'redis://127.0.0.1:6379';
  // It is not shown: it may have a password.
  if (!URL.canParse(url) || !/^rediss?:$/.test(new URL(url).protocol))
    throw new Failure('broken', 'REDIS_URL is not an address such as redis://127.0.0.1:6379');
  return url;
}

/** What differs between machines, from the environment; the README has a table. */
export const settings = {
  redis: redisUrl(),
  /** Begins all keys in Redis, so that several catalogues can share one. */
  prefix: text('PREFIX', 'catalogue'),
  inputs: resolve(text('INPUTS', 'inputs')),
  outputs: resolve(text('OUTPUTS', 'outputs')),
  /** Servers that inputs may come from and outputs may go to, as host or host:port. */
  hosts: list('HOSTS'),
  /** Jobs that a line of a manifest may stand for. */
  pairs: number('PAIRS', 1_000_000, 1),
  /** Jobs at once in one worker: each has a process of its own. */
  concurrency: number('CONCURRENCY', availableParallelism(), 1),
  /** Jobs that all workers together may start in a second; 0: any number. */
  rate: number('RATE', 0),
  /** Limits of a job: seconds, megabytes of memory, megabytes of one input. */
  seconds: number('SECONDS', 120),
  memory: number('MEMORY', 2048),
  inputSize: number('INPUT_SIZE', 256),
  /** How often a job is tried if its error may pass, and how long it waits before the second time; the wait doubles. */
  attempts: number('ATTEMPTS', 5, 1),
  backoff: number('BACKOFF', 1000),
  /** A worker that has not said for so many milliseconds that it lives is taken for dead. */
  lock: number('LOCK', 30_000, 100),
  /** Where the status page listens, and the names that it is asked by there, besides localhost and IP addresses. */
  address: text('ADDRESS', '127.0.0.1'),
  port: number('PORT', 8787, 0, 65_535),
  names: list('NAMES'),
};

/** A path as it was meant where `npm run` was called, which runs programs in this folder. */
export const fromCaller = (path: string): string => resolve(process.env.INIT_CWD ?? '.', path);
