import type { Timings } from 'cagecast';

/** How many transfers are timed. */
export const kTimedRuns = 20;

/** Times of equal transfers, in milliseconds. */
export interface Timed {
  /** The run whose total is the median. */
  median: Timings;
  fastest: number;
  slowest: number;
}

/** Sums up runs, of which there is at least one. */
export function sumUp(runs: readonly Timings[]): Timed {
  const sorted = runs.toSorted((a, b) => a.total - b.total);
  const at = (place: number): Timings => sorted[Math.floor(place * (sorted.length - 1))]!;
  return { median: at(0.5), fastest: at(0).total, slowest: at(1).total };
}
