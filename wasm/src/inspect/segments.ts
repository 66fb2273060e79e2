import { percent, type Finding } from './finding.js';
import { partsOf } from './holes.js';
import type { Scene } from './scene.js';

/** A segment whose coverage is this near to the threshold could as well be decided the other way. */
const near = 0.1;
/** Of at least this share of the exposed area. */
const leastArea = 0.001;
/** From this share of the exposed area on, culling is worth a remark. */
const muchCulled = 0.3;
/** The least of what is exposed that must be paintable. */
const leastCosmetic = 0.02;

/** A connected component of the target. */
export interface Segment {
  /** The part that it begins in. */
  part: string;
  points: number;
  /** E and C, in squared units of the input, and F = C/E. */
  exposedArea: number;
  coveredArea: number;
  coverage: number;
  culled: boolean;
}

/** The segments in the order of their numbers, with the parts they belong to. */
export function segmentsOf({ parts, result }: Scene): Segment[] {
  const partOf = partsOf(parts, result.segments.length);
  const partOfSegment = new Uint32Array(result.segmentStats.length);
  for (let v = result.segments.length - 1; v >= 0; --v) partOfSegment[result.segments[v]!] = partOf[v]!;
  return result.segmentStats.map(({ points, exposedArea, coveredArea, coverage, culled }, s) => ({
    part: parts[partOfSegment[s]!]?.name ?? '',
    points,
    exposedArea,
    coveredArea,
    coverage,
    culled,
  }));
}

/** Segments that the threshold barely decides, and what is left to paint. */
export function checkSegments({ threshold, areas, result }: Scene, segments: readonly Segment[]): Finding[] {
  const findings: Finding[] = [];
  const exposed = segments.reduce((sum, { exposedArea }) => sum + exposedArea, 0);
  let cosmetic = 0;
  for (let v = 0; v < areas.length; ++v) if (result.zones[v] === 0) cosmetic += areas[v]!;
  const share = exposed > 0 ? cosmetic / exposed : 0;
  if (share < leastCosmetic) {
    findings.push({
      code: 'nothingToPaint',
      weight: 2,
      sentence: cosmetic === 0 ? 'Nothing of the target may be painted' : `Only ${percent(share)} of what is exposed of the target may be painted`,
      advice: 'See the other findings and the zones for the reason: uncovered means that the cage is not over it, culled that too little of a segment is covered.',
      numbers: { share },
    });
  }
  const doubtful = segments.filter(({ coverage, exposedArea }) => Math.abs(coverage - threshold) < near && exposedArea >= leastArea * exposed && exposedArea > 0);
  if (doubtful.length > 0) {
    const area = doubtful.reduce((sum, { exposedArea }) => sum + exposedArea, 0) / exposed;
    const names = [...new Set(doubtful.map(({ part, coverage }) => `"${part}" (F = ${coverage.toFixed(2)})`))];
    findings.push({
      code: 'segmentNearThreshold',
      weight: Math.min(0.9, 0.2 + 2 * area),
      sentence: `${doubtful.length === 1 ? 'A segment lies' : `${doubtful.length} segments lie`} near the threshold of ${threshold}: ${names.slice(0, 4).join(', ')}${names.length > 4 ? ', …' : ''}; ${percent(area)} of the exposed area`,
      advice: 'Look whether they are painted as they should be; widen or close the holes over them, or choose another threshold.',
      numbers: { segments: doubtful.length, area },
    });
  }
  const culled = segments.reduce((sum, segment) => sum + (segment.culled ? segment.exposedArea : 0), 0);
  if (exposed > 0 && culled > muchCulled * exposed && share >= leastCosmetic) {
    findings.push({
      code: 'muchCulled',
      weight: 0.2,
      sentence: `${percent(culled / exposed)} of what is exposed of the target is culled, as too little of its segments is covered`,
      advice: 'If some of it should be painted, close the holes of the cage over it, or lower the threshold.',
      numbers: { share: culled / exposed },
    });
  }
  return findings;
}
