import type { ClassifyOptions, Locks, SegmentStats } from '../api/index.js';
import { counted, type Finding, type Place, percent } from './finding.js';
import { grouped } from './geometry.js';
import { partsOf, type Scene } from './scene.js';

/** A segment is in doubt if its score is within this factor of 1. */
const kDoubt = 1.25;
/** Segments of a part are reported from this share of the exposed area on. */
const kMinArea = 0.001;
/** From this share of the exposed area on, culling is worth a remark. */
const kMuchCulled = 0.3;
/** At least this share of the exposed area under the cage must be paintable. */
const kMinCosmetic = 0.02;

/** A connected component of the target. */
export interface Segment extends Omit<SegmentStats, 'depth' | 'ratios' | 'score' | 'confidence'> {
  /** Its number in `result.segments`. */
  segment: number;
  /** The part of its first vertex. */
  part: string;
  /** The ratio of actual to required area: kept from 1 on, unless a lock decides. `null` if no area is required. */
  score: number | null;
  /** How sure the verdict is, from 0.5 to 1; as in `SegmentStats`. */
  confidence: number;
}

/** Whether a segment is more than a vertex without a triangle, of which files may have hundreds of thousands. */
export const hasArea = ({ area }: Pick<Segment, 'area'>): boolean => area > 0;

/** The segments in the order of their numbers, with the parts they belong to. */
export function segmentsOf({ parts, result }: Pick<Scene, 'parts' | 'result'>): Segment[] {
  const partOf = partsOf(parts, result.segments.length);
  const partOfSegment = new Uint32Array(result.segmentStats.length);
  for (let v = result.segments.length - 1; v >= 0; --v) partOfSegment[result.segments[v]!] = partOf[v]!;
  return result.segmentStats.map(
    (
      { points, group, area, beyondArea, exposedArea, coveredArea, coverage, score, confidence, culled, culledBy },
      s,
    ) => ({
      segment: s,
      part: parts[partOfSegment[s]!]?.name ?? '',
      group,
      points,
      area,
      beyondArea,
      exposedArea,
      coveredArea,
      coverage,
      score: Number.isFinite(score) ? score : null,
      confidence,
      culled,
      culledBy,
    }),
  );
}

/** A segment, its number, and what the rules have against it. */
type Numbered = Segment & { s: number; ratios: SegmentStats['ratios'] };

/** Reports if too little is painted; and of segments without a lock, if verdicts are close and if much is culled. */
export function checkSegments(
  scene: Scene,
  segments: readonly Segment[],
  { locks = {}, parts: { keep = [], exclude = [] } = {} }: Pick<ClassifyOptions, 'locks' | 'parts'>,
): Finding[] {
  const numbered = segments
    .filter(hasArea)
    .map((segment) => ({ ...segment, s: segment.segment, ratios: scene.result.segmentStats[segment.segment]!.ratios }))
    .sort((a, b) => b.exposedArea - a.exposedArea);
  const exposed = numbered.reduce((sum, { exposedArea }) => sum + exposedArea, 0);
  if (exposed === 0) return [];
  const left = checkLeft(scene, numbered);
  const named = left.flatMap(({ places = [] }) => places.map(({ segment }) => segment));
  const unnamed = numbered.filter((segment) => isOpen(segment) && !named.includes(segment.s));
  return [
    ...left,
    ...checkDoubt(scene, unnamed, exposed),
    ...(left.length > 0 ? [] : checkCulled(numbered.filter(isOpen), exposed)),
  ];

  /** Whether no lock has decided on a segment. */
  function isOpen({ s, group }: Numbered): boolean {
    return (locks[s] ?? 'auto') === 'auto' && !keep.includes(group) && !exclude.includes(group);
  }
}

/** Too little is left to paint. */
function checkLeft({ threshold, areas, sides, result }: Scene, numbered: readonly Numbered[]): Finding[] {
  let [cosmetic, over, cut] = [0, 0, 0];
  for (let v = 0; v < areas.length; ++v) {
    if (result.zones[v] === 1 || sides.areUnder[v] === 0) continue;
    over += areas[v]!;
    if (result.zones[v] === 0) cosmetic += areas[v]!;
    if (result.zones[v] === 3) cut += areas[v]!;
  }
  const share = over > 0 ? cosmetic / over : 0;
  if (share >= kMinCosmetic) return [];
  const only =
    cosmetic === 0 ? 'No part of the target' : `Only ${percent(share)} of the target's exposed area under the cage`;
  const largest = cut > 0.5 * over ? numbered.find(({ culled }) => culled) : undefined;
  return [
    {
      code: 'nothingToPaint',
      weight: 2,
      sentence: largest
        ? `${only} may be painted: the cage covers ${percent(largest.coverage)} of the exposed area of "${largest.part}", ${reason(largest, threshold)}`
        : `${only} may be painted`,
      advice:
        largest?.culledBy === 'lock'
          ? `Exclude less than all of "${largest.part}".`
          : largest
            ? `If the cage should cover only a region of "${largest.part}", override this or make that region a mesh of its own. Otherwise extend the cage.`
            : 'The other findings and the zones show the reason; uncovered vertices, for example, have no cage over them.',
      numbers: { share, culled: over > 0 ? cut / over : 0 },
      ...(largest && { places: [placeOfSegment(largest.s, largest)], locks: locksFor([largest]) }),
    },
  ];
}

/** Parts with scores near 1, reported separately for painted and culled segments. */
function checkDoubt({ threshold }: Scene, numbered: readonly Numbered[], exposed: number): Finding[] {
  const doubtful = numbered.filter(({ score }) => score !== null && score > 1 / kDoubt && score < kDoubt);
  return grouped(doubtful, ({ group, part, culled }) => `${group} ${culled} ${part}`).flatMap((alike): Finding[] => {
    const [largest] = alike;
    const area = alike.reduce((sum, { exposedArea }) => sum + exposedArea, 0) / exposed;
    if (area < kMinArea) return [];
    const { part, culled } = largest;
    const one = alike.length === 1 ? `"${part}"` : `${alike.length} segments of "${part}"`;
    const is = alike.length === 1 ? 'is' : 'are';
    return [
      {
        code: 'segmentInDoubt',
        weight: Math.min(0.9, 0.2 + 2 * area),
        sentence: `${one} ${is} ${culled ? 'not painted' : 'painted'}, but only just: ${alike.length === 1 ? 'its coverage is' : 'the largest has a coverage of'} ${shownCoverage(largest, threshold)}, ${reason(largest, threshold)} (${percent(area)} of the target's exposed area)`,
        advice: `If that is wrong, override it, or widen or close the holes over ${alike.length === 1 ? 'it' : 'them'}.`,
        numbers: { segments: alike.length, area, score: largest.score! },
        places: alike.map((segment) => placeOfSegment(segment.s, segment)),
        locks: locksFor(alike),
      },
    ];
  });
}

/** Much of the exposed area is not painted. */
function checkCulled(numbered: readonly Numbered[], exposed: number): Finding[] {
  const all = numbered.filter(({ culled, exposedArea }) => culled && exposedArea > 0);
  const share = all.reduce((sum, { exposedArea }) => sum + exposedArea, 0) / exposed;
  if (share <= kMuchCulled) return [];
  const largest = all[0]!;
  return [
    {
      code: 'muchCulled',
      weight: 0.2,
      sentence: `${percent(share)} of the target's exposed area is culled, in ${counted(all.length, 'exposed segment')}; the largest belongs to "${largest.part}"`,
      advice: `If some of it should be painted, override this, or close the holes of the cage over it.`,
      numbers: { share },
      places: all
        .filter(({ exposedArea }) => exposedArea >= kMinArea * exposed)
        .map((segment) => placeOfSegment(segment.s, segment)),
      locks: locksFor([largest]),
    },
  ];
}

/** A coverage for people. Rounding does not take it to the threshold that it is below. */
function shownCoverage({ coverage, culled }: Segment, threshold: number): string {
  const rounded = coverage.toFixed(2);
  return culled && Number(rounded) >= threshold ? (Math.floor(100 * coverage) / 100).toFixed(2) : rounded;
}

/** Why a segment is culled or kept, as the end of a sentence about its coverage. */
function reason({ ratios, culled, culledBy, score }: Numbered, threshold: number): string {
  if (culledBy === 'lock') return 'but it is excluded by choice';
  if (culledBy === 'hole') return 'but a hole of the cage seems to be meant for it';
  if (score === null) return 'and no area is required';
  if (culled ? ratios.threshold < 1 : ratios.threshold === score)
    return culled ? `less than the threshold of ${threshold}` : `and the threshold is ${threshold}`;
  if (ratios.depth === score)
    return `${culled ? 'but' : 'and'} it lies ${culled ? 'too' : 'nearly too'} deep under the cage`;
  if (ratios.hole === score) return 'and much of it lies in a hole of the cage';
  return `and it has ${score.toPrecision(2)} times the required covered area`;
}

/** Where a segment is. */
export const placeOfSegment = (segment: number, { group, part }: Segment): Place => ({ segment, group, part });

const locksFor = (segments: readonly Numbered[]): Locks =>
  Object.fromEntries(segments.map(({ s, culled }) => [s, culled ? 'keep' : 'exclude']));
