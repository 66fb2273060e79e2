import { CagecastError, type Code, type ErrorDetails, show } from './error.js';

/** The error of an argument: `badArgument` of `cagecast/three`, unless it says otherwise. */
export const wrong = (
  reason: string,
  fn = 'cagecast/three',
  code: Code = 'badArgument',
  details?: ErrorDetails,
): CagecastError => new CagecastError(code, fn, reason, details);

/** The error of a wrong value. @param what  The expected kind with its article, such as "a Texture". */
export const notA = (what: string, name: string, value: unknown, fn?: string, code?: Code): CagecastError =>
  wrong(`${name} is ${show(value)}, not ${what}`, fn, code);

/** Checks an option of layers or painting. @throws {CagecastError} `badOption` that names it and its value, unless that fits. */
export function check(fits: boolean, name: string, value: unknown, what: string): void {
  if (!fits) throw notA(what, name, value, undefined, 'badOption');
}

/** @throws {CagecastError} `badOption` for a colour that is not six hexadecimal digits. */
export const checkColor = (name: string, value: string): void =>
  check(typeof value === 'string' && /^#[0-9a-f]{6}$/i.test(value), name, value, 'a colour such as #ff8800');

/** @throws {CagecastError} `badOption` for a number below 0 or above 1. */
export const checkShare = (name: string, value: number): void =>
  check(typeof value === 'number' && value >= 0 && value <= 1, name, value, 'a number from 0 to 1');
