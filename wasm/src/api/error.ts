import type { CoreCode } from '../generated/codes.js';

/**
 * What went wrong, for programs: what the core finds wrong, or
 *
 * - `badArgument`: an argument has the wrong type.
 * - `notInitialised`: `init()` has not resolved yet.
 * - `unsupported`: this host cannot run the WebAssembly module.
 * - `aborted`: the call was given up through its `AbortSignal`.
 * - `internal`: a defect of Cagecast; please report it.
 */
export type Code = CoreCode | 'badArgument' | 'notInitialised' | 'unsupported' | 'aborted' | 'internal';

/** The one error that Cagecast throws. Its message names the function, the argument, the value and the limit. */
export class CagecastError extends Error {
  override readonly name = 'CagecastError';
  /** What went wrong, for programs. */
  readonly code: Code;
  /** The element at fault, counted in the array that the message names; how many there are, where that is the fault; else 0. */
  readonly at: number;

  constructor(code: Code, message: string, at = 0, options?: ErrorOptions) {
    super(message, options);
    this.code = code;
    this.at = at;
  }
}

/** Names a value in a message: what it is, and how much of it. */
export function show(value: unknown): string {
  if (typeof value === 'string') return JSON.stringify(value.length > 40 ? `${value.slice(0, 40)}…` : value);
  if (value === null || value === undefined || typeof value === 'number' || typeof value === 'boolean')
    return String(value);
  if (typeof value === 'object') return `of type ${value.constructor?.name ?? 'object'}`;
  return `of type ${typeof value}`;
}
