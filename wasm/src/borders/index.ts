/**
 * Exact borders: the target's triangles, cut where what is painted ends.
 * @module cagecast/borders
 */

import { checkAnswer } from '../answer.js';
import { callCore, init } from '../engine.js';
import { CagecastError, show } from '../error.js';
import type { Mesh, TransferOptions, TransferResult } from '../index.js';
import { type CheckedMesh, checkMesh, count } from '../mesh.js';
import { checkOptions } from '../options.js';

/**
 * A target that was cut. Its vertices keep their numbers, new ones come after them; an edge is cut at the same places for all
 * triangles on it, so that the surface stays as watertight as it was. Every array is the caller's own.
 */
export interface CutTarget {
  /** 3 per new vertex: the vertices of the target that it is a blend of, corners of one triangle. One may come twice. */
  sources: Uint32Array<ArrayBuffer>;
  /** 3 per new vertex: how much of each; they add up to 1. */
  weights: Float32Array<ArrayBuffer>;
  /** 3 per triangle. */
  indices: Uint32Array<ArrayBuffer>;
  /** 1 per triangle: the triangle of the target that it is a part of. In order. */
  triangles: Uint32Array<ArrayBuffer>;
  /** 2 per vertex, new ones included: its place in the cage's texture. */
  uvs: Float32Array<ArrayBuffer>;
  /** 2 per index, with `seams: 'corner'`; else empty. */
  cornerUvs: Float32Array<ArrayBuffer>;
  /** 1 per vertex, a `Zone`; those on the border of a hole are cosmetic. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per triangle: 1 if it may be painted. */
  cosmeticTriangles: Uint8Array<ArrayBuffer>;
}

/**
 * Cuts a target where rims of the cage are projected to it, and, with `seams: 'corner'`, where seams of the texture are, and
 * transfers to what is left: no triangle lies on two sides of a border. Segments pass or not as they did. With
 * `projection: 'nearestVertex'` nothing is cut.
 *
 * It needs no `init()`: it has a WebAssembly module of its own, which its first call compiles. Takes about a transfer, and some
 * twenty searches for a nearest point for each edge that is cut.
 *
 * @param cage     As for `transfer`.
 * @param target   As for `transfer`. Of its attributes, a new vertex has the blend of its `sources` by `weights`.
 * @param result   What `transfer` gave for the same cage, target and options.
 * @param options  Those of the transfer; `locks` are in the result already.
 * @throws {CagecastError} `resultMismatch` if the result is not of this target; else as `transfer` and `init` do.
 *
 * @example
 * const result = transfer(cage, target);
 * const { indices, uvs, cosmeticTriangles } = await cutBorders(cage, target, result);
 */
export async function cutBorders(
  cage: Mesh,
  target: Mesh,
  result: Pick<TransferResult, 'zones' | 'segments' | 'segmentStats'>,
  options?: TransferOptions,
): Promise<CutTarget> {
  await init();
  const checked = checkOptions('cutBorders', options);
  const [cageMesh, targetMesh] = [checkMesh('cutBorders', 'cage', cage), checkMesh('cutBorders', 'target', target)];
  const decided = checkResult(result, targetMesh);
  const answer = callCore('cutBorders', (core) => core.cutBorders(cageMesh, targetMesh, checked.core, decided));
  checkAnswer('cutBorders', answer, cageMesh, targetMesh, checked);
  const { sources, weights, indices, triangles, uvs, cornerUvs, zones, cosmeticTriangles } = answer;
  return { sources, weights, indices, triangles, uvs, cornerUvs, zones, cosmeticTriangles };
}

/** Checks that a result is one, and of this target: the core trusts what is in it. */
function checkResult(result: unknown, { positions }: CheckedMesh) {
  const wrong = (text: string) =>
    new CagecastError('badArgument', `cutBorders: result${text}; pass what transfer() returned`);
  if (typeof result !== 'object' || result === null) throw wrong(` is ${show(result)}`);
  const { zones, segments, segmentStats } = result as Partial<TransferResult>;
  if (!(zones instanceof Uint8Array)) throw wrong(`.zones is ${show(zones)}, not a Uint8Array`);
  if (!(segments instanceof Uint32Array)) throw wrong(`.segments is ${show(segments)}, not a Uint32Array`);
  if (!Array.isArray(segmentStats)) throw wrong(`.segmentStats is ${show(segmentStats)}, not an array`);
  const mismatch = (text: string, at: number) => new CagecastError('resultMismatch', `cutBorders: result.${text}`, at);
  for (const [name, { length }] of Object.entries({ zones, segments })) {
    if (length !== Math.floor(positions.length / 3))
      throw mismatch(
        `${name} has ${length} entries, not 1 for each of ${count(positions.length / 3, 'vertex')} of target`,
        length,
      );
  }
  const unknown = zones.findIndex((zone) => zone > 3);
  if (unknown >= 0) throw mismatch(`zones[${unknown}] = ${zones[unknown]} is not a zone (0..3)`, unknown);
  const stray = segments.findIndex((segment) => segment >= segmentStats.length);
  if (stray >= 0)
    throw mismatch(`segments[${stray}] = ${segments[stray]} is out of range (${segmentStats.length} segments)`, stray);
  return {
    zones,
    segments,
    culledSegments: Uint8Array.from(segmentStats, (segment) => Number(segment?.culled === true)),
  };
}
