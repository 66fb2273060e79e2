import type { CoreCode } from '../generated/codes.js';

/**
 * What went wrong, for programs: an error that the core reports, or
 *
 * - `badArgument`: an argument has the wrong type.
 * - `notInitialised`: `init()` has not resolved yet.
 * - `unsupported`: this host cannot run the WebAssembly module.
 * - `aborted`: the worker was terminated before the call ended.
 * - `internal`: a defect of Cagecast; please report it.
 * - `badModel`, `badTemplate`, `badLandmarks`: `cagecast/cages` cannot use the target, the template or the landmarks.
 */
export type Code =
  | CoreCode
  | 'badArgument'
  | 'notInitialised'
  | 'unsupported'
  | 'aborted'
  | 'internal'
  | 'badModel'
  | 'badTemplate'
  | 'badLandmarks';

/** The only class of errors that Cagecast throws. Its message names the function, the argument, the value and the limit. */
export class CagecastError extends Error {
  override readonly name = 'CagecastError';
  /** What went wrong, for programs. */
  readonly code: Code;
  /** The index of the element at fault in the array that the message names, or a count if the number of elements is wrong; else 0. */
  readonly at: number;

  constructor(code: Code, message: string, at = 0, options?: ErrorOptions) {
    super(message, options);
    this.code = code;
    this.at = at;
  }
}

/** Describes a value in a message: short values in full, others by their type. */
export function show(value: unknown): string {
  if (typeof value === 'string') return JSON.stringify(value.length > 40 ? `${value.slice(0, 40)}…` : value);
  if (value === null || value === undefined || typeof value === 'number' || typeof value === 'boolean')
    return String(value);
  if (typeof value === 'object') return `of type ${value.constructor?.name ?? 'object'}`;
  return `of type ${typeof value}`;
}

/** Whether something has its entries as fields. A map or a set, of any realm, would seem to have none. */
export const isRecord = <Value>(value: Value): value is Value & Record<string, unknown> =>
  typeof value === 'object' && value !== null && !/ (Map|Set)]$/.test(Object.prototype.toString.call(value));
