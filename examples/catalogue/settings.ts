import { availableParallelism } from 'node:os';
import { resolve } from 'node:path';

const text = (name: string, otherwise: string): string => process.env[`CATALOGUE_${name}`] || otherwise;

function number(name: string, otherwise: number): number {
  const value = Number(text(name, String(otherwise)));
  if (!(value >= 0)) throw new Error(`CATALOGUE_${name} is ${text(name, '')}, not a number ≥ 0`);
  return value;
}

/** What differs between machines, from the environment; the README has a table. */
export const settings = {
  redis: process.env.REDIS_URL || 'redis://127.0.0.1:6379',
  /** Begins all keys in Redis, so that several catalogues can share one. */
  prefix: text('PREFIX', 'catalogue'),
  inputs: resolve(text('INPUTS', 'inputs')),
  outputs: resolve(text('OUTPUTS', 'outputs')),
  /** Servers that inputs may come from and outputs may go to, as host or host:port. */
  hosts: text('HOSTS', '').split(',').filter(Boolean),
  /** Jobs at once in one worker: each has a process of its own. */
  concurrency: number('CONCURRENCY', availableParallelism()),
  /** Jobs that all workers together may start in a second; 0: any number. */
  rate: number('RATE', 0),
  /** Limits of a job: seconds, megabytes of memory, megabytes of one input. */
  seconds: number('SECONDS', 120),
  memory: number('MEMORY', 2048),
  inputSize: number('INPUT_SIZE', 256),
  /** How often a job is tried if its error may pass, and how long it waits before the second time; the wait doubles. */
  attempts: number('ATTEMPTS', 5),
  backoff: number('BACKOFF', 1000),
  /** A worker that has not said for so many milliseconds that it lives is taken for dead. */
  lock: number('LOCK', 30_000),
  /** Where the status page listens. It has no password: see the README. */
  address: text('ADDRESS', '127.0.0.1'),
  port: number('PORT', 8787),
};

/** A path as it was meant where `npm run` was called, which runs programs in this folder. */
export const fromCaller = (path: string): string => resolve(process.env.INIT_CWD ?? '.', path);
