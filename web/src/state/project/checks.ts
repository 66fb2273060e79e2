/** Checks of values from a file that anybody may have written. */

import type { Locks } from '../choices';

/** @throws Error that the project is damaged. */
export function damaged(what: string): never {
  throw new Error(`the project is damaged: ${what}`);
}

export function objectOf(value: unknown, what: string): Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value)
    ? (value as Record<string, unknown>)
    : damaged(`it has no ${what}`);
}

export function listOf(value: unknown, most: number, what: string): unknown[] {
  return Array.isArray(value) && value.length <= most ? value : damaged(`it has no list of ${what}, or too long a one`);
}

export const textOf = (value: unknown, otherwise: string): string =>
  typeof value === 'string' ? value.slice(0, 1000) : otherwise;

/** A number within limits, or the default. */
export const numberOf = (value: unknown, least: number, most: number, otherwise: number): number =>
  typeof value === 'number' && value >= least && value <= most ? value : otherwise;

/** One of some values, or the first of them. */
export const oneOf = <T>(value: unknown, all: readonly T[]): T => (all.includes(value as T) ? (value as T) : all[0]!);

/** Overrides of parts; others than there are do no harm. */
export const locksOf = (value: unknown): Locks =>
  Object.fromEntries(
    Object.entries(objectOf(value, 'overrides')).flatMap(([key, lock]) =>
      /^\d{1,9}$/.test(key) ? [[key, oneOf(lock, ['auto', 'keep', 'exclude', 'always', 'out'])]] : [],
    ),
  );
