import type { Vector } from './affine.js';
import { type FaceMotion, mayHaveLips, motionOf } from './morph-names.js';
import { type MorphedPart, movesOf } from './poses.js';

/** Where vertices are, and where a motion moves them: 3 numbers each. */
interface Moving {
  positions: Float32Array;
  by: Float32Array;
}
/** What the targets of one name do to all parts. */
type Motion = readonly Moving[];

interface Moved {
  at: Vector;
  by: Vector;
}

/** What moves less than this share of the farthest is not what a motion is about. */
const kClearly = 0.5;
/** The corners of lids hardly move: an eye ends where this share of the farthest is moved. */
const kCorner = 0.1;
/** The middles of two eyes are at least so many of their widths apart. */
const kApart = 1.15;
/** At rest, lips are this near to each other, in shares of how far a mouth opens; then they part by at least that. */
const kLipsNear = 0.2;
const kLipsPart = 0.3;
/** The share of a mouth's width that is a corner of it. */
const kEnd = 0.1;
/** Enough vertices to find a mouth by. */
const kMaxMoved = 2000;

/**
 * Where a face is, by what its morph targets move: landmarks `eye_inner_*`, `eye_outer_*`, `mouth_corner_*`, and `mouth`, the middle
 * between the lips. Empty where no name says what a target does. Right is where x is less.
 */
export function faceHints(parts: readonly MorphedPart[]): Record<string, Vector> {
  const found: Record<FaceMotion, Map<string, Moving[]>> = {
    closesEyes: new Map(),
    opensMouth: new Map(),
    narrowsMouth: new Map(),
  };
  for (const part of parts)
    for (const target of part.targets) {
      const motion = motionOf(target.names);
      if (motion === undefined || (motion !== 'closesEyes' && !mayHaveLips(part.names))) continue;
      const deltas = target.deltas();
      if (!deltas || deltas.length < part.positions.length) continue;
      const name = String(target.names.find((one) => one));
      found[motion].set(name, [...(found[motion].get(name) ?? []), movingOf(part, deltas)]);
    }
  const [blinks, openings, narrowings] = Object.values(found).map((motions) => [...motions.values()]);
  const hints = { ...eyesOf(blinks!), ...(mouthOf(openings!) ?? narrowMouthOf(narrowings!)) };
  return Object.fromEntries(Object.entries(hints).filter(([, place]) => place.every(Number.isFinite)));
}

const movingOf = (part: MorphedPart, deltas: ArrayLike<number>): Moving => ({
  positions: part.positions,
  by: movesOf(part, deltas),
});

/** The vertices that move at least so far. */
function moved(motion: Motion, least: number): Moved[] {
  return motion.flatMap(({ positions, by }) => {
    const out: Moved[] = [];
    for (let i = 0; i < by.length; i += 3)
      if (Math.hypot(by[i]!, by[i + 1]!, by[i + 2]!) >= least)
        out.push({ at: pointOf(positions, i), by: pointOf(by, i) });
    return out;
  });
}

/** How far the vertex moves that moves farthest. */
const farthestOf = (motion: Motion): number =>
  motion.reduce((most, { by }) => {
    for (let i = 0; i < by.length; i += 3) most = Math.max(most, Math.hypot(by[i]!, by[i + 1]!, by[i + 2]!));
    return most;
  }, 0);

/** The corners of both eyes: an eye is what the lids that move farthest pass over. */
function eyesOf(blinks: readonly Motion[]): Record<string, Vector> {
  const lids = blinks.flatMap((motion) => {
    const farthest = farthestOf(motion);
    if (!(farthest > 0)) return [];
    return moved(motion, kCorner * farthest).map(({ at, by }) => {
      const share = size(by) / farthest;
      return { place: add(at, by, 0.5), weight: share < kClearly ? 0 : share };
    });
  });
  if (lids.length === 0) return {};
  const across = headingOf(lids);
  const along = ({ place }: Weighted) => dot(place, across);
  const [low, high] = rangeOf(lids.map(along));
  const sides = [-1, 1].map((sign) => {
    const own = lids.filter((one) => sign * (along(one) - (low + high) / 2) > 0);
    const [from, to] = rangeOf(own.map(along));
    const centre = meanOf(own);
    const end = (half: number) => add(centre, across, half * (to - from) * sign);
    return { centre, width: to - from, inner: end(-0.5), outer: end(0.5) };
  });
  const [right, left] = sides as [(typeof sides)[0], (typeof sides)[0]];
  const apart = distance(left.centre, right.centre);
  if (!(apart > kApart * Math.max(left.width, right.width))) return {};
  return {
    eye_inner_left: left.inner,
    eye_inner_right: right.inner,
    eye_outer_left: left.outer,
    eye_outer_right: right.outer,
  };
}

/** The middle and the corners of a mouth: where what lies together at rest parts. */
function mouthOf(motions: readonly Motion[]): Record<string, Vector> | undefined {
  const [widest] = motions
    .map((motion) => ({ motion, opening: farthestOf(motion) }))
    .sort((a, b) => b.opening - a.opening);
  if (!widest || !(widest.opening > 0)) return undefined;
  const { motion, opening } = widest;
  const lower = moved(motion, kLipsPart * opening);
  const near = kLipsNear * opening;
  const neighbours = new Neighbours(motion, lower, near);
  const parting: Weighted[] = [];
  for (let i = 0; i < lower.length; i += Math.ceil(lower.length / kMaxMoved)) {
    const one = lower[i]!;
    let best: Weighted | undefined;
    for (const other of neighbours.of(one)) {
      const rest = distance(one.at, other.at);
      const parts = distance(add(one.at, one.by), add(other.at, other.by)) - rest;
      if (rest > near || parts < kLipsPart * opening || parts - rest <= (best?.weight ?? 0)) continue;
      best = { place: add(one.at, add(other.at, one.at, -1), 0.5), weight: parts - rest };
    }
    if (best) parting.push(best);
  }
  const most = parting.reduce((sum, { weight }) => Math.max(sum, weight), 0);
  const lips = parting.filter(({ weight }) => weight > kClearly * most);
  if (lips.length === 0) return undefined;
  const middle = meanOf(lips);
  const across = headingOf(lips);
  const along = ({ place }: Weighted) => dot(place, across);
  const line = parting.filter(({ place }) => Math.abs(place[1] - middle[1]) < near);
  const [from, to] = rangeOf(line.map(along));
  const corner = (end: number) => meanOf(line.filter((one) => Math.abs(along(one) - end) <= kEnd * (to - from)));
  return { mouth: middle, mouth_corner_left: corner(to), mouth_corner_right: corner(from) };
}

/** Finds what lies near to a vertex. */
class Neighbours {
  readonly #cells = new Map<string, Moved[]>();
  readonly #near: number;

  /** @param around  Only what is near to the box around these counts. */
  constructor(motion: Motion, around: readonly Moved[], near: number) {
    this.#near = near;
    const box = [0, 1, 2].map((k) => rangeOf(around.map(({ at }) => at[k]!)));
    for (const { positions, by } of motion)
      for (let i = 0; i < by.length; i += 3) {
        const at = pointOf(positions, i);
        if (!box.every(([low, high], k) => at[k]! >= low - near && at[k]! <= high + near)) continue;
        const key = this.#cellOf(at).join();
        const cell = this.#cells.get(key) ?? [];
        if (cell.push({ at, by: pointOf(by, i) }) === 1) this.#cells.set(key, cell);
      }
  }

  #cellOf = (at: Vector): Vector => at.map((x) => Math.floor(x / this.#near)) as never as Vector;

  *of({ at }: Moved): Generator<Moved> {
    const [x, y, z] = this.#cellOf(at);
    for (let n = 0; n < 27; ++n)
      yield* this.#cells.get([x + (n % 3) - 1, y + (Math.floor(n / 3) % 3) - 1, z + Math.floor(n / 9) - 1].join()) ??
        [];
  }
}

/** The middle of what draws together. */
function narrowMouthOf(motions: readonly Motion[]): Record<string, Vector> {
  const all = motions.flatMap((motion) => {
    const farthest = farthestOf(motion);
    const clear = farthest > 0 ? moved(motion, kClearly * farthest) : [];
    return clear.map(({ at, by }) => ({ place: at, weight: size(by) / farthest }));
  });
  return all.length > 0 ? { mouth: meanOf(all) } : {};
}

interface Weighted {
  place: Vector;
  weight: number;
}

const add = (a: Vector, b: Vector, share = 1): Vector => [
  a[0] + share * b[0],
  a[1] + share * b[1],
  a[2] + share * b[2],
];
const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const size = (a: Vector): number => Math.sqrt(dot(a, a));
const pointOf = (points: Float32Array, i: number): Vector => [points[i]!, points[i + 1]!, points[i + 2]!];
const distance = (a: Vector, b: Vector): number => size(add(a, b, -1));

const rangeOf = (list: readonly number[]): [low: number, high: number] =>
  list.reduce<[number, number]>(
    ([low, high], x) => [Math.min(low, x), Math.max(high, x)],
    [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY],
  );

function meanOf(list: readonly Weighted[]): Vector {
  const total = list.reduce((sum, { weight }) => sum + weight, 0);
  return list.reduce<Vector>((sum, { place, weight }) => add(sum, place, weight / total), [0, 0, 0]);
}

/** The horizontal direction that places spread along most, towards greater x. */
function headingOf(list: readonly Weighted[]): Vector {
  const mean = meanOf(list);
  let [xx, xz, zz] = [0, 0, 0];
  for (const { place, weight } of list) {
    const [x, , z] = add(place, mean, -1);
    xx += weight * x * x;
    xz += weight * x * z;
    zz += weight * z * z;
  }
  const angle = Math.atan2(2 * xz, xx - zz) / 2;
  return [Math.cos(angle), 0, Math.sin(angle)];
}
