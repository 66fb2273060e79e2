import { type Classification, type Lock, type PresetOptions, presetOptions, Zone } from 'cagecast';
import type { Locks, Rules, Shown } from '../scene/session';
import { diagonalOf } from '../scene/surface';
import type { Rims } from './boundary-loops';
import { type Path, pathOf } from './path';

/** Why a spot of the target is painted, or why not. */
export interface Story {
  /** The reason that the picture shows for its triangle: 0 if that is painted. */
  zone: number;
  /** The corner of the triangle that decided it, and its way to the cage. */
  vertex: number;
  path: Path;
  cageTriangle: number;
  diagonal: number;
  part: PartFacts;
  /** What came of it, in a word, and why, in half a sentence. */
  verdict: string;
  because: string;
  /** The whole story, in the order of the method. */
  steps: { title: string; sentence: string }[];
}

/** The segment of a spot; shares are of 1. */
export interface PartFacts {
  name: string;
  segment: number;
  /** E, of the whole area. */
  exposed: number;
  /** C, of the whole area. */
  covered: number;
  /** F = C / E. */
  coverage: number;
  threshold: number;
  /** How many times what the rules ask of it, threshold and floor, it reaches; infinite if nothing is asked. */
  margin: number;
  passes: boolean;
}

/** What a story is told from. */
export interface Facts {
  shown: Shown;
  classification: Classification;
  rules: Pick<Rules, 'preset' | 'threshold'>;
  locks: Locks;
  rims: Rims;
}

const kVerdicts = ['Painted', 'Not painted: occluded', 'Not painted: uncovered', 'Not painted: culled'];

/**
 * Tells the story of a spot.
 * @param triangle The target's triangle.
 * @param weights  What share each of its corners has in the spot.
 */
export function tell(facts: Facts, triangle: number, weights: readonly number[]): Story {
  const { target, cage, projection } = facts.shown;
  const { zone, vertex } = decidedBy(facts, triangle, weights);
  const cageTriangle = projection.triangles[vertex]!;
  const diagonal = diagonalOf(target.mesh) || 1;
  const options = presetOptions(facts.rules.preset);
  const path = pathOf(target.mesh, cage.mesh, facts.rims, vertex, cageTriangle, diagonal, options);
  const part = partOf(facts, vertex);
  const again = tellAgain(facts, vertex);
  const steps = [
    { title: 'Nearest', sentence: tellPlace(path, cageTriangle, diagonal) },
    { title: 'Ray', sentence: tellRay(facts, path, diagonal) },
    ...(again ? [{ title: 'Again', sentence: again }] : []),
    { title: 'Part', sentence: tellPart(facts, part, options) },
  ];
  return {
    zone,
    vertex,
    path,
    cageTriangle,
    diagonal,
    part,
    verdict: kVerdicts[zone]!,
    because: brief(facts, zone, vertex, path, part),
    steps,
  };
}

/** The reason of a triangle, and of the corners that gave it the one nearest to the spot. */
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

function partOf({ shown, classification, rules }: Facts, vertex: number): PartFacts {
  const segment = shown.projection.segments[vertex]!;
  const stats = classification.segmentStats[segment]!;
  const { area, exposedArea, coveredArea, coverage, group, margin, culled } = stats;
  const pieces = classification.segmentStats.filter((other) => other.group === group && other.area > 0).length;
  const name = `“${shown.target.mesh.parts[group]!.name}”`;
  const of = (value: number): number => (area > 0 ? value / area : 0);
  return {
    name: pieces > 1 ? `a piece of ${name}` : name,
    segment,
    exposed: of(exposedArea),
    covered: of(coveredArea),
    coverage,
    threshold: rules.threshold,
    margin,
    passes: !culled,
  };
}

function tellPlace({ start, place, outside }: Path, cageTriangle: number, diagonal: number): string {
  const away = start.distanceTo(place) / diagonal;
  const side = outside > 0 && away > 0 ? 'The spot lies outside it.' : 'What is painted there goes here.';
  return `Triangle ${cageTriangle.toLocaleString('en')} of the cage is nearest, ${percent(away)} of the model’s diagonal away. ${side}`;
}

function tellRay({ shown }: Facts, { outcome, cage, model, outside }: Path, diagonal: number): string {
  const ray = 'A ray from here, along the normal of that triangle,';
  const far = (length: number): string => percent(Math.max(0, length) / diagonal);
  const what = model && `the model’s own ${nameAt(shown, model.triangle)}`;
  switch (outcome) {
    case 'hidden': {
      const beyond = cage && model!.length > cage.length;
      const before = beyond
        ? ` and ${far(model!.length - cage.length)} beyond the cage, which still counts`
        : ', before it reaches the cage';
      return `${ray} meets ${what} after ${far(model!.length)}${before}: the model lies over it.`;
    }
    case 'covered': {
      const later = model
        ? ` It meets ${what} only ${far(model.length - cage!.length)} beyond the cage: too far out to hide anything.`
        : '';
      return `${ray} meets the cage after ${far(cage!.length)}, and nothing of the model before it.${later}`;
    }
    case 'pokesOut':
      return `${ray} misses the cage, but the spot pokes out of it by no more than ${far(outside)}, which counts as covered.`;
    case 'lost':
      return outside > 0
        ? `${ray} leads away from the cage, outside of which the spot lies: it is not covered.`
        : `${ray} leaves through a hole in the cage: who made it wants no paint here.`;
  }
}

/** What the second look and the rule about holes say of what seemed hidden or uncovered; empty if they were not asked, or had no say. */
function tellAgain({ shown: { projection }, classification }: Facts, vertex: number): string {
  const first = projection.zones[vertex]!;
  const restores = projection.restores[vertex] ?? 0;
  if (first === Zone.Cosmetic || restores === 0) return '';
  const back = classification.zones[vertex] === Zone.Cosmetic;
  if (classification.segmentStats[projection.segments[vertex]!]!.culled)
    return 'A closer look would give it back, were its part not culled.';
  if (first === Zone.Occluded) return 'In other directions it sees the cage freely: the second look gives it back.';
  if (restores === 1) return 'But the edge of the hole is not what is nearest, or hardly overhung: it is given back.';
  return back
    ? 'But the hole is meant for what lies behind it, and not for its rim: that is given back.'
    : 'Nothing that fails lies behind this hole to explain it, so its rim is obeyed.';
}

function tellPart({ classification, locks }: Facts, part: PartFacts, options: PresetOptions): string {
  const { name, segment, coverage, threshold, passes } = part;
  const { area, exposedArea, coveredArea, sunkArea, bared } = classification.segmentStats[segment]!;
  const lock: Lock = locks[segment] ?? 'auto';
  const whole = `It belongs to ${name}.`;
  if (lock !== 'auto')
    return `${whole} You said to ${lock} it, whatever its areas: ${passes ? 'it passes' : 'it is culled'}.`;
  if (exposedArea === 0) return `${whole} Nothing of it is exposed${passes ? '.' : ': it is culled as a whole.'}`;
  const share = `${whole} Of what the model leaves exposed of it, the cage covers ${percent(coverage)}`;
  const enough = coverage >= threshold;
  if (enough && passes) return `${share}, at least the threshold of ${percent(threshold)}: it passes.`;
  if (!enough && !passes) return `${share}, less than the threshold of ${percent(threshold)}: it is culled as a whole.`;
  if (passes)
    return `${share}, less than the threshold of ${percent(threshold)}; but it is judged together with parts that are copies of it, and they pass.`;
  if (bared)
    return `${share}, enough; but a hole of the cage seems to be meant for it: it is small, and much of it lies bare there, or hidden. It is culled as a whole.`;
  const counted = options.floor === 'depth' ? sunkArea * coverage : coveredArea;
  const floor = options.minCovered * area;
  if (counted >= floor)
    return `${share}, enough; but it is judged together with parts that are copies of it, and they do not pass.`;
  const deep =
    options.floor === 'depth' && sunkArea < coveredArea / 2
      ? ' and lies deeper under the cage than its neighbours'
      : '';
  return `${share}, enough; but that is little of it${deep}: it counts for ${percent(counted / area)} of its area where ${percent(options.minCovered)} are asked. It is culled as a whole.`;
}

function brief(
  { shown, classification, locks }: Facts,
  zone: number,
  vertex: number,
  { outcome, model, outside }: Path,
  part: PartFacts,
): string {
  switch (zone) {
    case Zone.Cosmetic:
      if (shown.projection.zones[vertex] !== Zone.Cosmetic)
        return 'it seemed not to be, but a closer look gave it back';
      return outcome === 'pokesOut'
        ? 'it pokes out of the cage a little, which counts as covered'
        : 'the cage is over it and nothing of the model between';
    case Zone.Occluded:
      return model ? `${nameAt(shown, model.triangle)} lies over it` : 'the model lies over it';
    case Zone.Uncovered:
      return outside > 0 ? 'it lies outside the cage' : 'the cage has a hole over it';
    default:
      if (locks[part.segment] === 'exclude') return `you excluded ${part.name}`;
      if (classification.segmentStats[part.segment]!.bared)
        return `a hole of the cage seems to be meant for ${part.name}`;
      return part.coverage < part.threshold
        ? `of ${part.name} the cage covers ${percent(part.coverage)} where ${percent(part.threshold)} are asked`
        : `too little of ${part.name} is covered`;
  }
}

/** The name of the part of the model that a triangle is of. */
function nameAt({ target: { mesh } }: Shown, triangle: number): string {
  return `“${mesh.parts.findLast(({ firstTriangle }) => firstTriangle <= triangle)!.name}”`;
}

/** In two digits, as many as people compare. */
export function percent(share: number): string {
  const value = 100 * share;
  if (value > 0 && value < 0.01) return '< 0.01 %';
  return `${value >= 9.95 ? Math.round(value) : Number(value.toPrecision(2))} %`;
}
