import { faultOfNames } from '../api/option-names.js';
import { faultOfParts } from '../api/parts.js';
import { wrong } from '../core/checks.js';

export { check, checkColor, checkShare, notA, wrong } from '../core/checks.js';

/** @throws {CagecastError} `badOption` for options that are no object, or one that a function does not have. */
export function checkNames(fn: string, where: string, given: unknown, known: readonly string[]): void {
  const fault = faultOfNames(fn, where, given, known);
  if (fault !== undefined) throw wrong(fault, fn, 'badOption');
}

/** @throws {CagecastError} `badOption` for an option `parts` that has no patterns. */
export function checkParts(fn: string, parts: unknown): void {
  const fault = faultOfParts(fn, parts);
  if (fault !== undefined) throw wrong(fault, fn, 'badOption');
}
