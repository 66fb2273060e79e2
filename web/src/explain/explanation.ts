import { type Classification, type Projection, presetOptions, Visibility, Zone } from 'cagecast';
import type { Locks, Rules } from '../state/choices';
import { withoutParts } from '../state/left-out';
import type { Shown } from '../state/scene';
import { diagonalOf } from '../state/surface';
import type { BoundaryLoops } from './boundary-loops';
import { type Path, pathOf } from './path';

/** Why a spot of the target is painted or not. */
export interface Explanation {
  /** The zone of its triangle, as shown in the view; 0 if painted. */
  zone: number;
  /** The corner that decided the triangle's zone, and its path to the cage. */
  vertex: number;
  path: Path;
  cageTriangle: number;
  diagonal: number;
  part: SegmentFacts;
  /** The result in a word or two, and its reason as half a sentence. */
  verdict: string;
  because: string;
  /** One entry per step of the method, in order. */
  steps: { title: string; sentence: string }[];
}

/** The segment of a spot; shares are 0..1. */
export interface SegmentFacts {
  name: string;
  segment: number;
  /** Exposed share of the area (E). */
  exposed: number;
  /** Covered share of the area (C). */
  covered: number;
  /** F = C / E. */
  coverage: number;
  threshold: number;
  /** Kept from 1 on; infinite if nothing is required. */
  score: number;
  passes: boolean;
}

/** What an explanation is derived from. */
interface Facts {
  shown: Shown;
  classification: Classification;
  rules: Pick<Rules, 'preset' | 'threshold'>;
  locks: Locks;
  /** As in the session. */
  bare?: Uint8Array | undefined;
  loops: BoundaryLoops;
}

const kBeyond = 'it lies beyond the border of the cage, which says nothing of it';

const kVerdicts = ['Painted', 'Not painted: occluded', 'Not painted: uncovered', 'Not painted: culled'];

/**
 * Explains a spot.
 * @param triangle A triangle of the target.
 * @param weights  The barycentric weights of the spot in it.
 */
export function explain(facts: Facts, triangle: number, weights: readonly number[]): Explanation {
  const { target, cage, projection } = facts.shown;
  const { zone, vertex } = decidedBy(facts, triangle, weights);
  const cageTriangle = projection.triangles[vertex]!;
  const diagonal = diagonalOf(target.mesh) || 1;
  const options = presetOptions(facts.rules.preset);
  const path = pathOf(
    { target: withoutParts(target, projection).mesh, cage: cage.mesh, loops: facts.loops },
    { vertex, triangle: cageTriangle, diagonal },
    options,
  );
  const part = segmentOf(facts, vertex);
  const isBeyond = projection.visibility[vertex] === Visibility.Beyond;
  const isMarked = facts.bare?.[triangle] === 1;
  const steps = [
    ...(isMarked
      ? [{ title: 'Marked', sentence: 'You marked this spot: it stays bare, whatever the rules say.' }]
      : []),
    { title: 'Closest', sentence: closestStep(path, cageTriangle, diagonal) },
    ...(isBeyond
      ? [
          {
            title: 'Border',
            sentence:
              'The cage covers a part of the model only. The spot lies beyond its border, and it says nothing of that.',
          },
        ]
      : [{ title: 'Ray', sentence: rayStep(facts, path, diagonal) }, ...recoveryStep(facts, vertex)]),
    { title: 'Part', sentence: partStep(facts, part) },
  ];
  return {
    zone,
    vertex,
    path,
    cageTriangle,
    diagonal,
    part,
    verdict: isMarked
      ? 'Not painted: marked'
      : isBeyond && zone === Zone.Uncovered
        ? 'Not painted: beyond the cage'
        : kVerdicts[zone]!,
    because: isMarked ? 'you marked this spot to stay bare' : brief(facts, zone, vertex, path, part),
    steps,
  };
}

/** The zone of a triangle and, of the corners with that zone, the one closest to the spot. */
function decidedBy(
  { shown, classification }: Facts,
  triangle: number,
  weights: readonly number[],
): { zone: number; vertex: number } {
  const { indices } = shown.target.mesh;
  const corners = [0, 1, 2].map((corner) => ({ vertex: indices[3 * triangle + corner]!, weight: weights[corner]! }));
  const zoneOf = ({ vertex }: { vertex: number }): number => classification.zones[vertex]!;
  const zone = classification.cosmeticTriangles[triangle] === 1 ? Zone.Cosmetic : Math.max(...corners.map(zoneOf));
  const deciding = corners.filter((corner) => zoneOf(corner) === zone);
  return { zone, vertex: deciding.reduce((best, corner) => (corner.weight > best.weight ? corner : best)).vertex };
}

/** What to call a segment. */
function nameOf({ shown, classification }: Facts, segment: number): string {
  const { group } = classification.segmentStats[segment]!;
  const pieces = classification.segmentStats.filter((other) => other.group === group && other.area > 0).length;
  const name = `“${shown.target.mesh.primitives[group]!.name}”`;
  return pieces > 1 ? `a piece of ${name}` : name;
}

function segmentOf(facts: Facts, vertex: number): SegmentFacts {
  const { shown, classification, rules } = facts;
  const segment = shown.projection.segments[vertex]!;
  const stats = classification.segmentStats[segment]!;
  const { area, exposedArea, coveredArea, coverage, score, culled } = stats;
  const of = (value: number): number => (area > 0 ? value / area : 0);
  return {
    name: nameOf(facts, segment),
    segment,
    exposed: of(exposedArea),
    covered: of(coveredArea),
    coverage,
    threshold: rules.threshold,
    score,
    passes: !culled,
  };
}

function closestStep({ start, closest, outside }: Path, cageTriangle: number, diagonal: number): string {
  const distance = start.distanceTo(closest) / diagonal;
  const side = outside > 0 && distance > 0 ? 'The spot lies outside the cage.' : 'The spot takes its paint from there.';
  return `The closest cage triangle is number ${cageTriangle.toLocaleString('en')}, ${percent(distance)} of the model’s diagonal away. ${side}`;
}

function rayStep({ shown }: Facts, { outcome, cage, model, outside }: Path, diagonal: number): string {
  const ray = 'A ray from here along the normal of that triangle';
  const far = (length: number): string => percent(Math.max(0, length) / diagonal);
  const what = model && `the model’s own ${nameAt(shown, model.triangle)}`;
  switch (outcome) {
    case 'hidden': {
      const beyond = cage && model!.length > cage.length;
      const before = beyond
        ? `, ${far(model!.length - cage.length)} beyond the cage, which still counts`
        : ', before it reaches the cage';
      return `${ray} meets ${what} after ${far(model!.length)}${before}: the model covers this spot.`;
    }
    case 'covered': {
      const later = model
        ? ` It meets ${what} only ${far(model.length - cage!.length)} beyond the cage, too far away to count.`
        : '';
      return `${ray} meets the cage after ${far(cage!.length)}, with nothing of the model before it.${later}`;
    }
    case 'pokesOut':
      return `${ray} misses the cage, but the spot pokes out of it by only ${far(outside)}, which counts as covered.`;
    case 'lost':
      return outside > 0
        ? `${ray} leads away from the cage: the spot lies outside the cage and is not covered.`
        : `${ray} leaves through a hole in the cage, where no paint is wanted.`;
  }
}

/** The segments that hide a vertex, besides its own. */
function hidersOf({ hiddenBy, hiders }: Projection, vertex: number): number[] {
  const segments = new Set<number>();
  for (let record = hiddenBy[vertex] ?? 0; record !== 0; record = hiders[record]!) {
    let at = record + 3;
    for (let rays = hiders[record + 2]!; rays > 0; --rays) {
      const end = at + 1 + hiders[at]!;
      for (const segment of hiders.subarray(at + 1, end)) segments.add(segment);
      at = end;
    }
  }
  return [...segments];
}

/** The outcome of the recheck of an occluded vertex, or of the rule for holes of an uncovered one; none if they do not apply. */
function recoveryStep(facts: Facts, vertex: number): Explanation['steps'] {
  const { shown, classification } = facts;
  const { projection } = shown;
  const first = projection.visibility[vertex]!;
  const recovery = projection.recovery[vertex] ?? 0;
  if (first === Visibility.Covered || recovery === 0) return [];
  const isCulled = classification.segmentStats[projection.segments[vertex]!]!.culled;
  const isHidden = first === Visibility.Occluded;
  const painted = hidersOf(projection, vertex).filter((segment) => !classification.segmentStats[segment]!.culled);
  const isCosmetic = classification.zones[vertex] === Zone.Cosmetic;
  const sentence = isCulled
    ? 'It would be recovered, but its part is culled.'
    : isHidden && projection.hiddenBy[vertex]
      ? isCosmetic
        ? hidersOf(projection, vertex).length === 0
          ? 'It comes into view when the face moves, so it is recovered.'
          : 'What hides it stays bare itself and hides nothing, so it is recovered.'
        : painted.length > 0
          ? `It is hidden by ${nameOf(facts, painted[0]!)}, which is painted.`
          : 'What hides it stays bare itself, but it lies under a hole of the cage that no unpainted part explains.'
      : isHidden
        ? 'Rays in other directions reach the cage, so it is recovered.'
        : recovery === 1
          ? 'It is hardly beyond a hole, if at all, so it is recovered.'
          : isCosmetic
            ? 'The hole is meant for the part behind it, not for this spot, so it is recovered.'
            : 'No unpainted part lies behind this hole, so it stays bare.';
  return [{ title: isHidden ? 'Recheck' : 'Hole', sentence }];
}

function partStep({ classification, locks }: Facts, part: SegmentFacts): string {
  const { name, segment, coverage, threshold, passes } = part;
  const { area, beyondArea, exposedArea, coveredArea, depth, ratios } = classification.segmentStats[segment]!;
  const lock = locks[segment] ?? 'auto';
  const whole = `It belongs to ${name}.`;
  if (lock === 'always') return `${whole} You chose to paint all of it anyway.`;
  if (lock !== 'auto')
    return `${whole} You chose to ${lock} it, regardless of its areas: it ${passes ? 'passes' : 'is culled'}.`;
  if (exposedArea === 0 && beyondArea > 0) return `${whole} Nothing of it is exposed but what lies beyond the cage.`;
  if (exposedArea === 0) return `${whole} Nothing of it is exposed${passes ? '.' : ', so it is culled as a whole.'}`;
  const share = `${whole} The cage covers ${percent(coverage)} of its exposed area`;
  if (passes) return `${share}, at least the threshold of ${percent(threshold)}: it passes.`;
  if (ratios.threshold < 1)
    return `${share}, less than the threshold of ${percent(threshold)}: it is culled as a whole.`;
  const why =
    ratios.floor < 1
      ? `the covered area is small, ${percent(coveredArea / area)} of the whole area. It is ${percent(ratios.floor)} of what is required`
      : ratios.depth < 1
        ? `it is small and lies ${percent(depth)} of the model’s diagonal beneath the cage. At most ${percent(depth * ratios.depth)} is allowed here`
        : 'it is small, and much of it is hidden or lies under a hole of the cage, which therefore seems to be meant for it';
  return `${share}, which is enough. But ${why}. It is culled as a whole.`;
}

function brief(
  { shown, classification, locks }: Facts,
  zone: number,
  vertex: number,
  { outcome, model, outside }: Path,
  part: SegmentFacts,
): string {
  switch (zone) {
    case Zone.Cosmetic:
      if (locks[part.segment] === 'always') return `you chose to paint ${part.name} anyway`;
      if (shown.projection.visibility[vertex] === Visibility.Occluded)
        return shown.projection.hiddenBy[vertex]
          ? hidersOf(shown.projection, vertex).length === 0
            ? 'it comes into view when the face moves'
            : 'only what stays bare itself lies over it'
          : 'it seemed hidden, but rays in other directions reach the cage';
      if (shown.projection.visibility[vertex] === Visibility.Uncovered)
        return 'it seemed uncovered, but the rule for holes recovers it';
      return outcome === 'pokesOut'
        ? 'it pokes out of the cage a little, which counts as covered'
        : 'the cage covers it, and nothing of the model lies between';
    case Zone.Occluded:
      return model ? `${nameAt(shown, model.triangle)} lies over it` : 'the model lies over it';
    case Zone.Uncovered:
      if (shown.projection.visibility[vertex] === Visibility.Beyond) return kBeyond;
      return outside > 0 ? 'it lies outside the cage' : 'the cage has a hole over it';
    default: {
      if (locks[part.segment] === 'exclude') return `you chose to keep ${part.name} bare`;
      const { culledBy, group } = classification.segmentStats[part.segment]!;
      if (culledBy === 'lock') {
        const isWorn = shown.target.mesh.accessories.includes(group);
        const why = isWorn ? `${part.name} is worn or carried, by its name` : `the cage was made without ${part.name}`;
        return `${why}; choose “keep” to paint it`;
      }
      if (culledBy === 'hole') return `a hole of the cage seems to be meant for ${part.name}`;
      return part.coverage < part.threshold
        ? `the cage covers ${percent(part.coverage)} of the exposed area of ${part.name}, less than the threshold of ${percent(part.threshold)}`
        : `too little of ${part.name} is covered`;
    }
  }
}

/** The name of the mesh that a triangle belongs to. */
function nameAt({ target: { mesh } }: Shown, triangle: number): string {
  return `“${mesh.primitives.findLast(({ firstTriangle }) => firstTriangle <= triangle)!.name}”`;
}

/** With two significant digits. */
export function percent(share: number): string {
  const value = 100 * share;
  if (value > 0 && value < 0.01) return '< 0.01 %';
  return `${value >= 9.95 ? Math.round(value) : Number(value.toPrecision(2))} %`;
}
