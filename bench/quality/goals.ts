import { type Quality, shift } from './measure.js';
import type { Score } from './score.js';

/** What the product is held to; shares of area and of pixels, see `Score`. */
const goals = {
  /** The samples, by method. */
  sample: {
    naive: { mostSuppressed: 0 },
    paper: { suppressed: 0.99, kept: 0.9 },
    default: { suppressed: 0.998, kept: 0.995, forbidden: 0.001, bare: 0.005 },
  },
  /** Every model but the spoiled ones, `default`, at each of these thresholds. */
  whole: { suppressed: 0.998, kept: 0.998, from: 0.3, to: 0.8 },
  /** The same with the cage out of place; not the traps, which are as tight as they can be made. */
  shifted: { suppressed: 0.97, kept: 0.97 },
  /** The share of the painted area whose texture is smeared. */
  smear: 0.01,
};

const percent = (share: number): string => `${(100 * share).toFixed(2)} %`;

/** What falls short of a goal, a line each. Models that are spoiled on purpose need not reach any. */
export function missedGoals(results: Readonly<Record<string, Quality>>): string[] {
  const lines: string[] = [];
  for (const [name, quality] of Object.entries(results)) {
    if (quality.kind === 'spoiled') continue;
    const atLeast = (what: string, value: number, limit: number): void => {
      // A goal that nothing was measured for is missed too.
      if (!(value >= limit)) lines.push(`${name}, ${what}: ${percent(value)}, goal at least ${percent(limit)}`);
    };
    const atMost = (what: string, value: number, limit: number): void => {
      if (!(value <= limit)) lines.push(`${name}, ${what}: ${percent(value)}, goal at most ${percent(limit)}`);
    };
    const both = (what: string, { suppressed, kept }: Score, limit: Pick<Score, 'suppressed' | 'kept'>): void => {
      atLeast(`${what}: suppressed`, suppressed, limit.suppressed);
      atLeast(`${what}: kept`, kept, limit.kept);
    };
    const { naive, paper, default: ours } = quality.methods;
    if (quality.kind === 'sample') {
      atMost('naive: suppressed', naive.suppressed, goals.sample.naive.mostSuppressed);
      both('paper', paper, goals.sample.paper);
      both('default', ours, goals.sample.default);
      atMost('default: pixels with paint where none must be', ours.forbidden, goals.sample.default.forbidden);
      atMost('default: pixels without paint where it belongs', ours.bare, goals.sample.default.bare);
    }
    for (const [threshold, value] of Object.entries(quality.thresholds.default)) {
      const isHeld = Number(threshold) >= goals.whole.from && Number(threshold) <= goals.whole.to;
      if (isHeld) both(`default at threshold ${threshold}`, value, goals.whole);
    }
    for (const [axis, value] of Object.entries(quality.kind === 'trap' ? {} : quality.shifted)) {
      both(`default, cage moved by ${percent(shift)} along ${axis}`, value, goals.shifted);
    }
    atMost('smeared area', quality.smear.corner, goals.smear);
    atMost('smeared area, borders cut', quality.smear.cut, goals.smear);
  }
  return lines;
}
