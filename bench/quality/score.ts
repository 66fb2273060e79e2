import { cutBorders, type Mesh, project, type TransferResult } from 'cagecast';
import { applySplit } from 'cagecast/engines';
import {
  boxOf,
  doubleAreaNormal,
  length,
  minus,
  pointAt,
  type Vector,
  vertexAreas,
} from '../../wasm/src/inspect/geometry.js';
import type { Labels } from '../public/labels.js';
import type { Model } from './models.js';

/** What a way to transfer paints: of a result, or made up. */
export type Decision = Pick<TransferResult, 'zones' | 'cosmeticTriangles'>;

/** How well a decision agrees with the truth. */
export interface Score {
  /** Of the area that must not be painted, the share whose vertices are not. A third of each triangle goes to each corner. */
  suppressed: number;
  /** Of the area that is to be painted, where the cage speaks of it, the share whose vertices are. */
  kept: number;
}

/** The same in pictures. */
export interface PictureScore {
  /** Of the pixels that show the model, the share that shows paint where none must be. */
  forbidden: number;
  /** The share of pixels without paint, among those of the surface to be painted about which the cage speaks. */
  bare: number;
}

/** Scores zones, by area. */
export function score(target: Mesh, truth: Labels, zones: Uint8Array): Score {
  const sums = tally(
    truth,
    vertexAreas(target),
    (v) => v,
    (v) => zones[v] === 0,
  );
  return {
    suppressed: sums.ncz > 0 ? 1 - sums.nczPainted / sums.ncz : 1,
    kept: sums.skin > 0 ? sums.skinPainted / sums.skin : 1,
  };
}

/** Scores what pictures show. @param pixels  1 per triangle corner, of `visiblePixels`. */
export function pictureScore({ scene, truth }: Model, pixels: Uint32Array, decision: Decision): PictureScore {
  const sums = tally(
    truth,
    pixels,
    (corner) => scene.target.indices[corner]!,
    (corner) => decision.cosmeticTriangles[Math.floor(corner / 3)] === 1,
  );
  const seen = pixels.reduce((sum, count) => sum + count, 0);
  return {
    forbidden: seen > 0 ? sums.nczPainted / seen : 0,
    bare: sums.skin > 0 ? 1 - sums.skinPainted / sums.skin : 0,
  };
}

/** Adds up weights of what must not be painted, and of what is to be: all of them, and the painted ones. */
function tally(
  { ignore, ncz, offCage }: Labels,
  weights: ArrayLike<number>,
  vertexOf: (i: number) => number,
  isPainted: (i: number) => boolean,
): Record<'ncz' | 'nczPainted' | 'skin' | 'skinPainted', number> {
  const sums = { ncz: 0, nczPainted: 0, skin: 0, skinPainted: 0 };
  for (let i = 0; i < weights.length; ++i) {
    const v = vertexOf(i);
    if (ignore[v] === 1 || (ncz[v] !== 1 && offCage[v] === 1)) continue;
    const what = ncz[v] === 1 ? 'ncz' : 'skin';
    sums[what] += weights[i]!;
    if (isPainted(i)) sums[`${what}Painted`] += weights[i]!;
  }
  return sums;
}

/** The share of the painted area whose texture is smeared: with UVs per vertex, with UVs per corner, and with borders that are cut. */
export interface Smear {
  vertex: number;
  corner: number;
  cut: number;
}

/** How much of what is painted is smeared. */
export function smear({ cage, target }: Model['scene'], result: TransferResult): Smear {
  const { uvs, cornerUvs } = result;
  const cut = cutBorders(cage, target, result);
  const sources = Uint32Array.from(cut.zones.keys());
  const positions = applySplit(target.positions, 3, { sources, copies: 0, cut });
  const pieces = { positions, indices: cut.indices };
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
  cage: Mesh,
  target: Mesh,
  { cosmeticTriangles, triangles, distances }: Pick<TransferResult, 'cosmeticTriangles' | 'triangles' | 'distances'>,
  uvOf: (corner: number) => Float32Array,
): number {
  const stretches = stretchesOf(cage);
  const { positions, indices } = target;
  let [painted, smeared] = [0, 0];
  for (let t = 0; t < cosmeticTriangles.length; ++t) {
    if (cosmeticTriangles[t] !== 1) continue;
    const [a, b, c] = [0, 1, 2].map((k) => pointAt(positions, indices[3 * t + k]!)) as [Vector, Vector, Vector];
    const area = length(doubleAreaNormal(a, b, c));
    painted += area;
    const isSmeared = [0, 1, 2].some((k) => {
      const [c, d] = [3 * t + k, 3 * t + ((k + 1) % 3)];
      const [v, w] = [indices[c]!, indices[d]!];
      const stretch = Math.max(stretches[triangles[v]!]!, stretches[triangles[w]!]!);
      const explained = stretch * (distance(positions, v, w) + Math.abs(distances[v]! - distances[w]!));
      return uvDistance(uvOf(c), uvOf(d)) > kSmear * explained + kSlack;
    });
    if (isSmeared) smeared += area;
  }
  return painted > 0 ? smeared / painted : 0;
}

/** Per triangle of the cage: the most UV per length of its edges. */
function stretchesOf({ indices, positions, uvs = new Float32Array() }: Mesh): Float64Array {
  const stretches = new Float64Array(indices.length / 3);
  indices.forEach((v, i) => {
    const t = Math.floor(i / 3);
    const w = indices[3 * t + ((i + 1) % 3)]!;
    const edge = distance(positions, v, w);
    const inTexture = uvDistance(uvs.subarray(2 * v), uvs.subarray(2 * w));
    if (edge > 0) stretches[t] = Math.max(stretches[t]!, inTexture / edge);
  });
  return stretches;
}

const distance = (p: Float32Array, v: number, w: number): number => length(minus(pointAt(p, v), pointAt(p, w)));
const uvDistance = (a: Float32Array, b: Float32Array): number => Math.hypot(a[0]! - b[0]!, a[1]! - b[1]!);

/** The same scene with its cage moved along an axis. @param by  Share of the target's diagonal. */
export function shifted(scene: Model['scene'], axis: number, by: number): Model['scene'] {
  const { diagonal } = boxOf(scene.target.positions);
  return {
    ...scene,
    cage: { ...scene.cage, positions: scene.cage.positions.map((x, i) => (i % 3 === axis ? x + by * diagonal : x)) },
  };
}
