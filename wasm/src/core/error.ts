import type { CoreCode } from '../generated/codes.js';

/**
 * What went wrong, for programs: an error that the core reports, or
 *
 * - `badArgument`: an argument has the wrong type.
 * - `notInitialised`: `init()` has not resolved yet.
 * - `unsupported`: this host cannot run the WebAssembly module or start a worker, or the worker has failed.
 * - `aborted`: the worker was terminated before the call ended.
 * - `superseded`: a later call for the same mesh has ended before this one, and counts.
 * - `internal`: a defect of Cagecast; please report it.
 * - `badModel`, `badTemplate`, `badLandmarks`: `cagecast/cages` cannot use the target, the template or the landmarks.
 */
export type Code =
  | CoreCode
  | 'badArgument'
  | 'notInitialised'
  | 'unsupported'
  | 'aborted'
  | 'superseded'
  | 'internal'
  | 'badModel'
  | 'badTemplate'
  | 'badLandmarks';

/** What else is known of an error. */
export interface ErrorDetails extends ErrorOptions {
  /** Default: 0 */
  at?: number | undefined;
  /** Default: `options` for `badOption`, else none. */
  argument?: string | undefined;
}

/**
 * The class of the errors that Cagecast throws, but for plain `Error`s of `cagecast/viewer`, and the reason of a `signal`. Its message
 * names the function, the argument, the value and the limit.
 */
export class CagecastError extends Error {
  override readonly name = 'CagecastError';
  /** What went wrong, for programs. */
  readonly code: Code;
  /** The function, or the entry of the package, that the message begins with; empty if it begins with neither. */
  readonly fn: string;
  /** The message without `fn`. */
  readonly reason: string;
  /** The argument at fault, by its name: `cage`, `target`, `options`, …; undefined if no single one is, or if only the message names it. */
  readonly argument: string | undefined;
  /** The index of the element at fault in the array that the message names, or a count if the number of elements is wrong; else 0. */
  readonly at: number;

  constructor(code: Code, fn: string, reason: string, details: ErrorDetails = {}) {
    super(fn ? `${fn}: ${reason}` : reason, details);
    this.code = code;
    this.fn = fn;
    this.reason = reason;
    this.argument = details.argument || (code === 'badOption' ? 'options' : undefined);
    this.at = details.at ?? 0;
  }
}

/** Why WebAssembly did not start, for messages. A RangeError is a lack of memory, or of addresses, of which V8 sets aside more than it uses. */
export function notStarted(what: string, cause: unknown): string {
  const advice = '; in Node each module sets aside some 10 GB of addresses: raise ulimit -v';
  return `this host cannot run ${what} (${String(cause)})${cause instanceof RangeError ? advice : ''}`;
}

/** Describes a value in a message: short values in full, others by their type. */
export function show(value: unknown): string {
  if (typeof value === 'string') return JSON.stringify(value.length > 40 ? `${value.slice(0, 40)}…` : value);
  if (value === null || value === undefined || typeof value === 'number' || typeof value === 'boolean')
    return String(value);
  if (typeof value === 'object') return `of type ${value.constructor?.name ?? 'object'}`;
  return `of type ${typeof value}`;
}

/** Whether a value is an object whose fields are its entries: not null, nor a `Map` or `Set`, of any realm. */
export const isRecord = <Value>(value: Value): value is Value & Record<string, unknown> =>
  typeof value === 'object' && value !== null && !/ (Map|Set)]$/.test(Object.prototype.toString.call(value));
