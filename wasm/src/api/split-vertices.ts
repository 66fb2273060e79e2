import { callCore } from '../core/engine.js';
import { CagecastError, show } from './error.js';
import { checkMesh, type Mesh } from './mesh.js';

/** A mesh whose vertices are split wherever the UVs of their corners differ. Every array is the caller's own. */
export interface SplitVertices {
  /** 1 per new vertex: the vertex that it is a copy of. In the order in which `indices` uses them. */
  sources: Uint32Array<ArrayBuffer>;
  /** As many as before, into the new vertices. */
  indices: Uint32Array<ArrayBuffer>;
  /** 2 per new vertex. */
  uvs: Float32Array<ArrayBuffer>;
}

/**
 * Splits the vertices of a target so that every corner of a triangle has the UV that is given for it. Corners of a vertex
 * that agree share one new vertex; vertices that no triangle uses are left out. Everything else about a new vertex
 * (position, normal, skin weights, morph deltas, zone) is that of its source.
 *
 * @param target     What the transfer was made to; only its indices and the number of its vertices count.
 * @param cornerUvs  2 per index: `result.cornerUvs`, of a transfer with `seams: 'corner'`.
 * @throws {CagecastError} `cornerUvCountMismatch`, and for an unusable target.
 *
 * @example
 * const { cornerUvs, zones } = transfer(cage, target);
 * const { sources, indices, uvs } = splitVertices(target, cornerUvs);
 * const splitZones = Uint8Array.from(sources, (v) => zones[v]);
 */
export function splitVertices(target: Mesh, cornerUvs: Float32Array): SplitVertices {
  const mesh = checkMesh('splitVertices', 'target', target);
  if (!(cornerUvs instanceof Float32Array))
    throw new CagecastError('badArgument', `splitVertices: cornerUvs is ${show(cornerUvs)}, not a Float32Array`);
  if (cornerUvs.length !== 2 * mesh.indices.length) {
    throw new CagecastError(
      'cornerUvCountMismatch',
      `splitVertices: cornerUvs has ${cornerUvs.length} numbers, not 2 for each of ${mesh.indices.length} corners`,
      cornerUvs.length,
    );
  }
  return callCore('splitVertices', ({ workspace }) => workspace.splitVertices(mesh, cornerUvs));
}
