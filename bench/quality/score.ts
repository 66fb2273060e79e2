import { cutBorders, type PresetOptions, project, type TransferResult } from 'cagecast';
import { boxOf, doubleAreaNormal, length, minus, pointAt } from '../../wasm/src/inspect/geometry.js';
import { blend } from '../../wasm/src/parts/blend.js';
import type { Scene, SceneMesh } from '../scene-file.js';
import type { Decision } from './methods.js';
import type { Model } from './models.js';

/** How well a decision agrees with the truth. */
export interface Score {
  /** Of the area that must not be painted, the share whose vertices are not. A third of each triangle goes to each corner. */
  suppressed: number;
  /** Of the area that is to be painted, where the cage speaks of it, the share whose vertices are. */
  kept: number;
  /** Of the pixels that show the model, the share that shows paint where none must be. */
  forbidden: number;
  /** Of the pixels that show what is to be painted, where the cage speaks of it, the share that shows no paint. */
  bare: number;
}

/** Scores a decision. @param pixels  1 per triangle corner, of `visiblePixels`. */
export function score({ scene, truth }: Model, pixels: Uint32Array, { zones, cosmeticTriangles }: Decision): Score {
  const { indices } = scene.target;
  const areas = triangleAreas(scene.target);
  const byArea = tally(
    truth,
    indices,
    (corner) => areas[Math.floor(corner / 3)]!,
    (corner) => zones[indices[corner]!] === 0,
  );
  const byPixel = tally(
    truth,
    indices,
    (corner) => pixels[corner]!,
    (corner) => cosmeticTriangles[Math.floor(corner / 3)] === 1,
  );
  const seen = pixels.reduce((sum, count) => sum + count, 0);
  return {
    suppressed: byArea.ncz > 0 ? 1 - byArea.nczPainted / byArea.ncz : 1,
    kept: byArea.skin > 0 ? byArea.skinPainted / byArea.skin : 1,
    forbidden: seen > 0 ? byPixel.nczPainted / seen : 0,
    bare: byPixel.skin > 0 ? 1 - byPixel.skinPainted / byPixel.skin : 0,
  };
}

/** Adds up the weights of the corners that must not be painted, and of those that are to be: all of them, and the painted ones. */
function tally(
  { ignore, ncz, offCage }: Model['truth'],
  indices: Uint32Array,
  weightOf: (corner: number) => number,
  isPainted: (corner: number) => boolean,
): Record<'ncz' | 'nczPainted' | 'skin' | 'skinPainted', number> {
  const sums = { ncz: 0, nczPainted: 0, skin: 0, skinPainted: 0 };
  indices.forEach((v, corner) => {
    if (ignore[v] === 1) return;
    const weight = weightOf(corner);
    if (ncz[v] === 1) {
      sums.ncz += weight;
      if (isPainted(corner)) sums.nczPainted += weight;
    } else if (offCage[v] !== 1) {
      sums.skin += weight;
      if (isPainted(corner)) sums.skinPainted += weight;
    }
  });
  return sums;
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

/** Measures every segment that covers anything. */
export function measureSegments(
  { scene, truth }: Model,
  { segments, segmentStats }: TransferResult,
  limits: PresetOptions,
): SegmentMeasure[] {
  const { indices } = scene.target;
  const areas = triangleAreas(scene.target);
  const wishes = segmentStats.map(() => ({ painted: 0, bare: 0 }));
  const first = segmentStats.map(() => Infinity);
  indices.forEach((v, corner) => {
    const segment = segments[v]!;
    first[segment] = Math.min(first[segment]!, v);
    if (truth.ignore[v] !== 1)
      wishes[segment]![truth.ncz[v] === 1 ? 'bare' : 'painted'] += areas[Math.floor(corner / 3)]!;
  });
  const allCovered = segmentStats.reduce((sum, { coveredArea }) => sum + coveredArea, 0);
  return segmentStats.flatMap(({ area, exposedArea, coveredArea, coverage, depthWeightedArea, culled }, s) => {
    if (!(coveredArea > 0)) return [];
    const { painted, bare } = wishes[s]!;
    const counted = depthWeightedArea * coverage;
    const ofAll = Math.min(
      counted / (limits.steps.minOfAll * allCovered),
      (limits.steps.maxUncovered * exposedArea) / (exposedArea - coveredArea),
    );
    return [
      {
        firstVertex: first[s]!,
        wanted: painted + bare === 0 ? 'either' : bare > painted ? 'bare' : 'painted',
        coverage,
        coveredShare: coveredArea / area,
        reach: Math.max(counted / (limits.minCovered * area), ofAll),
        culled,
      },
    ];
  });
}

/** The share of the painted area whose texture is smeared: with UVs per vertex, with UVs per corner, and with borders that are cut. */
export interface Smear {
  vertex: number;
  corner: number;
  cut: number;
}

/** How much of what is painted is smeared. */
export async function smear({ cage, target }: Scene, result: TransferResult): Promise<Smear> {
  const { uvs, cornerUvs } = result;
  const cut = cutBorders(cage, target, result);
  const pieces = { positions: blend(target.positions, 3, cut), indices: cut.indices };
  const ofPieces = { ...project(cage, pieces, { preset: 'paper' }), cosmeticTriangles: cut.cosmeticTriangles };
  return {
    vertex: smearedShare(cage, target, result, (corner) => uvs.subarray(2 * target.indices[corner]!)),
    corner: smearedShare(cage, target, result, (corner) => cornerUvs.subarray(2 * corner)),
    cut: smearedShare(cage, pieces, ofPieces, (corner) => cut.cornerUvs.subarray(2 * corner)),
  };
}

// A triangle is smeared if an edge is longer in the texture than four times what the cage under its ends explains.
const kSmear = 4;
const kSlack = 0.005; // in UV

/** @param uvOf  Of a corner of a triangle: an array that begins with it. */
function smearedShare(
  cage: SceneMesh,
  target: SceneMesh,
  { cosmeticTriangles, triangles, distances }: Pick<TransferResult, 'cosmeticTriangles' | 'triangles' | 'distances'>,
  uvOf: (corner: number) => Float32Array,
): number {
  const stretches = stretchesOf(cage);
  const { positions, indices } = target;
  let [painted, smeared] = [0, 0];
  triangleAreas(target).forEach((area, t) => {
    if (cosmeticTriangles[t] !== 1) return;
    painted += area;
    const isSmeared = [0, 1, 2].some((k) => {
      const [c, d] = [3 * t + k, 3 * t + ((k + 1) % 3)];
      const [v, w] = [indices[c]!, indices[d]!];
      const stretch = Math.max(stretches[triangles[v]!]!, stretches[triangles[w]!]!);
      const explained = stretch * (distance(positions, v, w) + Math.abs(distances[v]! - distances[w]!));
      const [from, to] = [uvOf(c), uvOf(d)];
      return Math.hypot(from[0]! - to[0]!, from[1]! - to[1]!) > kSmear * explained + kSlack;
    });
    if (isSmeared) smeared += area;
  });
  return painted > 0 ? smeared / painted : 0;
}

/** Per triangle of the cage: the most UV per length of its edges. */
function stretchesOf({ indices, positions, uvs }: SceneMesh): Float64Array {
  if (uvs === undefined) throw new Error('the cage has no UVs');
  const stretches = new Float64Array(indices.length / 3);
  for (let i = 0; i < indices.length; i++) {
    const t = Math.floor(i / 3);
    const [v, w] = [indices[i]!, indices[3 * t + ((i + 1) % 3)]!];
    const edge = distance(positions, v, w);
    if (edge > 0)
      stretches[t] = Math.max(
        stretches[t]!,
        Math.hypot(uvs[2 * v]! - uvs[2 * w]!, uvs[2 * v + 1]! - uvs[2 * w + 1]!) / edge,
      );
  }
  return stretches;
}

const distance = (p: Float32Array, v: number, w: number): number => length(minus(pointAt(p, v), pointAt(p, w)));

function triangleAreas({ positions: p, indices }: SceneMesh): Float64Array {
  return Float64Array.from({ length: indices.length / 3 }, (_, t) => {
    const [a, b, c] = [0, 1, 2].map((k) => pointAt(p, indices[3 * t + k]!)) as [Corner, Corner, Corner];
    return length(doubleAreaNormal(a, b, c)) / 2;
  });
}
type Corner = ReturnType<typeof pointAt>;

/** The same scene with its cage moved along an axis. @param by  Share of the target's diagonal. */
export function shifted(scene: Scene, axis: number, by: number): Scene {
  const { diagonal } = boxOf(scene.target.positions);
  return {
    ...scene,
    cage: { ...scene.cage, positions: scene.cage.positions.map((x, i) => (i % 3 === axis ? x + by * diagonal : x)) },
  };
}
