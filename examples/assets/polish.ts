import { cholesky, cotangent, type Flat, isSimple, restOf, type Uv } from './flat.ts';
import { type Mesh, vertexCount } from './mesh.ts';
import type { Vec3 } from './vec.ts';

const kRounds = 300;
const kMemory = 8; // steps that the curvature is learnt from
const kGain = 1e-6; // of the distortion in a round: less is nothing
const kShortest = 1e-6; // share of a step

/**
 * Lowers the distortion of a layout (symmetric Dirichlet energy) until nothing is gained: L-BFGS, its first guess of the
 * curvature being the Laplacian of the model, so that steps are as large for the whole as for a part. No triangle turns over and
 * the outer border crosses itself nowhere.
 * @param zoom  As of `pelt`.
 */
export const polish = (mesh: Mesh, outer: readonly number[], start: Flat, zoom: (p: Vec3) => number): Flat => {
  const count = vertexCount(mesh);
  const { triangles, shapes: rest, areas } = restOf(mesh, zoom);

  /** The distortion of a layout (u of every vertex, then v), and where it falls. */
  const measure = (x: Float64Array, slope?: Float64Array): number => {
    let total = 0;
    for (let t = 0; t < triangles.length; t++) {
      const [i, j, k] = triangles[t]!;
      const width = rest[t]![1][0];
      const [cx, cy] = rest[t]![2];
      const a = (x[j]! - x[i]!) / width;
      const c = (x[count + j]! - x[count + i]!) / width;
      const b = (x[k]! - x[i]! - a * cx) / cy;
      const d = (x[count + k]! - x[count + i]! - c * cx) / cy;
      const turn = a * d - b * c;
      if (turn <= 0) return Infinity;
      const size = a * a + b * b + c * c + d * d;
      total += areas[t]! * size * (1 + 1 / turn ** 2);
      if (!slope) continue;
      const [p, q] = [2 * areas[t]! * (1 + 1 / turn ** 2), (2 * areas[t]! * size) / turn ** 3];
      const [ga, gb, gc, gd] = [p * a - q * d, p * b + q * c, p * c + q * b, p * d - q * a];
      // a and c follow corner j, and so do b and d by -cx / (width cy); corner i takes what keeps the sum at nothing.
      const [uj, uk] = [(ga - (gb * cx) / cy) / width, gb / cy];
      const [vj, vk] = [(gc - (gd * cx) / cy) / width, gd / cy];
      slope[j]! += uj;
      slope[k]! += uk;
      slope[i]! -= uj + uk;
      slope[count + j]! += vj;
      slope[count + k]! += vk;
      slope[count + i]! -= vj + vk;
    }
    return total;
  };
  const isFree = (x: Float64Array): boolean => isSimple(outer.map((v): Uv => [x[v]!, x[count + v]!]));

  const matrix = new Float64Array(count * count);
  triangles.forEach((t, i) => {
    for (let k = 0; k < 3; k++) {
      const [a, b] = [t[k]!, t[(k + 1) % 3]!];
      const w = 2 * cotangent(rest[i]![(k + 2) % 3]!, rest[i]![k]!, rest[i]![(k + 1) % 3]!);
      for (const [m, n] of [
        [a, b],
        [b, a],
      ] as const) {
        matrix[m * count + m]! += w;
        matrix[m * count + n]! -= w;
      }
    }
  });
  const hold = 1e-6 * matrix[0]!; // the layout may slide as a whole
  for (let v = 0; v < count; v++) matrix[v * count + v]! += hold;
  const solve = cholesky(matrix, count);
  const smoothed = (g: Float64Array): Float64Array => {
    const out = new Float64Array(2 * count);
    out.set(solve(g.subarray(0, count)));
    out.set(solve(g.subarray(count)), count);
    return out;
  };

  let x = Float64Array.from([...start[0], ...start[1]]);
  let slope = new Float64Array(2 * count);
  let least = measure(x, slope);
  const steps: { s: Float64Array; y: Float64Array; sy: number }[] = [];
  for (let round = 0; round < kRounds; round++) {
    const ahead = direction(slope, steps, smoothed);
    let step = 1;
    let next: Float64Array<ArrayBuffer> | undefined;
    for (; step > kShortest && !next; step /= 2) {
      const tried = x.map((value, i) => value + step * ahead[i]!);
      if (measure(tried) < least && isFree(tried)) next = tried;
    }
    if (!next) {
      if (steps.length === 0) break;
      steps.length = 0; // what was learnt is wrong here
      continue;
    }
    const after = new Float64Array(2 * count);
    const now = measure(next, after);
    const s = next.map((value, i) => value - x[i]!);
    const y = after.map((value, i) => value - slope[i]!);
    const sy = inner(s, y);
    if (sy > 0) steps.push({ s, y, sy });
    if (steps.length > kMemory) steps.shift();
    const gain = (least - now) / now;
    [x, slope, least] = [next, after, now];
    if (gain < kGain) break;
  }
  return [x.slice(0, count), x.slice(count)];
};

const inner = (a: Float64Array, b: Float64Array): number => a.reduce((sum, value, i) => sum + value * b[i]!, 0);

/** Where to go: down the slope, as the curvature learnt from the last steps says (Nocedal 1980). */
const direction = (
  slope: Float64Array,
  steps: readonly { s: Float64Array; y: Float64Array; sy: number }[],
  smoothed: (g: Float64Array) => Float64Array,
): Float64Array => {
  const q = slope.slice();
  const shares: number[] = [];
  for (let i = steps.length - 1; i >= 0; i--) {
    const { s, y, sy } = steps[i]!;
    shares[i] = inner(s, q) / sy;
    for (let k = 0; k < q.length; k++) q[k]! -= shares[i]! * y[k]!;
  }
  const r = smoothed(q);
  steps.forEach(({ s, y, sy }, i) => {
    const share = shares[i]! - inner(y, r) / sy;
    for (let k = 0; k < r.length; k++) r[k]! += share * s[k]!;
  });
  return r.map((value) => -value);
};
