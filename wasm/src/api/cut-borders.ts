import { callCore, useCore } from '../core/engine.js';
import { CagecastError, show } from '../core/error.js';
import type { CheckedMesh, CoreDecision } from '../core/module.js';
import { plainArray, showArray } from '../core/typed-arrays.js';
import { Zone } from '../generated/enums.js';
import { checkMesh, count, type Mesh } from './mesh.js';
import { checkOptions, type TransferOptions } from './options.js';
import type { TransferResult } from './result.js';

/**
 * A target whose triangles are cut along the borders of the paint. The target's vertices keep their numbers, and new ones follow.
 * All triangles at an edge are cut at the same places, so that the surface stays as watertight as it was. The caller owns every
 * array.
 */
export interface CutTarget {
  /** 3 per new vertex: the vertices of the target that it blends, which are corners of one triangle. A vertex may occur twice. */
  sources: Uint32Array<ArrayBuffer>;
  /** 3 per new vertex: how much of each source; they add up to 1. */
  weights: Float32Array<ArrayBuffer>;
  /** 3 per triangle. */
  indices: Uint32Array<ArrayBuffer>;
  /** 1 per triangle: the triangle of the target that it was cut from; ascending. */
  triangles: Uint32Array<ArrayBuffer>;
  /** 2 per vertex, including new ones: its UV in the cage's texture. */
  uvs: Float32Array<ArrayBuffer>;
  /** 2 per index, with `seams: 'corner'`; else, and with `steps.projection: 'nearestVertex'`, empty. */
  cornerUvs: Float32Array<ArrayBuffer>;
  /** 1 per vertex, a `Zone`; vertices on the border of a hole are cosmetic. */
  zones: Uint8Array<ArrayBuffer>;
  /** 1 per triangle: 1 if it may be painted. */
  cosmeticTriangles: Uint8Array<ArrayBuffer>;
}

/**
 * Cuts a target along the projected borders of the cage and its holes, and, with `seams: 'corner'`, along the seams of the
 * texture, so that every triangle lies on one side. Which segments are culled does not change. With
 * `steps.projection: 'nearestVertex'` nothing is cut.
 *
 * Cost: that of a transfer, about twenty nearest-point searches per cut edge, and a search for borders that no edge meets, which
 * takes seconds for large triangles under a finely divided cage.
 *
 * @param cage     As for `transfer`.
 * @param target   As for `transfer`. The attributes of a new vertex are those of its `sources`, blended by `weights`.
 * @param result   What `transfer` returned for the same cage, target and options.
 * @param options  The options of the transfer. `locks`, and parts that are kept or excluded, do not count: the result has their effect.
 * Triangles that a mask decides are decided as a whole.
 * @throws {CagecastError} `resultMismatch` if the result does not belong to this target; `bordersTooComplex` if the cut takes more
 * comparisons than its limit (docs/borders.md): leave the triangles whole then; else as `transfer` does.
 *
 * @example
 * const result = transfer(cage, target);
 * const { indices, uvs, cosmeticTriangles } = cutBorders(cage, target, result);
 */
export function cutBorders(
  cage: Mesh,
  target: Mesh,
  result: Pick<TransferResult, 'zones' | 'segments' | 'segmentStats'>,
  options?: TransferOptions,
): CutTarget {
  const { core, overrides } = checkOptions('cutBorders', options, undefined, target?.names);
  const [cageMesh, targetMesh] = [checkMesh('cutBorders', 'cage', cage), checkMesh('cutBorders', 'target', target)];
  const decision = checkResult(result, targetMesh);
  return callCore('cutBorders', ({ workspace }) =>
    workspace.cutBorders(cageMesh, targetMesh, decision, core, overrides),
  );
}

/** Checks that a result is complete and belongs to this target, and names the entry at fault, which the core cannot. */
function checkResult(result: unknown, { positions }: CheckedMesh): CoreDecision {
  const wrong = (text: string) =>
    new CagecastError('badArgument', 'cutBorders', `result${text}; pass what transfer() returned`, {
      argument: 'result',
    });
  if (typeof result !== 'object' || result === null) throw wrong(` is ${show(result)}`);
  const given = result as Partial<TransferResult>;
  const zones = plainArray(given.zones, 'Uint8Array');
  if (!zones) throw wrong(`.zones is ${showArray(given.zones, 'Uint8Array')}, not a Uint8Array`);
  const segments = plainArray(given.segments, 'Uint32Array');
  if (!segments) throw wrong(`.segments is ${showArray(given.segments, 'Uint32Array')}, not a Uint32Array`);
  const { segmentStats } = given;
  if (!Array.isArray(segmentStats)) throw wrong(`.segmentStats is ${show(segmentStats)}, not an array`);
  const mismatch = (text: string, at: number) =>
    new CagecastError('resultMismatch', 'cutBorders', `result.${text}`, { argument: 'result', at });
  for (const [name, { length }] of Object.entries({ zones, segments })) {
    if (length !== Math.floor(positions.length / 3))
      throw mismatch(
        `${name} has ${length} entries, not 1 for each of ${count(positions.length / 3, 'vertex')} of target`,
        length,
      );
  }
  const culled = Array.from(segmentStats, (segment) => segment?.culled === true);
  // Last: getters of the segments may have written to the arrays.
  const unknown = zones.findIndex((zone) => zone > Zone.Culled);
  if (unknown >= 0) throw mismatch(`zones[${unknown}] = ${zones[unknown]} is not a zone (0..${Zone.Culled})`, unknown);
  const stray = segments.findIndex((segment) => segment >= culled.length);
  if (stray >= 0)
    throw mismatch(`segments[${stray}] = ${segments[stray]} is out of range (${culled.length} segments)`, stray);
  const culledBy = useCore('cutBorders', ({ module }) => {
    const { none, coverage } = module['CulledBy']!;
    return culled.map((is) => (is ? coverage! : none!));
  });
  return { zones, segments, culledBy };
}
