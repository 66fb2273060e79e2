import { CagecastError, type SegmentStats } from '../api/index.js';
import { show } from '../core/error.js';

/** Coverages below this count as this. */
const kMin = 0.05;
/** Segments below this share of the exposed area do not count. */
const kMinArea = 1e-4;

/**
 * The threshold that is farthest from the coverage of every segment, so that all verdicts of the threshold are as sure as they can be:
 * in the middle, by ratio, of the widest gap between coverages, of which those below 0.05 count as 0.05.
 *
 * Cost: O(S log S) for S segments.
 *
 * @param segmentStats  Of a result of `transfer` or `project`, with any threshold.
 * @returns a number in 0.05..1, to be passed as `threshold`; 0.5, the default, if nothing of the target is exposed.
 * @throws {CagecastError} `badArgument` if `segmentStats` is not that of a result.
 */
export function surestThreshold(segmentStats: readonly Pick<SegmentStats, 'coverage' | 'exposedArea'>[]): number {
  const isStats =
    Array.isArray(segmentStats) && segmentStats.every((one) => one?.coverage >= 0 && one.exposedArea >= 0);
  if (!isStats)
    throw new CagecastError(
      'badArgument',
      'surestThreshold',
      `segmentStats is ${show(segmentStats)}; pass result.segmentStats of a transfer`,
      { argument: 'segmentStats' },
    );
  const exposed = segmentStats.reduce((sum, { exposedArea }) => sum + exposedArea, 0);
  const coverages = segmentStats
    .filter(({ exposedArea }) => exposedArea > kMinArea * exposed)
    .map(({ coverage }) => Math.max(coverage, kMin));
  if (coverages.length === 0) return 0.5;
  const stops = [kMin, ...coverages].sort((a, b) => a - b);
  let [low, high] = [kMin, kMin];
  stops.slice(1).forEach((to, i) => {
    if (to / stops[i]! > high / low) [low, high] = [stops[i]!, to];
  });
  return Math.sqrt(low * high);
}
