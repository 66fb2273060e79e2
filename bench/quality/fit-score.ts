import type { Template } from 'cagecast/cages';
import { Vector3 } from 'three';
import { boxOf, firstInPlace, vertexAreas } from '../../wasm/src/inspect/geometry.js';
import type { Figure } from './models.js';
import { bordersOf, edgesOf, pointOn, Search, type Shape, type SurfacePoint, triangleAt, vertexAt } from './shape.js';

/** Median and 95th percentile of an error, as shares of the diagonal of the template's target. */
export interface Spread {
  median: number;
  high: number;
}

/** How well a cage fits. Shares of area are of the skin that is scored. */
export interface FitScore {
  correspondence: Spread;
  /**
   * How the holes lie over the left and the right eye: the share of what is visible of it that is inside the outline of its hole, and
   * what the outline encloses beside that, in the same unit. NaN without a hole.
   */
  eyes: { cover: number; spill: number }[];
  /** The share of the skin's area that is outside of the cage. */
  outside: number;
  /** Triangles that are folded over, and are not in the template. */
  folded: number;
  /** The 5th percentile of the triangles' smallest angles, in degrees. */
  angle: number;
  /** Mean error of the true landmarks on the skin that the fit did not use, as a share of the diagonal. */
  landmarks: number;
}

/** The template's closest points, computed once. */
export class FitScorer {
  readonly cage: Template;
  readonly diagonal: number;
  private readonly onCage: SurfacePoint[];
  private readonly own: Search;
  private readonly eyeLoops: (number[] | undefined)[];
  private readonly foldedBefore: Set<number>;

  /** @param template  A figure with a cage. */
  constructor(readonly template: Figure) {
    const { target, landmarks } = template;
    const cage = template.cage!;
    this.cage = cage;
    this.diagonal = boxOf(target.positions).diagonal;
    this.own = new Search(cage);
    this.onCage = closestOf(this.own, target.positions);
    const loops = bordersOf(cage);
    this.eyeLoops = ['eye_centre_left', 'eye_centre_right'].map((name) => {
      const centre = landmarks[name];
      if (centre === undefined) return undefined;
      const away = (loop: number[]): number => middleOf(cage, loop).distanceTo(new Vector3(...centre));
      const [first] = loops.sort((a, b) => away(a) - away(b));
      return first && away(first) < 0.1 * this.diagonal ? first : undefined;
    });
    this.foldedBefore = foldedTriangles(cage);
  }

  /**
   * The error of correspondence: for each skin vertex the point of the template's cage nearest to the template's vertex, against
   * the point of the cage nearest to the person's vertex, carried to the template's cage by the same triangle and weights.
   */
  private correspondence(fitted: Search, person: Figure): Spread {
    const errors: number[] = [];
    for (let v = 0; v < person.target.positions.length / 3; ++v) {
      if (!this.isScored(person, v)) continue;
      const { triangle, weights } = fitted.closest(vertexAt(person.target.positions, v));
      const there = pointOn(this.cage, triangle, weights);
      errors.push(there.distanceTo(this.expected(person, v)) / this.diagonal);
    }
    return { median: percentile(errors, 0.5), high: percentile(errors, 0.95) };
  }

  /** Whether a vertex is skin in both truths. */
  private isScored({ truth, source }: Figure, v: number): boolean {
    const { truth: own, target } = this.template;
    if (truth.ncz[v] === 1 || truth.ignore[v] === 1) return false;
    const corners = source ? [0, 1, 2].map((k) => target.indices[3 * source.triangle[v]! + k]!) : [v];
    return corners.every((w) => own.ncz[w] === 0 && own.ignore[w] === 0);
  }

  private expected({ source }: Figure, v: number): Vector3 {
    if (source === undefined) return this.onCage[v]!.position;
    return this.own.closest(pointOn(this.template.target, source.triangle[v]!, source.barycentric[v]!)).position;
  }

  /** @param used  Names of the landmarks that the fit used. */
  score(positions: Float32Array, person: Figure, used: readonly string[]): FitScore {
    const cage = { positions, indices: this.cage.indices };
    const search = new Search(cage);
    const loopOf = (eye: number): Vector3[] | undefined => this.eyeLoops[eye]?.map((v) => vertexAt(positions, v));
    return {
      correspondence: this.correspondence(search, person),
      eyes: [0, 1].map((eye) => coverOf(person, eye + 1, loopOf(eye))),
      outside: outsideOf(cage, person),
      folded: [...foldedTriangles(cage)].filter((t) => !this.foldedBefore.has(t)).length,
      angle: percentile(smallestAngles(cage), 0.05),
      landmarks: this.landmarkError(search, person, used),
    };
  }

  private landmarkError(fitted: Search, { target, landmarks }: Figure, used: readonly string[]): number {
    const diagonal = boxOf(target.positions).diagonal;
    const names = Object.keys(landmarks).filter(
      (name) => !/^joint_|^eye_centre|^wrist/.test(name) && !used.includes(name) && this.template.landmarks[name],
    );
    const errors = names.map((name) => {
      const { triangle, weights } = this.own.closest(new Vector3(...this.template.landmarks[name]!));
      const there = fitted.closest(new Vector3(...landmarks[name]!));
      return pointOn(fitted.shape, triangle, weights).distanceTo(there.position) / diagonal;
    });
    return errors.reduce((sum, error) => sum + error, 0) / errors.length;
  }
}

const closestOf = (search: Search, positions: ArrayLike<number>): SurfacePoint[] =>
  Array.from({ length: positions.length / 3 }, (_, v) => search.closest(vertexAt(positions, v)));

const middleOf = ({ positions }: Shape, vertices: readonly number[]): Vector3 =>
  vertices.reduce((sum, v) => sum.add(vertexAt(positions, v)), new Vector3()).divideScalar(vertices.length);

/** The least value that a share of all values does not exceed; NaN of none. */
export function percentile(values: readonly number[], share: number): number {
  const sorted = [...values].sort((a, b) => a - b);
  const at = share * (sorted.length - 1);
  const low = sorted[Math.floor(at)] ?? NaN;
  return low + (at - Math.floor(at)) * ((sorted[Math.ceil(at)] ?? low) - low);
}

/** Rays per side of the rectangle that an eye is looked at in. */
const kRays = 96;
/** How far in front of the eyeball rays start that ask whether it can be seen, as a share of the diagonal. */
const kLift = 1e-4;

/**
 * Looks at an eye with parallel rays, along the mean normal of those of its triangles that can be seen straight on. What is
 * visible of it is what the lids leave free; lashes are looked through.
 * @param loop  The border of its hole.
 */
function coverOf({ target, truth }: Figure, eye: number, loop: Vector3[] | undefined): FitScore['eyes'][number] {
  const { positions, indices } = target;
  const partOf = (t: number): number => truth.eyes[indices[3 * t]!]!;
  const all = Array.from({ length: indices.length / 3 }, (_, t) => t);
  const ball = all.filter((t) => partOf(t) === eye);
  if (ball.length === 0 || loop === undefined) return { cover: NaN, spill: NaN };
  const seen = all.filter((t) => partOf(t) !== 3);
  const whole = new Search({
    positions,
    indices: seen.flatMap((t) => [0, 1, 2].map((k) => indices[3 * t + k]!)),
  });
  const size = boxOf(positions).diagonal;
  const axis = new Vector3();
  const points = [...loop];
  for (const t of ball) {
    const triangle = triangleAt(target, t);
    const normal = triangle.getNormal(new Vector3());
    points.push(triangle.a, triangle.b, triangle.c);
    const start = triangle.getMidpoint(new Vector3()).addScaledVector(normal, kLift * size);
    if (whole.firstHit(start, normal) < 0) axis.addScaledVector(normal, triangle.getArea());
  }
  axis.normalize();
  const right = new Vector3(0, 1, 0).cross(axis).normalize();
  const up = axis.clone().cross(right);
  const flat = points.map((p): [number, number] => [p.dot(right), p.dot(up)]);
  const [left, bottom] = [0, 1].map((k) => Math.min(...flat.map((p) => p[k]!))) as [number, number];
  const [width, height] = [Math.max(...flat.map(([x]) => x)) - left, Math.max(...flat.map(([, y]) => y)) - bottom];
  const far = size + Math.max(...points.map((p) => p.dot(axis)));
  const back = axis.clone().negate();
  let [visible, inHole, hole] = [0, 0, 0];
  for (let i = 0; i < kRays * kRays; ++i) {
    const x = left + (((i % kRays) + 0.5) / kRays) * width;
    const y = bottom + ((Math.floor(i / kRays) + 0.5) / kRays) * height;
    const origin = new Vector3().addScaledVector(right, x).addScaledVector(up, y).addScaledVector(axis, far);
    const isHole = isWithin(flat.slice(0, loop.length), x, y);
    if (isHole) ++hole;
    const hit = whole.firstHit(origin, back);
    if (hit < 0 || partOf(seen[hit]!) !== eye) continue;
    ++visible;
    if (isHole) ++inHole;
  }
  return { cover: inHole / visible, spill: (hole - inHole) / visible };
}

function isWithin(loop: readonly [number, number][], x: number, y: number): boolean {
  let inside = false;
  loop.forEach(([ax, ay], i) => {
    const [bx, by] = loop[(i + 1) % loop.length]!;
    if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) inside = !inside;
  });
  return inside;
}

/** The share of the skin in front of the nearest point of the cage; where that is on a border, it says nothing. */
function outsideOf(cage: Shape, { target, truth }: Figure): number {
  const at = firstInPlace(cage.positions);
  const edges = edgesOf(cage, at);
  const normals = Array.from({ length: cage.indices.length / 3 }, (_, t) =>
    triangleAt(cage, t).getNormal(new Vector3()),
  );
  const atVertex = at.reduce((map, v) => map.set(v, new Vector3()), new Map<number, Vector3>());
  normals.forEach((normal, t) => {
    const corners = [0, 1, 2].map((k) => vertexAt(cage.positions, cage.indices[3 * t + k]!)) as [
      Vector3,
      Vector3,
      Vector3,
    ];
    for (let k = 0; k < 3; ++k) {
      const [u, w] = [1, 2].map((step) => corners[(k + step) % 3]!.clone().sub(corners[k]!)) as [Vector3, Vector3];
      atVertex.get(at[cage.indices[3 * t + k]!]!)!.addScaledVector(normal, u.angleTo(w));
    }
  });
  const onBorder = new Set<number>();
  for (const [key, triangles] of edges)
    if (triangles.length === 1) for (const v of [Math.floor(key / at.length), key % at.length]) onBorder.add(v);
  const search = new Search(cage);
  const areas = vertexAreas(target);
  let [outside, all] = [0, 0];
  for (let v = 0; v < areas.length; ++v) {
    if (truth.ncz[v] === 1 || truth.ignore[v] === 1) continue;
    all += areas[v]!;
    const p = vertexAt(target.positions, v);
    const { triangle, weights, position } = search.closest(p);
    const corners = [0, 1, 2].filter((k) => weights[k]! > 1e-4).map((k) => at[cage.indices[3 * triangle + k]!]!);
    let normal = normals[triangle]!;
    if (corners.length === 1) {
      if (onBorder.has(corners[0]!)) continue;
      normal = atVertex.get(corners[0]!)!;
    } else if (corners.length === 2) {
      const [a, b] = [Math.min(...corners), Math.max(...corners)];
      const both = edges.get(a * at.length + b)!;
      if (both.length === 1) continue;
      normal = both.reduce((sum, t) => sum.add(normals[t]!), new Vector3());
    }
    if (p.sub(position).dot(normal) > 0) outside += areas[v]!;
  }
  return outside / all;
}

/**
 * Triangles that face away from the mean of those around them, and pairs that turn by more than 120° at their common edge.
 */
function foldedTriangles(cage: Shape): Set<number> {
  const at = firstInPlace(cage.positions);
  const count = cage.indices.length / 3;
  const normals: Vector3[] = [];
  const around = new Map<number, Vector3>();
  for (let t = 0; t < count; ++t) {
    const triangle = triangleAt(cage, t);
    const normal = triangle.getNormal(new Vector3()).multiplyScalar(triangle.getArea());
    normals.push(normal);
    for (let k = 0; k < 3; ++k) {
      const v = at[cage.indices[3 * t + k]!]!;
      around.set(v, (around.get(v) ?? new Vector3()).add(normal));
    }
  }
  const folded = new Set<number>();
  normals.forEach((normal, t) => {
    const sum = new Vector3();
    for (let k = 0; k < 3; ++k) sum.add(around.get(at[cage.indices[3 * t + k]!]!)!).sub(normal);
    if (sum.dot(normal) < 0) folded.add(t);
  });
  for (const [a, b] of edgesOf(cage, at).values())
    if (b !== undefined && normals[a!]!.angleTo(normals[b]!) > (2 * Math.PI) / 3) folded.add(a!).add(b);
  return folded;
}

function smallestAngles(cage: Shape): number[] {
  return Array.from({ length: cage.indices.length / 3 }, (_, t) => {
    const { a, b, c } = triangleAt(cage, t);
    const angle = (p: Vector3, q: Vector3, r: Vector3): number => q.clone().sub(p).angleTo(r.clone().sub(p));
    return (Math.min(angle(a, b, c), angle(b, c, a), angle(c, a, b)) * 180) / Math.PI;
  });
}
