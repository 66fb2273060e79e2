import type { SegmentStats } from '../api/index.js';

/** Coverages below this count as this. */
const kMin = 0.05;
/** Segments below this share of the exposed area do not count. */
const kMinArea = 1e-4;

/** The middle, by ratio, of the widest gap between the coverages of segments; 0.5 if nothing is exposed. Cost: O(S log S) for S segments. */
export function surestThreshold(segmentStats: readonly Pick<SegmentStats, 'coverage' | 'exposedArea'>[]): number {
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
