import { percent } from '../percent.js';
import { mean } from '../statistics.js';
import type { CageResults } from './cages.js';
import { kShifts, rightVerdicts } from './confidence.js';
import type { FitScore, Spread } from './fit-score.js';
import { kShift, type Quality } from './measure.js';
import type { Score } from './score.js';

/** What the product is held to; shares of area and of pixels, see `Score`. */
const kGoals = {
  /** The samples, by method. */
  naive: { maxSuppressed: 0 },
  paper: { suppressed: 0.99, kept: 0.9 },
  sample: { suppressed: 0.998, kept: 0.995, forbidden: 0.001, bare: 0.005 },
  /** Every model but the spoiled ones, `default`, at each of these thresholds. */
  whole: { suppressed: 0.998, kept: 0.998, from: 0.3, to: 0.8 },
  /** The same with the cage out of place; not the traps, which are as tight as they can be made. */
  shifted: { suppressed: 0.97, kept: 0.97 },
  /** The share of the painted area whose texture is smeared. */
  smear: 0.01,
  /** Of the verdicts with at least this confidence, the share that is right, however far the cage is moved. */
  confidence: { from: 0.9, right: 0.9 },
  /** Made cages, by kind; only models whose parts have names. */
  made: {
    head: { suppressed: 0.995, kept: 0.995, charts: 2 },
    body: { suppressed: 0.995, kept: 0.995, charts: 8 },
    prop: { suppressed: 0.99, kept: 0.98, charts: 10 },
  },
  /** UV overlaps of made cages: a pixel or two at an edge may come from rounding. */
  overlap: 1e-4,
  /** Fitted cages: error of correspondence; the mean over all, and the most that one may have. */
  fitted: {
    head: { mean: { median: 0.011, high: 0.037 }, each: { median: 0.018, high: 0.05 } },
    body: { mean: { median: 0.005, high: 0.02 }, each: { median: 0.007, high: 0.027 } },
  },
  /** Heads with 23 given landmarks: the mean. */
  given: { median: 0.008, high: 0.03 },
  /** How much worse a head without part names may be than the same with. */
  unnamed: { median: 0.002, high: 0.005 },
  /** Of every fitted cage. */
  fit: { cover: 0.85, spill: 0.5, outside: 0.005, folded: 0, angle: 12 },
};

/** Collects what falls short of a goal, a line each. A goal that nothing was measured for, NaN, is missed too. */
class Missed {
  readonly lines: string[] = [];
  atLeast(what: string, value: number, limit: number): void {
    if (!(value >= limit)) this.lines.push(`${what}: ${shown(value)}, goal at least ${shown(limit)}`);
  }
  atMost(what: string, value: number, limit: number): void {
    if (!(value <= limit)) this.lines.push(`${what}: ${shown(value)}, goal at most ${shown(limit)}`);
  }
  both(what: string, { suppressed, kept }: Score, limit: Score): void {
    this.atLeast(`${what}: suppressed`, suppressed, limit.suppressed);
    this.atLeast(`${what}: kept`, kept, limit.kept);
  }
  error(what: string, { median, high }: Spread, limit: Spread): void {
    this.atMost(`${what}: error, median`, median, limit.median);
    this.atMost(`${what}: error, 95th percentile`, high, limit.high);
  }
}

const shown = (value: number): string => (value > 1 ? String(value) : `${(100 * value).toFixed(2)} %`);

/** What falls short of a goal, a line each. Models that are spoiled on purpose need not reach any. */
export function missedGoals(results: Readonly<Record<string, Quality>>): string[] {
  const missed = new Missed();
  for (const [name, { kind, methods, ...quality }] of Object.entries(results)) {
    if (kind === 'spoiled') continue;
    if (kind === 'sample') {
      const ours = methods.default;
      missed.atMost(`${name}, naive: suppressed`, methods.naive.suppressed, kGoals.naive.maxSuppressed);
      missed.both(`${name}, paper`, methods.paper, kGoals.paper);
      missed.both(`${name}, default`, ours, kGoals.sample);
      missed.atMost(`${name}, default: pixels with paint where none must be`, ours.forbidden, kGoals.sample.forbidden);
      missed.atMost(`${name}, default: pixels without paint where it belongs`, ours.bare, kGoals.sample.bare);
    }
    for (const [threshold, value] of Object.entries(quality.thresholds))
      if (Number(threshold) >= kGoals.whole.from && Number(threshold) <= kGoals.whole.to)
        missed.both(`${name}, default at threshold ${threshold}`, value, kGoals.whole);
    for (const [axis, value] of Object.entries(kind === 'trap' ? {} : quality.shifted))
      missed.both(`${name}, default, cage moved by ${shown(kShift)} along ${axis}`, value, kGoals.shifted);
    missed.atMost(`${name}, smeared area`, quality.smear.corner, kGoals.smear);
    missed.atMost(`${name}, smeared area, borders cut`, quality.smear.cut, kGoals.smear);
  }
  const classes = Object.values(results).map(({ confidence }) => confidence);
  rightVerdicts(classes, (from) => from >= kGoals.confidence.from).forEach(({ verdicts, right }, i) => {
    const what = `verdicts with a confidence of ${kGoals.confidence.from} and more, cages moved by ${percent(kShifts[i]!)}: right`;
    missed.atLeast(what, right / verdicts, kGoals.confidence.right);
  });
  return missed.lines;
}

/** The mean of errors. */
export const meanError = (fits: readonly FitScore[]): Spread => ({
  median: mean(fits.map(({ correspondence }) => correspondence.median)),
  high: mean(fits.map(({ correspondence }) => correspondence.high)),
});

/** What falls short of a goal for cages, a line each. */
export function missedCageGoals({ made, fitted, given, failed }: CageResults): string[] {
  const missed = new Missed();
  for (const [name, cage] of Object.entries(made)) {
    if (!cage.isNamed) continue;
    const goal = kGoals.made[cage.kind];
    missed.both(`${name}, made cage`, cage, goal);
    if (cage.verdict === 'unfit') missed.lines.push(`${name}, made cage: unfit`);
    missed.atMost(`${name}, made cage: charts`, cage.charts, goal.charts);
    missed.atMost(`${name}, made cage: UVs that overlap`, cage.overlap, kGoals.overlap);
  }
  for (const kind of ['head', 'body'] as const) {
    const fits = Object.values(fitted).filter((fit) => fit.kind === kind && fit.isNamed);
    if (fits.length > 0) missed.error(`fitted, mean of the kind ${kind}`, meanError(fits), kGoals.fitted[kind].mean);
  }
  const withGiven = Object.values(given);
  if (withGiven.length > 0) missed.error('fitted with 23 landmarks, mean', meanError(withGiven), kGoals.given);
  for (const [name, fit] of Object.entries(fitted)) {
    const what = `${name}, fitted cage`;
    for (const { cover, spill } of fit.eyes.filter((eye) => !Number.isNaN(eye.cover))) {
      missed.atLeast(`${what}: an eye in its hole`, cover, kGoals.fit.cover);
      missed.atMost(`${what}: spill`, spill, kGoals.fit.spill);
    }
    missed.atMost(`${what}: skin outside`, fit.outside, kGoals.fit.outside);
    missed.atMost(`${what}: folded triangles`, fit.folded, kGoals.fit.folded);
    missed.atLeast(`${what}: 5th percentile of angles`, fit.angle, kGoals.fit.angle);
    if (fit.isNamed && fit.kind !== 'prop') missed.error(what, fit.correspondence, kGoals.fitted[fit.kind].each);
    const twin = fitted[name.replace(/_(merged|fused)$/, '')]?.correspondence;
    if (fit.isNamed || twin === undefined) continue;
    const limit = { median: twin.median + kGoals.unnamed.median, high: twin.high + kGoals.unnamed.high };
    missed.error(`${what}, compared with the named`, fit.correspondence, limit);
  }
  return [...failed, ...missed.lines];
}
