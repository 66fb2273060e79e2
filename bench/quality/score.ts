import type { Scene, SceneMesh } from '../scene-file.js';
import type { Model } from './models.js';
import type { Answer } from './reference.js';

/** Shares of area; 1 is perfect. A third of each triangle goes to each of its corners. */
export interface Score {
  /** Of what must not be painted, the share that is not. */
  suppressed: number;
  /** Of what is to be painted, where the cage speaks of it, the share that is. */
  kept: number;
}

/** How well zones agree with the truth. @param zones  1 per vertex; undefined: everything is painted. */
export function score({ scene, truth }: Model, zones: Uint8Array | undefined): Score {
  const { indices } = scene.target;
  let [bare, suppressed, skin, kept] = [0, 0, 0, 0];
  for (let t = 0; t < indices.length; t += 3) {
    const area = areaOf(scene.target, t);
    for (const v of indices.subarray(t, t + 3)) {
      if (truth.ignore[v] === 1) continue;
      const isPainted = zones === undefined || zones[v] === 0;
      if (truth.ncz[v] === 1) {
        bare += area;
        if (!isPainted) suppressed += area;
      } else if (truth.offCage[v] !== 1) {
        skin += area;
        if (isPainted) kept += area;
      }
    }
  }
  return { suppressed: bare > 0 ? suppressed / bare : 1, kept: skin > 0 ? kept / skin : 1 };
}

/** How a segment stands to the floor of step 5'. */
export interface SegmentMeasure {
  firstVertex: number;
  /** What the truth wants of most of its area that is scored; `either` if none is. */
  wanted: 'painted' | 'bare' | 'either';
  /** F = C / E. */
  coverage: number;
  /** C / A, what the floor was measured by at first; it asked for 0.2. */
  coveredShare: number;
  /** How many times what the floor asks the segment reaches: from 1 on it passes. */
  reach: number;
  culled: boolean;
}

/** The floor's constants: shares of the segment's own area, and of all that is covered. */
const floor = { own: 0.2, all: 0.005 };

/** Measures every segment that covers anything. */
export function measureSegments({ scene, truth }: Model, answer: Answer): SegmentMeasure[] {
  const { indices } = scene.target;
  const wishes = answer.sums.map(() => ({ painted: 0, bare: 0 }));
  const first = answer.sums.map(() => Infinity);
  for (let t = 0; t < indices.length; t += 3) {
    const area = areaOf(scene.target, t);
    for (const v of indices.subarray(t, t + 3)) {
      const segment = answer.segments[v]!;
      first[segment] = Math.min(first[segment]!, v);
      if (truth.ignore[v] !== 1) wishes[segment]![truth.ncz[v] === 1 ? 'bare' : 'painted'] += area;
    }
  }
  const allCovered = answer.sums.reduce((sum, { covered }) => sum + covered, 0);
  return answer.sums.flatMap(({ area, exposed, covered, sunk, culled }, s) => {
    if (!(covered > 0)) return [];
    const { painted, bare } = wishes[s]!;
    const counted = (sunk * covered) / exposed;
    return [
      {
        firstVertex: first[s]!,
        wanted: painted + bare === 0 ? 'either' : bare > painted ? 'bare' : 'painted',
        coverage: covered / exposed,
        coveredShare: covered / area,
        reach: Math.max(counted / (floor.own * area), counted / (floor.all * allCovered)),
        culled,
      },
    ];
  });
}

/** The share of the painted area whose texture is smeared, with UVs per vertex and with UVs per corner. */
export interface Smear {
  vertex: number;
  corner: number;
}

// A triangle is smeared if an edge is longer in the texture than four times what the cage under its ends explains.
const kSmear = 4;
const kSlack = 0.005; // in UV

/** How much of what is painted is smeared. */
export function smear({ cage, target }: Scene, answer: Answer): Smear {
  const stretches = stretchesOf(cage);
  let [painted, byVertex, byCorner] = [0, 0, 0];
  for (let t = 0; t < target.indices.length; t += 3) {
    if (answer.cosmeticTriangles[t / 3] !== 1) continue;
    const area = areaOf(target, t);
    painted += area;
    const isSmeared = (u: (corner: number, k: number) => number): boolean =>
      [0, 1, 2].some((c) => {
        const d = (c + 1) % 3;
        const [v, w] = [target.indices[t + c]!, target.indices[t + d]!];
        const stretch = Math.max(stretches[answer.triangles[v]!]!, stretches[answer.triangles[w]!]!);
        const explained = stretch * (distance(target.positions, v, w) + Math.abs(answer.distances[v]! - answer.distances[w]!));
        return Math.hypot(u(c, 0) - u(d, 0), u(c, 1) - u(d, 1)) > kSmear * explained + kSlack;
      });
    if (isSmeared((c, k) => answer.uvs[target.indices[t + c]! * 2 + k]!)) byVertex += area;
    if (isSmeared((c, k) => answer.cornerUvs[(t + c) * 2 + k]!)) byCorner += area;
  }
  return painted > 0 ? { vertex: byVertex / painted, corner: byCorner / painted } : { vertex: 0, corner: 0 };
}

/** Per triangle of the cage: the most UV per length of its edges. */
function stretchesOf({ indices, positions, uvs }: SceneMesh): Float64Array {
  if (uvs === undefined) throw new Error('the cage has no UVs');
  const stretches = new Float64Array(indices.length / 3);
  for (let i = 0; i < indices.length; i++) {
    const t = Math.floor(i / 3);
    const [v, w] = [indices[i]!, indices[3 * t + ((i + 1) % 3)]!];
    const length = distance(positions, v, w);
    if (length > 0) stretches[t] = Math.max(stretches[t]!, Math.hypot(uvs[2 * v]! - uvs[2 * w]!, uvs[2 * v + 1]! - uvs[2 * w + 1]!) / length);
  }
  return stretches;
}

function distance(p: Float32Array, v: number, w: number): number {
  return Math.hypot(p[3 * v]! - p[3 * w]!, p[3 * v + 1]! - p[3 * w + 1]!, p[3 * v + 2]! - p[3 * w + 2]!);
}

/** The area of the triangle whose corners begin at `indices[t]`. */
function areaOf({ positions: p, indices }: SceneMesh, t: number): number {
  const [a, b, c] = [indices[t]! * 3, indices[t + 1]! * 3, indices[t + 2]! * 3];
  const e = [0, 1, 2].map((k) => p[b + k]! - p[a + k]!) as [number, number, number];
  const f = [0, 1, 2].map((k) => p[c + k]! - p[a + k]!) as [number, number, number];
  return Math.hypot(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]) / 2;
}

/** The diagonal of the box of a mesh. */
export function diagonalOf({ positions }: SceneMesh): number {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3]!, x);
    high[i % 3] = Math.max(high[i % 3]!, x);
  });
  return Math.hypot(...high.map((x, k) => x - low[k]!));
}
