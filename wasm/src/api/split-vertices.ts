import { callCore } from '../core/engine.js';
import { CagecastError } from '../core/error.js';
import { plainArray, showArray } from '../core/typed-arrays.js';
import { checkMesh, type Mesh } from './mesh.js';

/** A mesh whose vertices are split wherever the UVs of their corners differ. The caller owns every array. */
export interface SplitVertices {
  /** 1 per new vertex: the vertex that it copies. New vertices are in the order in which `indices` first uses them. */
  sources: Uint32Array<ArrayBuffer>;
  /** The same triangles, as indices of new vertices. */
  indices: Uint32Array<ArrayBuffer>;
  /** 2 per new vertex. */
  uvs: Float32Array<ArrayBuffer>;
}

/**
 * Splits the vertices of a target so that every corner of a triangle has the UV that is given for it. Corners at the
 * same vertex with the same UV share one new vertex; vertices that no triangle uses are left out. A new vertex has the position,
 * normal, skin weights, morph deltas and zone of its source.
 *
 * @param target     The target of the transfer; only its indices and the number of its vertices are used.
 * @param cornerUvs  2 per index: `result.cornerUvs`, from a transfer with `seams: 'corner'`.
 * @throws {CagecastError} `cornerUvCountMismatch`; and if the target cannot be used.
 *
 * @example
 * const { cornerUvs, zones } = transfer(cage, target);
 * const { sources, indices, uvs } = splitVertices(target, cornerUvs);
 * const splitZones = Uint8Array.from(sources, (v) => zones[v]);
 */
export function splitVertices(target: Mesh, cornerUvs: Float32Array): SplitVertices {
  const mesh = checkMesh('splitVertices', 'target', target);
  const uvs = plainArray(cornerUvs, 'Float32Array');
  if (!uvs)
    throw new CagecastError(
      'badArgument',
      'splitVertices',
      `cornerUvs is ${showArray(cornerUvs, 'Float32Array')}, not a Float32Array`,
      { argument: 'cornerUvs' },
    );
  if (uvs.length !== 2 * mesh.indices.length) {
    throw new CagecastError(
      'cornerUvCountMismatch',
      'splitVertices',
      `cornerUvs has ${uvs.length} numbers, not 2 for each of ${mesh.indices.length} corners`,
      { argument: 'cornerUvs', at: uvs.length },
    );
  }
  return callCore('splitVertices', ({ workspace }) => workspace.splitVertices(mesh, uvs));
}
