import type { SegmentStats } from '../api/index.js';
import { type Finding, percent } from './finding.js';
import { type Box, boxOf, cross, doubleAreaNormal, minus, pointAt, quantiles, type Vector } from './geometry.js';
import { partsOf, type Scene } from './scene.js';

/** How far outside the cage a vertex may lie, as a share of the diagonal, before it counts as poking through. */
const kPokeThrough = 0.0025;
/** A cage is unfit if more than this share of the exposed area pokes out of it. */
const kMaxOutside = 0.1;
/** An uneven distance is reported if moving the cage by at least this share of the diagonal would even it out. */
const kUnevenFrom = 0.02;
/** A cage is unfit if its median distance to the target exceeds this share of the diagonal. */
const kFarCage = 0.15;
/** A cage must lie over at least this share of the exposed area; a face is a hundredth of a body. */
const kMinBeneath = 0.002;
/** A target this many times as large as its painted part has something foreign in it. */
const kTooLarge = 10;
/** A cage is unfit if the target is so many times as large. */
const kFarTooLarge = 100;

/** If at least this share of the exposed area passes, the cage is judged by it. */
const kMuchPainted = 0.2;

/** How the region of the target that the cage covers lies relative to it. Lengths are shares of the target's diagonal. */
export interface Placement {
  /**
   * Share of the target on the outer side of the cage: of its vertices, of its area, and of the exposed area under the cage (not
   * beside its open borders); the last one counts only what is farther out than 0.25 % of the diagonal.
   */
  outside: { vertices: number; area: number; exposedArea: number };
  /** Distance from target to cage: quantiles over the vertices. */
  distances: { p50: number; p90: number; p99: number; max: number };
  /** The target under the cage: its share of the exposed area, and its median distance. */
  beneath: { share: number; distance: number };
  /** How to move, rotate (around the target's middle, in degrees) and enlarge the cage for the best fit. */
  correction: { move: Vector; turn: Vector; grow: number };
  /** Share of the exposed area that would remain outside after only moving and rotating. */
  outsideOnceMoved: number;
  /** How much larger than the target's bounding box the cage's is, along x, y and z; only vertices under the cage count. */
  room: Vector;
}

/** Measures how the target lies relative to the cage. */
export function placementOf(scene: Scene): Placement {
  const { areas, diagonal, sides, result, isInRegion } = scene;
  // Hair and glasses lie outside the cage of a head: a cage is not judged by excluded parts, nor, if enough of the rest is painted, by
  // culled ones.
  const areaOf = (isOf: (segment: SegmentStats) => boolean) =>
    result.segmentStats.reduce((sum, segment) => sum + (isOf(segment) ? segment.exposedArea : 0), 0);
  const isExcluded = ({ culledBy }: SegmentStats) => culledBy === 'lock';
  const rest = areaOf((segment) => !isExcluded(segment));
  const isPainted = areaOf(({ culled }) => !culled) > kMuchPainted * rest;
  const isAside = (segment: number) => {
    const stats = result.segmentStats[segment]!;
    return (rest > 0 && isExcluded(stats)) || (isPainted && stats.culled);
  };
  let [vertices, area, total, exposed, beneath, exposedOutside] = [0, 0, 0, 0, 0, 0];
  const judged: number[] = [];
  const region: number[] = [];
  for (let v = 0; v < areas.length; ++v) {
    if (!isInRegion(v)) continue;
    region.push(v);
    total += areas[v]!;
    if (sides.signed[v]! > 0) {
      ++vertices;
      area += areas[v]!;
    }
    const over = sides.areUnder[v] === 1;
    if (result.zones[v] === 1 || areas[v] === 0) continue;
    exposed += areas[v]!;
    if (over && !isAside(result.segments[v]!)) judged.push(v);
  }
  for (const v of judged) {
    beneath += areas[v]!;
    if (sides.signed[v]! > kPokeThrough * diagonal) exposedOutside += areas[v]!;
  }
  const { correction, remaining } = correct(scene, judged);
  const [p50 = 0, p90 = 0, p99 = 0, max = 0] = quantiles(
    region.map((v) => result.distances[v]!),
    [0.5, 0.9, 0.99, 1],
  ).map((d) => d / diagonal);
  return {
    outside: {
      vertices: region.length > 0 ? vertices / region.length : 0,
      area: total > 0 ? area / total : 0,
      exposedArea: beneath > 0 ? exposedOutside / beneath : 0,
    },
    distances: { p50, p90, p99, max },
    beneath: {
      share: exposed > 0 ? beneath / exposed : 0,
      distance:
        quantiles(
          judged.map((v) => result.distances[v]!),
          [0.5],
        )[0]! / diagonal,
    },
    correction,
    outsideOnceMoved: beneath > 0 ? remaining / beneath : 0,
    room: roomOf(boxOf(scene.cage.positions, scene.cage.indices), boxOf(scene.target.positions, judged), diagonal),
  };
}

function roomOf(cage: Box, judged: Box, diagonal: number): Vector {
  const room = (k: 0 | 1 | 2) =>
    judged.diagonal > 0 ? (cage.max[k] - cage.min[k] - judged.max[k] + judged.min[k]) / diagonal : 0;
  return [room(0), room(1), room(2)];
}

/**
 * Finds the small motion and growth of the cage after which the target lies evenly beneath it: least squares over the
 * signed distances s along the cage's normals n, s = move · n + turn · (r × n) + grow (the linearised point-to-plane
 * alignment of Chen & Medioni, with the mean distance as an unknown).
 */
function correct(
  { cage, target, areas, diagonal, targetBox, sides, result }: Scene,
  judged: readonly number[],
): { correction: Placement['correction']; remaining: number } {
  const unknowns = 7;
  const middle = centreOf(targetBox);
  const matrix = Array.from({ length: unknowns }, () => new Float64Array(unknowns + 1));
  const row = new Float64Array(unknowns);
  const rowOf = (v: number) => {
    const t = 3 * result.triangles[v]!;
    const [a, b, c] = [0, 1, 2].map((k) => pointAt(cage.positions, cage.indices[t + k]!)) as [Vector, Vector, Vector];
    const normal = doubleAreaNormal(a, b, c);
    const size = Math.hypot(...normal);
    const n: Vector = [normal[0] / size, normal[1] / size, normal[2] / size];
    const p = pointAt(target.positions, v);
    const r: Vector = [(p[0] - middle[0]) / diagonal, (p[1] - middle[1]) / diagonal, (p[2] - middle[2]) / diagonal];
    row.set(n);
    row.set(cross(r, n), 3);
    row[6] = 1;
    return row;
  };
  let weights = 0;
  for (const v of judged) {
    const s = sides.signed[v]! / diagonal;
    // Vertices far from the cage lie in folds of the target and say nothing about the fit.
    const weight = areas[v]! / (1 + (s / 0.03) ** 2);
    rowOf(v);
    weights += weight;
    for (let i = 0; i < unknowns; ++i) {
      for (let k = 0; k < unknowns; ++k) matrix[i]![k]! += weight * row[i]! * row[k]!;
      matrix[i]![unknowns]! += weight * row[i]! * s;
    }
  }
  // Regularisation: the rotation of a ball, for example, is undetermined.
  for (let i = 0; i < 6; ++i) matrix[i]![i]! += 1e-3 * (weights || 1);
  matrix[6]![6]! += 1e-9 * (weights || 1);
  const x = solve(matrix);
  let remaining = 0;
  for (const v of judged) {
    rowOf(v);
    let s = sides.signed[v]! / diagonal;
    for (let i = 0; i < 6; ++i) s -= x[i]! * row[i]!;
    if (s > kPokeThrough) remaining += areas[v]!;
  }
  const degrees = 180 / Math.PI;
  return {
    correction: { move: [x[0]!, x[1]!, x[2]!], turn: [x[3]! * degrees, x[4]! * degrees, x[5]! * degrees], grow: x[6]! },
    remaining,
  };
}

/** Solves a symmetric positive system, in place; the last column is the right side. */
function solve(matrix: Float64Array[]): number[] {
  const n = matrix.length;
  for (let i = 0; i < n; ++i) {
    for (let k = i + 1; k < n; ++k) {
      const factor = matrix[k]![i]! / matrix[i]![i]!;
      for (let c = i; c <= n; ++c) matrix[k]![c]! -= factor * matrix[i]![c]!;
    }
  }
  const x = new Array<number>(n).fill(0);
  for (let i = n - 1; i >= 0; --i) {
    let sum = matrix[i]![n]!;
    for (let c = i + 1; c < n; ++c) sum -= matrix[i]![c]! * x[c]!;
    x[i] = sum / matrix[i]![i]!;
  }
  return x;
}

const centreOf = ({ min, max }: Box): Vector => [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];

/** A target with a ground or the like in it, by whose size all lengths are measured. */
function checkSize({ cage, target, diagonal, parts, result }: Scene): Finding[] {
  const { zones, segments } = result;
  const painted = boxOf(
    target.positions,
    target.indices.filter((v) => zones[v] === 0),
  );
  const times = diagonal / painted.diagonal;
  const isCageFilled = painted.diagonal > boxOf(cage.positions, cage.indices).diagonal / 2;
  if (!isCageFilled || !(times >= kTooLarge)) return [];
  const middle = centreOf(painted);
  const away = (v: number): number => Math.hypot(...minus(pointAt(target.positions, v), middle));
  const farthest = zones.reduce((far, _, v) => (away(v) > away(far) ? v : far), 0);
  const group = target.groups?.[farthest] ?? 0;
  const part = parts[partsOf(parts, zones.length)[farthest]!]?.name ?? '';
  return [
    {
      code: 'targetTooLarge',
      weight: times / kFarTooLarge,
      sentence: `The target is ${Math.round(times)} times as large as what is painted of it; "${part}" is farthest away`,
      advice:
        'Leave out what is around the model, such as a ground: lengths are measured by the size of the target, so what is small beside it is judged too coarsely.',
      numbers: { times },
      places: [{ segment: segments[farthest]!, group, part }],
    },
  ];
}

/** A cage that is misplaced, too small or too far away, and a target that is too large. */
export function checkPlacement(scene: Scene, placement: Placement): Finding[] {
  const { targetBox, diagonal } = scene;
  const cageBox = boxOf(scene.cage.positions, scene.cage.indices);
  const gap =
    Math.hypot(
      ...[0, 1, 2].map((k) => Math.max(0, targetBox.min[k]! - cageBox.max[k]!, cageBox.min[k]! - targetBox.max[k]!)),
    ) / diagonal;
  const size = cageBox.diagonal / diagonal;
  if (gap > 0) {
    return [
      {
        code: 'cageElsewhere',
        weight: 100,
        sentence: `The cage is not around the target: the gap between them is ${percent(gap)} of the target's diagonal, and the cage is ${size.toPrecision(2)} times as large as the target`,
        advice: 'Move it around the target, in the same unit; check that transforms were applied on export.',
        numbers: { gap, size },
      },
    ];
  }
  const { outside, beneath } = placement;
  const findings = checkSize(scene);
  if (beneath.share < kMinBeneath && findings.length === 0) {
    findings.push({
      code: 'cageElsewhere',
      weight: 50,
      sentence: `The cage lies over only ${percent(beneath.share)} of the target's exposed area; it is ${size.toPrecision(2)} times as large as the target`,
      advice: 'Move it around the target, in the same unit; check that transforms were applied on export.',
      numbers: { gap, size, beneath: beneath.share },
    });
  }
  const share = outside.exposedArea;
  const cause = causeOf(placement);
  if (share > 0 || cause === 'cageMisplaced') {
    const out = `${percent(share)} of the target's exposed area pokes out of the cage by more than ${percent(kPokeThrough)} of the diagonal`;
    const { sentence, advice } = describe(
      cause,
      placement,
      diagonal,
      share > 0 ? out : 'its distance to the target is uneven',
    );
    const uneven = Math.hypot(...placement.correction.move) / (4 * kUnevenFrom);
    findings.push({
      code: cause,
      weight: Math.max(share / kMaxOutside, cause === 'cageMisplaced' ? Math.min(0.9, uneven) : 0),
      sentence,
      advice,
      numbers: {
        share,
        onceMoved: placement.outsideOnceMoved,
        move: [...placement.correction.move],
        turn: [...placement.correction.turn],
        grow: placement.correction.grow,
        room: [...placement.room],
      },
    });
  }
  if (beneath.distance > kFarCage / 2) {
    findings.push({
      code: 'cageTooFar',
      weight: beneath.distance / kFarCage,
      sentence: `Half of the exposed vertices under the cage are more than ${percent(beneath.distance)} of the diagonal away from it; the cage is ${size.toPrecision(2)} times as large as the target`,
      advice:
        'Fit the cage more closely: the greater the distance, the more the texture is distorted. Check that both are in the same unit.',
      numbers: { median: beneath.distance, size },
    });
  }
  return findings;
}

type Cause = 'cageMisplaced' | 'cageTooSmall' | 'targetPokesOut';

/** The reason why the target is outside: which correction would help most. */
function causeOf({ outside, outsideOnceMoved, correction, room }: Placement): Cause {
  const share = outside.exposedArea;
  if (share === 0 ? Math.hypot(...correction.move) >= kUnevenFrom : outsideOnceMoved < 0.5 * share)
    return 'cageMisplaced';
  if (correction.grow > 0 || room[0] + room[1] + room[2] < 0) return 'cageTooSmall';
  // The cage is large enough, yet much is outside: it is moved or rotated too far for an estimate.
  return share > 2 * kMaxOutside ? 'cageMisplaced' : 'targetPokesOut';
}

function describe(
  cause: Cause,
  { outside, outsideOnceMoved, correction }: Placement,
  diagonal: number,
  out: string,
): { sentence: string; advice: string } {
  if (cause === 'cageTooSmall')
    return {
      sentence: `The cage is too small: ${out}`,
      advice: 'Enlarge it along its normals, or scale it back if it was scaled, until the target is inside.',
    };
  if (cause === 'targetPokesOut')
    return { sentence: out, advice: 'Move the cage outwards there, or enlarge it along its normals.' };
  if (outside.exposedArea > 0 && outsideOnceMoved >= 0.5 * outside.exposedArea) {
    return {
      sentence: `The cage is misplaced or was made for another model: ${out}, although the cage is large enough`,
      advice: 'Move and rotate it onto the target, and check that it was made for this target.',
    };
  }
  const moved = Math.hypot(...correction.move);
  const turned = Math.hypot(...correction.turn);
  const how = [
    moved >= 0.002 ? `shifted by about ${percent(moved)} of the diagonal` : '',
    turned >= 0.5 ? `rotated by about ${turned.toFixed(1)}°` : '',
  ].filter(Boolean);
  const moves = correction.move.map((share) => Number((share * diagonal).toPrecision(2))).join(', ');
  const turns = correction.turn.map((degrees) => `${degrees.toFixed(1)}°`).join(', ');
  return {
    sentence: `The cage is misplaced${how.length > 0 ? `, ${how.join(' and ')}` : ''}: ${out}`,
    advice: `Move it by about (${moves}) and rotate it by about (${turns}) around x, y and z.`,
  };
}
