import type { Spread } from '../cages/fit-score.js';
import { mean } from '../cages/measure.js';
import type { CageQuality, FitQuality } from './cages.js';
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
  /** Made cages, by kind; only models whose parts have names. */
  made: {
    head: { suppressed: 0.995, kept: 0.995, charts: 2 },
    body: { suppressed: 0.995, kept: 0.995, charts: 8 },
    prop: { suppressed: 0.99, kept: 0.98, charts: 10 },
  },
  /** UV overlaps of made cages: a pixel or two at an edge may come from rounding. */
  overlap: 1e-4,
  /** Fitted cages: error of correspondence, see `FitScore`; the mean over all, and the most that one may have. */
  fitted: {
    head: { mean: { median: 0.011, most: 0.037 }, each: { median: 0.018, most: 0.05 } },
    body: { mean: { median: 0.005, most: 0.02 }, each: { median: 0.007, most: 0.027 } },
  },
  /** Heads with 23 given landmarks: the mean. */
  given: { median: 0.008, most: 0.03 },
  /** How much worse a head without part names may be than the same with. */
  unnamed: { median: 0.002, most: 0.005 },
  /** Of every fitted cage. */
  fit: { cover: 0.85, spill: 0.5, outside: 0.005, folded: 0, angle: 12 },
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

/** What falls short of a goal for cages, a line each. */
export function missedCageGoals({ made, fitted, given, failed }: CageQuality): string[] {
  const lines = [...failed];
  const expect = (isMet: boolean, line: string): void => {
    if (!isMet) lines.push(line);
  };
  for (const [name, { kind, named, made: cage }] of Object.entries(made)) {
    if (!named) continue;
    const goal = goals.made[kind];
    for (const share of ['suppressed', 'kept'] as const) {
      const line = `${name}, made cage: ${share}: ${percent(cage[share])}, goal at least ${percent(goal[share])}`;
      expect(cage[share] >= goal[share], line);
    }
    expect(cage.verdict !== 'unfit', `${name}, made cage: unfit (${cage.finding})`);
    expect(cage.charts <= goal.charts, `${name}, made cage: ${cage.charts} charts, goal at most ${goal.charts}`);
    expect(cage.overlap <= goals.overlap, `${name}, made cage: ${percent(cage.overlap)} of the UVs overlap`);
  }
  const within = (what: string, { median, most }: Spread, goal: Spread): void =>
    expect(
      median <= goal.median && most <= goal.most,
      `${what}: error ${percent(median)} / ${percent(most)}, goal at most ${percent(goal.median)} / ${percent(goal.most)}`,
    );
  const meanOf = (fits: readonly FitQuality[]): Spread => ({
    median: mean(fits.map(({ correspondence }) => correspondence.median)),
    most: mean(fits.map(({ correspondence }) => correspondence.most)),
  });
  for (const kind of ['head', 'body'] as const) {
    const fits = Object.values(fitted).filter((fit) => fit.kind === kind && fit.named);
    if (fits.length > 0)
      within(`fitted, mean of ${fits.length} of the kind ${kind}`, meanOf(fits), goals.fitted[kind].mean);
  }
  if (Object.keys(given).length > 0)
    within('fitted with 23 landmarks, mean of heads', meanOf(Object.values(given)), goals.given);
  for (const [name, fit] of Object.entries(fitted)) {
    missedFitGoals(`${name}, fitted cage`, fit, expect);
    if (fit.kind !== 'prop' && fit.named)
      within(`${name}, fitted cage`, fit.correspondence, goals.fitted[fit.kind].each);
    const twin = fitted[name.replace(/_(merged|fused)$/, '')];
    if (fit.named || twin === undefined) continue;
    const { median, most } = twin.correspondence;
    const allowed = { median: median + goals.unnamed.median, most: most + goals.unnamed.most };
    within(`${name}, fitted cage, compared with the named`, fit.correspondence, allowed);
  }
  return lines;
}

function missedFitGoals(what: string, fit: FitQuality, expect: (isMet: boolean, line: string) => void): void {
  const { cover, spill, outside, folded, angle } = goals.fit;
  expect(
    !(fit.correspondence.median > fit.similarity.median || fit.correspondence.most > fit.similarity.most),
    `${what}: no better than a similarity of the landmarks`,
  );
  for (const eye of fit.eyes) {
    if (Number.isNaN(eye.cover)) continue;
    expect(eye.cover >= cover, `${what}: ${percent(eye.cover)} of an eye in its hole, goal at least ${percent(cover)}`);
    expect(eye.spill <= spill, `${what}: spill ${percent(eye.spill)}, goal at most ${percent(spill)}`);
  }
  expect(
    fit.outside <= outside,
    `${what}: ${percent(fit.outside)} of the skin outside, goal at most ${percent(outside)}`,
  );
  expect(fit.folded <= folded, `${what}: ${fit.folded} folded triangles`);
  expect(fit.angle >= angle, `${what}: 5th percentile of angles ${fit.angle.toFixed(1)}°, goal at least ${angle}°`);
}
