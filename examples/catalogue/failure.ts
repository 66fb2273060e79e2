import { dirname } from 'node:path';
import { inspect } from 'node:util';

/** Why a job failed, in the words of the dead-letter list and the metrics. */
export const reasons = {
  broken: 'an input or a setting cannot be used, or it is not a job of the catalogue',
  limit: 'more bytes, memory or time than allowed',
  missing: 'an input is not there, or is another than when it was submitted',
  lost: 'it was done, but its output is gone or was changed since: submit it again',
  refused: 'a path outside the folders, a link, or a server that is not allowed',
  network: 'a server, the network or a disk did not answer as it should; may pass',
  crash: 'the process that did the job died, or was not heard of; tried again until it has died three times',
  unexpected: 'an error of the program: please report it',
} as const;

export type Reason = keyof typeof reasons;

/** How a job fails. Its message begins with the reason, and shows no signature of an address. */
export class Failure extends Error {
  readonly reason: Reason;
  /** What was found out nevertheless. */
  readonly facts: object | undefined;

  constructor(reason: Reason, text: string, facts?: object) {
    super(`${reason}: ${withoutSecrets(text.split('\n', 1)[0]!).slice(0, 500)}`);
    this.reason = reason;
    this.facts = facts;
  }

  /** Whether it can help to try again. */
  get mayPass(): boolean {
    return this.reason === 'network' || this.reason === 'crash';
  }
}

/** A text whose addresses have no user, password, query and fragment: whoever has those can read or write. */
export const withoutSecrets = (text: string): string =>
  text
    .replace(/\b([a-z][a-z0-9+.-]*:\/\/)[^\s/?#"'<>]*@/gi, '$1')
    .replace(/\b([a-z][a-z0-9+.-]*:\/\/[^\s?#"'<>]*)[?#][^\s"'<>]*/gi, '$1')
    .replace(/[?#&][^\s"'<>?#=]*=[^\s"'<>]*/g, '');

/** Any plain data with all its texts so. An address is cut at its query, whatever is in that. */
export function publicOf<T>(value: T): T {
  const all = (one: unknown): unknown => {
    if (typeof one === 'string')
      return withoutSecrets(/^[a-z][a-z0-9+.-]*:\/\//i.test(one) ? one.replace(/[?#].*$/s, '') : one);
    if (Array.isArray(one)) return one.map(all);
    if (!(one instanceof Object)) return one;
    return Object.fromEntries(Object.entries(one).map(([name, inner]) => [withoutSecrets(name), all(inner)]));
  };
  return all(value) as T;
}

const troubles = [
  ['OOM', 'Redis is full: raise its maxmemory, or make room with npm run report -- --forget'],
  ['LOADING', 'Redis is reading its file'],
  ['READONLY', 'Redis is a replica, which takes no writes: REDIS_URL must be that of its master'],
  ['MASTERDOWN', 'Redis is a replica whose master does not answer'],
  ['BUSY', 'Redis is busy with a script: SCRIPT KILL ends it'],
  ['MISCONF', 'Redis cannot write its file: look at its disk'],
  ['NOREPLICAS|CLUSTERDOWN|TRYAGAIN|EXECABORT', 'Redis takes no writes at the moment'],
  ['ERR max number of clients reached', 'Redis has no room for another client: raise its maxclients'],
].map(([code, text]) => ({ pattern: new RegExp(`(^|-)(${code})\\b`), text }));
const noConnection =
  /ECONNREFUSED|ECONNRESET|ETIMEDOUT|ENOTFOUND|EAI_AGAIN|EHOSTUNREACH|ENETUNREACH|Connection is closed|Stream isn't writeable/;

/** The texts in anything that was thrown; '' for all else: codes of BullMQ are numbers, and anybody may throw anything. */
function partsOf(error: unknown): { message: string; code: string; name: string; path: string; cause: unknown } {
  const { message, code, name, path, cause } = Object(error) as Record<string, unknown>;
  const textOf = (value: unknown): string => (typeof value === 'string' ? value : '');
  return { message: textOf(message), code: textOf(code), name: textOf(name), path: textOf(path), cause };
}

/** What keeps Redis from answering, in a plain sentence; undefined if it is nothing that passes. */
export function redisTrouble(error: unknown): string | undefined {
  const { message, code } = partsOf(error);
  const known = troubles.find(({ pattern }) => pattern.test(message));
  if (known) return known.text;
  return noConnection.test(`${code} ${message}`)
    ? 'Redis does not answer: start it, or set REDIS_URL to where it is'
    : undefined;
}

const sentences: Record<string, string> = {
  ENOENT: 'is not there',
  ENOTDIR: 'is not there',
  EISDIR: 'is a folder',
  EACCES: 'may not be used by this user',
  EPERM: 'may not be used by this user',
  ELOOP: 'is a link, or leads in a circle',
  ENOSPC: 'its disk is full',
  EDQUOT: 'its disk is full for this user',
  EROFS: 'its disk takes no writes',
  EMFILE: 'this program has too many files open (ulimit -n)',
  EIO: 'its disk does not answer',
  ESTALE: 'its disk does not answer',
  EADDRINUSE: 'another program listens there',
  EADDRNOTAVAIL: 'this machine has no such address',
  ECONNREFUSED: 'nobody listens there',
  ECONNRESET: 'the connection was cut',
  EPIPE: 'the connection was cut',
  UND_ERR_SOCKET: 'the connection was cut',
  ENOTFOUND: 'no server has this name',
  EAI_AGAIN: 'the name of the server cannot be looked up now',
  ETIMEDOUT: 'the server does not answer',
  UND_ERR_CONNECT_TIMEOUT: 'the server does not answer',
  TimeoutError: 'the server took too long',
  ERR_STRING_TOO_LONG: 'has a line of more than 500 MB',
};

const kDeepest = 10; // causes of causes
const sentenceOf = (word: string): string | undefined => (Object.hasOwn(sentences, word) ? sentences[word] : undefined);

/** What an error of the system or of a server means, to be put after the name of what it is about. */
export function meaningOf(error: unknown, depth = 0): string {
  const { code, name, cause } = partsOf(error);
  if (cause instanceof Error && depth < kDeepest) return meaningOf(cause, depth + 1);
  return sentenceOf(code) ?? sentenceOf(name) ?? `cannot be used (${code || name || 'for a reason that is not known'})`;
}

// What BullMQ itself says of jobs that its workers have, or had.
const lostLock = /^(Missing lock|Lock mismatch|could not renew lock) for job\b/;
const noJob = /^Missing key for job\b/;

/** Any error, and anything else that was thrown, as a failure. */
export function asFailure(error: unknown): Failure {
  if (error instanceof Failure) return error;
  const trouble = redisTrouble(error);
  if (trouble !== undefined) return new Failure('network', trouble);
  const { message, code, path } = partsOf(error);
  const text = error instanceof Error ? message : typeof error === 'string' ? error : inspect(error);
  if (/^(NOAUTH|WRONGPASS|NOPERM)\b/.test(text))
    return new Failure('refused', 'Redis refuses the user or the password of REDIS_URL');
  if (lostLock.test(text))
    return new Failure('crash', 'a job took longer than its lock: another worker may do it too (CATALOGUE_LOCK)');
  if (noJob.test(text)) return new Failure('missing', 'the job was removed from Redis before it was done');
  if (code.startsWith('ERR_PARSE_ARGS')) return new Failure('broken', text);
  if (sentenceOf(code)) return new Failure('missing', `${path || 'a file or server'}: ${meaningOf(error)}`);
  return new Failure('unexpected', text);
}

/** The reason that a message begins with, as BullMQ keeps it. */
export function reasonOf(message: unknown): Reason {
  const text = String(message ?? '');
  const [word = ''] = text.split(':', 1);
  if (Object.hasOwn(reasons, word)) return word as Reason;
  // BullMQ's own words on a job that stalled too often or lost its lock.
  return /stalled/.test(text) || lostLock.test(text) ? 'crash' : 'unexpected';
}

// What nobody caught ends a program of this folder with one sentence: a trace could show addresses, and says nobody what to do.
if (dirname(process.argv[1] ?? '') === import.meta.dirname)
  process.on('uncaughtException', (error) => {
    console.error(asFailure(error).message);
    process.exit(2);
  });
