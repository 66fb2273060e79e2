import type { Mesh, SegmentStats, TransferResult } from '../api/index.js';
import { percent } from './finding.js';
import { boxOf, cross, dot, doubleAreaNormal, minus, pointAt, type Vector, vertexAreas } from './geometry.js';
import { type PartName, partsOf } from './scene.js';

/** From this share of what the cage covers on, what may be painted is worth no word. */
const kEnough = 0.05;
/** A cage that lies over less than this share of a target is elsewhere; a face is a hundredth of a body. */
const kMinBeneath = 0.002;
/** Up to these distances, as shares of the diagonal, what is hidden is meant to be painted, and what is uncovered. */
const kHiddenReach = 0.15;
const kUncoveredReach = 0.03;
/** How many hidden vertices are asked for what hides them. */
const kMaxAsked = 48;

/** Factors between units: centimetres or millimetres, and metres. How far a cage may be off them, as it may be that of a part. */
const kUnits = [100, 1000];
const kMaxOff = 2;

type Cause =
  | 'units'
  | 'exchanged'
  | 'elsewhere'
  | 'uncovered'
  | 'hidden'
  | 'threshold'
  | 'floor'
  | 'depth'
  | 'hole'
  | 'lock'
  | 'mask';

/** Why next to nothing may be painted, or all as by chance. */
export interface Bare {
  /** The painted share of what the cage covers. */
  share: number;
  /** What keeps most of the rest unpainted. */
  cause: Cause;
  /** The part that has most of that. */
  part: string;
  /** The part that hides it, if one does. */
  hider: string;
  /** How much of its exposed area the cage covers. */
  coverage: number;
  /** How many times as large as the target the cage is. */
  times: number;
}

/**
 * Finds out why nothing, or less than 5 % of what the cage covers, may be painted, or whether the cage is in another unit;
 * `undefined` otherwise. Cost: linear in the triangles; where that is hidden, some 50 times as much.
 * @param cage  As it was given. Default: it is not known, and so not whether it was exchanged with the target.
 */
export function bareOf(
  target: Mesh,
  { zones, distances, segments, segmentStats }: TransferResult,
  parts: readonly PartName[],
  cage?: Mesh,
): Bare | undefined {
  const areas = vertexAreas(target);
  const { diagonal } = boxOf(target.positions);
  const isWithin = (v: number, reach: number) => distances[v]! <= reach * diagonal;
  let [painted, hidden, uncovered, culled, total] = [0, 0, 0, 0, 0];
  for (let v = 0; v < areas.length; ++v) {
    total += areas[v]!;
    if (zones[v] === 0) painted += areas[v]!;
    if (zones[v] === 1 && isWithin(v, kHiddenReach)) hidden += areas[v]!;
    if (zones[v] === 2 && isWithin(v, kUncoveredReach)) uncovered += areas[v]!;
    if (zones[v] === 3) culled += areas[v]!;
  }
  const beneath = painted + hidden + culled;
  const share = beneath > 0 ? painted / beneath : 0;
  const times = cage ? boxOf(cage.positions).diagonal / diagonal : 1;
  const isNear = (of: number) => Math.abs(Math.log(times / of)) < Math.log(kMaxOff);
  // A large cage paints all that is in it. A small one that does may be meant for a detail.
  const isOfUnits = kUnits.some((unit) => isNear(unit) || (share < kEnough && isNear(1 / unit)));
  if (share >= kEnough && !isOfUnits) return undefined;
  const isElsewhere = beneath + uncovered <= kMinBeneath * total;
  const most = Math.max(hidden, uncovered, culled);
  const zone = isElsewhere || most === uncovered ? 2 : most === hidden ? 1 : 3;
  const concerned = [...areas.keys()].filter((v) => zones[v] === zone);
  const partOf = partsOf(parts, areas.length);
  const largest = (of: ArrayLike<number>) =>
    heaviest(
      concerned,
      (v) => of[v]!,
      (v) => areas[v]!,
    );
  const stats = segmentStats[largest(segments)];
  const part = largest(partOf);
  const ofPart = (v: number): boolean => partOf[v] === part;
  const hider = zone === 1 ? hiderOf(target, concerned.filter(ofPart), partOf) : undefined;
  return {
    share,
    times,
    cause: isOfUnits
      ? 'units'
      : share === 0 && cage && areExchanged(cage, target)
        ? 'exchanged'
        : isElsewhere
          ? 'elsewhere'
          : zone === 2
            ? 'uncovered'
            : zone === 1
              ? 'hidden'
              : causeOf(stats),
    part: parts[part]?.name ?? '',
    hider: parts[hider ?? -1]?.name ?? '',
    coverage: stats?.coverage ?? 0,
  };
}

/** Whether a cage seems to be the target: it has more triangles than that, and lies within its box. */
function areExchanged(cage: Mesh, target: Mesh): boolean {
  const [inner, outer] = [boxOf(cage.positions), boxOf(target.positions)];
  const isWithin = inner.min.every((low, k) => low >= outer.min[k]! && inner.max[k]! <= outer.max[k]!);
  return cage.indices.length > target.indices.length && isWithin;
}

/** Which rule culls a segment. */
function causeOf(stats: SegmentStats | undefined): Cause {
  if (!stats || stats.culledBy === 'none' || stats.culledBy === 'ignore') return 'mask';
  if (stats.culledBy !== 'coverage') return stats.culledBy;
  const { threshold, floor, depth } = stats.ratios;
  return threshold < 1 ? 'threshold' : depth < floor ? 'depth' : 'floor';
}

/** The number that stands for the most, by weight; -1 for none. */
function heaviest(items: readonly number[], of: (item: number) => number, weight: (item: number) => number): number {
  const sums = new Map<number, number>();
  for (const item of items) sums.set(of(item), (sums.get(of(item)) ?? 0) + weight(item));
  return [...sums].reduce((best, one) => (one[1] > best[1] ? one : best), [-1, -1])[0];
}

/** The part that hides most of some vertices, if others than their own do: the first on the way out from each. */
function hiderOf({ positions, indices }: Mesh, hidden: readonly number[], partOf: Uint32Array): number | undefined {
  const step = Math.ceil(hidden.length / kMaxAsked);
  const asked = hidden.filter((_, i) => i % step === 0);
  const corner = (t: number, k: number) => pointAt(positions, indices[3 * t + k]!);
  const triangles = Array.from({ length: indices.length / 3 }, (_, t) => t);
  const normals = new Map(asked.map((v): [number, [number, number, number]] => [v, [0, 0, 0]]));
  for (const t of triangles)
    for (let k = 0; k < 3; ++k) {
      const normal = normals.get(indices[3 * t + k]!);
      if (!normal) continue;
      doubleAreaNormal(corner(t, 0), corner(t, 1), corner(t, 2)).forEach((x, axis) => (normal[axis]! += x));
    }
  const found = asked.flatMap((v) => {
    const [from, way] = [pointAt(positions, v), normals.get(v)!];
    let [nearest, by] = [Infinity, -1];
    for (const t of triangles) {
      if (partOf[indices[3 * t]!] === partOf[v]) continue;
      const distance = hitAt(from, way, corner(t, 0), corner(t, 1), corner(t, 2));
      if (distance < nearest) [nearest, by] = [distance, partOf[indices[3 * t]!]!];
    }
    return by < 0 ? [] : [by];
  });
  return found.length > asked.length / 2
    ? heaviest(
        found,
        (p) => p,
        () => 1,
      )
    : undefined;
}

/** How far along a way a triangle is hit, from either side; infinite if it is not. */
function hitAt(from: Vector, way: Vector, a: Vector, b: Vector, c: Vector): number {
  const [ab, ac, o] = [minus(b, a), minus(c, a), minus(from, a)];
  const [p, q] = [cross(way, ac), cross(o, ab)];
  const scale = dot(ab, p);
  const [u, v, t] = [dot(o, p) / scale, dot(way, q) / scale, dot(ac, q) / scale];
  return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : Infinity;
}

const rounded = (times: number) => Number(times.toPrecision(2));

/** What to do about each cause, by the names of options. */
const kAdvice: Record<Cause, string> = {
  units: 'give both in the same unit',
  exchanged: 'exchange them',
  elsewhere: 'put both in the same place and unit',
  uncovered: 'fit the cage around it',
  hidden:
    'leave out what hides it, or set a smaller occlusionReach if that lies outside the cage; inspect() says whether the cage fits',
  threshold: 'set a lower threshold, or a lock that keeps it',
  floor: 'set a lower minCovered, or a lock that keeps it',
  depth: 'fit the cage more closely, or set a lock that keeps it',
  hole: 'set a lock that keeps it',
  lock: 'lift the lock',
  mask: 'change the masks',
};

/** Says in one line why next to nothing may be painted, and what helps. @param advice  What to do, if not by names of options. */
export function bareText({ share, cause, part, hider, coverage, times }: Bare, advice = kAdvice[cause]): string {
  const whole = `"${part}"`;
  const why: Record<Cause, string> = {
    units: `${times > 1 ? `the cage is ${rounded(times)}` : `the target is ${rounded(1 / times)}`} times as large as the ${times > 1 ? 'target' : 'cage'}, as in another unit`,
    exchanged: 'target and cage seem to be exchanged',
    elsewhere: 'the cage lies over next to none of the target',
    uncovered: `most of ${whole} lies outside the cage, or under a hole of it`,
    hidden: `most of ${whole} is hidden by ${hider ? `"${hider}"` : 'other surfaces'}`,
    threshold: `the cage covers only ${percent(coverage)} of the exposed area of ${whole}`,
    floor: `the cage covers too little of ${whole}`,
    depth: `${whole} lies too deep under the cage`,
    hole: `a hole of the cage seems to be meant for ${whole}`,
    lock: `${whole} is excluded by choice`,
    mask: `masks exclude ${whole}`,
  };
  if (share >= kEnough) return `${why[cause]}; ${advice}`;
  const what = share === 0 ? 'nothing' : `only ${percent(share)} of what the cage covers`;
  return `${what} may be painted: ${why[cause]}; ${advice}`;
}

/** `bareText` of what `bareOf` finds, for callers that give options by their names. */
export function noteOf(...args: Parameters<typeof bareOf>): string | undefined {
  const bare = bareOf(...args);
  return bare && bareText(bare);
}
