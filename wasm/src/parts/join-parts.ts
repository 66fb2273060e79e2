import type { Mesh } from '../api/index.js';
import { count } from '../api/mesh.js';
import { CagecastError, isRecord, show } from '../core/error.js';
import { determinant, isIdentity } from './affine.js';
import { movePoints } from './points.js';
import { type PartRange, turnOver } from './split-part.js';

/** A mesh of an engine, as it is stored. Its arrays are read, never changed. */
export interface PartArrays {
  /** 3 numbers per vertex, in its own space. */
  positions: ArrayLike<number>;
  /** 3 per triangle, counter-clockwise seen from outside in its own space. Default: each three vertices are a triangle. */
  indices?: ArrayLike<number> | null | undefined;
  /** 2 per vertex. Of a cage: where it is in the texture, whose first row of pixels is at v = 0. Default: none, of all parts. */
  uvs?: ArrayLike<number> | null | undefined;
  /** 16 numbers, column by column: from its own space to the one that cage and target share. Default: no change. */
  matrix?: ArrayLike<number> | undefined;
}

/**
 * Joins the meshes of a model into one, as `transfer` takes a cage or a target: each is a group, positions are in the common space, and
 * the triangles of mirrored ones are turned over.
 * @param parts  At least one.
 * @returns `mesh`, and `parts`: where each is in it, as `prepareParts` takes them.
 * @throws {CagecastError} `badArgument` that names the part, the value and what is needed.
 *
 * @example
 * const { mesh: cage } = joinParts([{ positions, indices, uvs, matrix: node.worldMatrix }]);
 */
export function joinParts(parts: readonly PartArrays[]): { mesh: Mesh & { indices: Uint32Array }; parts: PartRange[] } {
  if (!Array.isArray(parts)) throw wrong(`parts is ${show(parts)}, not an array`);
  const ranges: PartRange[] = [];
  let [vertices, triangles] = [0, 0];
  parts.forEach((part: PartArrays, p) => {
    const corners = check(part, p, !!parts[0]?.uvs);
    const mirrored = !!part.matrix && determinant(part.matrix) < 0;
    const [vertexCount, triangleCount] = [part.positions.length / 3, corners / 3];
    ranges.push({ firstVertex: vertices, vertexCount, firstTriangle: triangles, triangleCount, mirrored });
    vertices += vertexCount;
    triangles += triangleCount;
  });
  const positions = new Float32Array(3 * vertices);
  const indices = new Uint32Array(3 * triangles);
  const groups = new Uint32Array(vertices);
  const uvs = parts[0]?.uvs ? new Float32Array(2 * vertices) : undefined;
  parts.forEach((part: PartArrays, p) => {
    const { firstVertex, vertexCount, firstTriangle, triangleCount, mirrored } = ranges[p]!;
    const { matrix } = part;
    if (!matrix || isIdentity(matrix)) positions.set(part.positions, 3 * firstVertex);
    else movePoints(matrix, part.positions, positions, 3 * firstVertex);
    const own = indices.subarray(3 * firstTriangle, 3 * (firstTriangle + triangleCount));
    for (let i = 0; i < own.length; ++i) own[i] = firstVertex + (part.indices?.[i] ?? i);
    if (mirrored) turnOver(own);
    groups.fill(p, firstVertex, firstVertex + vertexCount);
    uvs?.set(part.uvs!, 2 * firstVertex);
  });
  return { mesh: { positions, indices, groups, ...(uvs && { uvs }) }, parts: ranges };
}

const wrong = (text: string, at = 0): CagecastError =>
  new CagecastError('badArgument', 'joinParts', text, { argument: 'parts', at });

/** @returns the number of the part's corners. */
function check(part: PartArrays, p: number, hasUvs: boolean): number {
  if (!isRecord(part)) throw wrong(`parts[${p}] is ${show(part)}, not an object`, p);
  const { positions, indices, uvs, matrix } = part;
  const lengthOf = (name: keyof PartArrays): number => {
    const { length } = Object(part[name]) as { length?: unknown };
    if (typeof length !== 'number' || typeof part[name] === 'string')
      throw wrong(`parts[${p}].${name} is ${show(part[name])}, not an array`, p);
    return length;
  };
  if (lengthOf('positions') % 3 !== 0)
    throw wrong(`parts[${p}].positions has ${positions.length} numbers, not 3 per vertex`, positions.length);
  const vertices = positions.length / 3;
  const corners = indices == null ? vertices : lengthOf('indices');
  if (corners % 3 !== 0)
    throw wrong(`parts[${p}] has ${corners} ${indices == null ? 'vertices' : 'indices'}, not 3 per triangle`, corners);
  // In the joined arrays an index too large would point into the next part.
  for (let i = 0; indices != null && i < corners; ++i)
    if (!(indices[i]! >= 0 && indices[i]! < vertices))
      throw wrong(`parts[${p}].indices[${i}] = ${show(indices[i])} is out of range (${count(vertices, 'vertex')})`, i);
  if (hasUvs !== (uvs != null)) throw wrong(`parts[${p}] ${hasUvs ? 'has no' : 'has'} uvs, unlike parts[0]`, p);
  if (uvs != null && lengthOf('uvs') !== 2 * vertices)
    throw wrong(
      `parts[${p}].uvs has ${uvs.length} numbers, not 2 for each of ${count(vertices, 'vertex')}`,
      uvs.length,
    );
  if (matrix !== undefined && lengthOf('matrix') !== 16)
    throw wrong(`parts[${p}].matrix has ${matrix.length} numbers, not 16`, matrix.length);
  return corners;
}
