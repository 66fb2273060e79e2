import { type Finding, percent } from './finding.js';
import { type Box, boxOf, cross, minus, pointAt, quantiles, type Vector } from './geometry.js';
import type { Scene } from './scene.js';

/** How far outside the cage a vertex may lie, as a share of the diagonal, before it counts as poking through. */
const pokeThrough = 0.0025;
/** The most of the exposed area that pokes through a cage that is fit. */
const mostOutside = 0.1;
/** From here on, as a share of the diagonal, a cage that could be moved to stand off evenly is worth a remark. */
const unevenFrom = 0.02;
/** The farthest that a cage stands off what lies beneath it at the median. */
const farCage = 0.15;
/** The least of the exposed area that a cage lies over; a face is a hundredth of a body. */
const leastBeneath = 0.002;
/**
 * A point so far outside, as a share of the diagonal, is not poking through but belongs to another part of the target, if
 * what should be beneath the nearest triangle of the cage is there: the flank beside a sleeve, one leg beside the other.
 */
const elsewhere = 0.02;
/** That much, as a share of the triangle's own area, is enough to be there. */
const leastServed = 0.3;
/** Nor may much of the cage lie over nothing: then it is the cage that is elsewhere. */
const allServed = 0.95;
/** And so near must it be, as a share of the diagonal. */
const close = 0.04;

/** Where the target lies about the cage. Lengths are shares of the target's diagonal. */
export interface Placement {
  /**
   * Share of the target on the outer side of the cage: of its vertices, of its area, and, farther out than 0.25 % of the
   * diagonal, of the area that nothing occludes and that the cage lies over: not beside its open borders.
   */
  outside: { vertices: number; area: number; exposedArea: number };
  /** Distance from target to cage: quantiles over the vertices. */
  distances: { p50: number; p90: number; p99: number; max: number };
  /** What the cage lies over: its share of the exposed area, and its median distance. */
  beneath: { share: number; distance: number };
  /** How the cage would have to be moved, turned (about the target's middle; degrees) and grown to fit best. */
  correction: { move: Vector; turn: Vector; grow: number };
  /** What would remain outside after moving and turning alone. */
  outsideOnceMoved: number;
  /** How much larger the cage's box is along x, y and z than that of the target's points that are judged. */
  room: Vector;
}

/** Measures where the target lies about the cage. */
export function placementOf(scene: Scene): Placement {
  const { areas, diagonal, sides, result } = scene;
  let [vertices, area, total, exposed, beneath, exposedOutside] = [0, 0, 0, 0, 0, 0];
  const candidates: number[] = [];
  // Per triangle of the cage: how much of the target lies close beneath it, hidden or not.
  const within = new Float64Array(scene.surface.areas.length);
  for (let v = 0; v < areas.length; ++v) {
    total += areas[v]!;
    if (sides.signed[v]! > 0) {
      ++vertices;
      area += areas[v]!;
    }
    const over = sides.loops[v]! < 0;
    if (over && sides.signed[v]! <= 0 && sides.signed[v]! > -close * diagonal)
      within[result.triangles[v]!]! += areas[v]!;
    if (result.zones[v] === 1 || areas[v] === 0) continue;
    exposed += areas[v]!;
    if (!over) continue;
    candidates.push(v);
  }
  const [there, needed] = [overNeighbours(scene, within), overNeighbours(scene, scene.surface.areas)];
  const served = (t: number) => there[t]! >= leastServed * needed[t]!;
  const servedShare =
    scene.surface.areas.reduce((sum, size, t) => sum + (served(t) ? size : 0), 0) / scene.surface.area;
  const beside = (v: number) =>
    servedShare >= allServed && sides.signed[v]! > elsewhere * diagonal && served(result.triangles[v]!);
  const judged = candidates.filter((v) => !beside(v));
  for (const v of judged) {
    beneath += areas[v]!;
    if (sides.signed[v]! > pokeThrough * diagonal) exposedOutside += areas[v]!;
  }
  const { correction, remaining } = correct(scene, judged);
  const [p50 = 0, p90 = 0, p99 = 0, max = 0] = quantiles(result.distances, [0.5, 0.9, 0.99, 1]).map(
    (d) => d / diagonal,
  );
  return {
    outside: {
      vertices: areas.length > 0 ? vertices / areas.length : 0,
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

/** For each triangle of the cage, the sum of a value over it and its neighbours, weighted by the corners they share. */
function overNeighbours({ cage: { indices }, surface: { place } }: Scene, values: Float64Array): Float64Array {
  const atPlace = new Float64Array(place.length);
  for (let i = 0; i < indices.length; ++i) atPlace[place[indices[i]!]!]! += values[Math.floor(i / 3)]!;
  return values.map(
    (_, t) =>
      atPlace[place[indices[3 * t]!]!]! + atPlace[place[indices[3 * t + 1]!]!]! + atPlace[place[indices[3 * t + 2]!]!]!,
  );
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
    const normal = cross(minus(b, a), minus(c, a));
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
    // What is far from the cage lies in a fold of the target; it says nothing of the fit.
    const weight = areas[v]! / (1 + (s / 0.03) ** 2);
    rowOf(v);
    weights += weight;
    for (let i = 0; i < unknowns; ++i) {
      for (let k = 0; k < unknowns; ++k) matrix[i]![k]! += weight * row[i]! * row[k]!;
      matrix[i]![unknowns]! += weight * row[i]! * s;
    }
  }
  // A ball can be turned at will: without this the equations would not know how far.
  for (let i = 0; i < 6; ++i) matrix[i]![i]! += 1e-3 * (weights || 1);
  matrix[6]![6]! += 1e-9 * (weights || 1);
  const x = solve(matrix);
  let remaining = 0;
  for (const v of judged) {
    rowOf(v);
    let s = sides.signed[v]! / diagonal;
    for (let i = 0; i < 6; ++i) s -= x[i]! * row[i]!;
    if (s > pokeThrough) remaining += areas[v]!;
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

/** The target outside the cage, the cage elsewhere or far off. */
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
        sentence: `The cage is elsewhere: between it and the target there is a gap of ${percent(gap)} of the target's diagonal; it is ${size.toPrecision(2)} times as large as the target`,
        advice: 'Move it around the target, in the same unit; check that transforms were applied on export.',
        numbers: { gap, size },
      },
    ];
  }
  const { outside, beneath } = placement;
  const findings: Finding[] = [];
  if (beneath.share < leastBeneath) {
    findings.push({
      code: 'cageElsewhere',
      weight: 50,
      sentence: `The cage lies over no more than ${percent(beneath.share)} of what is exposed of the target; it is ${size.toPrecision(2)} times as large`,
      advice: 'Move it around the target, in the same unit; check that transforms were applied on export.',
      numbers: { gap, size, beneath: beneath.share },
    });
  }
  const share = outside.exposedArea;
  const cause = causeOf(placement);
  if (share > 0 || cause === 'cageMisplaced') {
    const out = `${percent(share)} of what is exposed of the target pokes out of the cage by more than ${percent(pokeThrough)} of the diagonal`;
    const { sentence, advice } = describe(
      cause,
      placement,
      diagonal,
      share > 0 ? out : 'it stands off the target unevenly',
    );
    const uneven = Math.hypot(...placement.correction.move) / (4 * unevenFrom);
    findings.push({
      code: cause,
      weight: Math.max(share / mostOutside, cause === 'cageMisplaced' ? Math.min(0.9, uneven) : 0),
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
  if (beneath.distance > farCage / 2) {
    findings.push({
      code: 'cageTooFar',
      weight: beneath.distance / farCage,
      sentence: `Half of what the cage lies over is farther than ${percent(beneath.distance)} of the diagonal from it; it is ${size.toPrecision(2)} times as large as the target`,
      advice:
        'Fit the cage more closely: the farther off, the more the texture is distorted. Check that both are in the same unit.',
      numbers: { median: beneath.distance, size },
    });
  }
  return findings;
}

type Cause = 'cageMisplaced' | 'cageTooSmall' | 'targetPokesOut';

/** Why the target is outside: what would help most. */
function causeOf({ outside, outsideOnceMoved, correction, room }: Placement): Cause {
  const share = outside.exposedArea;
  if (share === 0 ? Math.hypot(...correction.move) >= unevenFrom : outsideOnceMoved < 0.5 * share)
    return 'cageMisplaced';
  if (correction.grow > 0 || room[0] + room[1] + room[2] < 0) return 'cageTooSmall';
  // Large enough, and yet much is outside: it is turned or moved too far for an estimate.
  return share > 2 * mostOutside ? 'cageMisplaced' : 'targetPokesOut';
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
      advice: 'Grow it along its normals until the target is inside.',
    };
  if (cause === 'targetPokesOut')
    return { sentence: out, advice: 'Pull the cage out there, or grow it along its normals.' };
  if (outside.exposedArea > 0 && outsideOnceMoved >= 0.5 * outside.exposedArea) {
    return {
      sentence: `The cage is misplaced, or made for something else: ${out}, though it is large enough`,
      advice: 'Move and turn it onto the target; check that it belongs to it.',
    };
  }
  const moved = Math.hypot(...correction.move);
  const turned = Math.hypot(...correction.turn);
  const how = [
    moved >= 0.002 ? `moved by about ${percent(moved)} of the diagonal` : '',
    turned >= 0.5 ? `turned by about ${turned.toFixed(1)}°` : '',
  ].filter(Boolean);
  const moves = correction.move.map((share) => Number((share * diagonal).toPrecision(2))).join(', ');
  const turns = correction.turn.map((degrees) => `${degrees.toFixed(1)}°`).join(', ');
  return {
    sentence: `The cage is misplaced${how.length > 0 ? `, ${how.join(' and ')}` : ''}: ${out}`,
    advice: `Move it by about (${moves}) and turn it by about (${turns}) about x, y and z.`,
  };
}
