import type { Mesh } from '../api/mesh.js';
import type { Vector } from '../inspect/geometry.js';
import type { Matrix } from '../parts/affine.js';
import { joinParts } from '../parts/join-parts.js';
import { fromOrigin, type Origin, originOf } from '../parts/origin.js';
import { morphed } from '../parts/points.js';
import { type AccessorData, decodeFloats } from './accessor.js';
import { InputError } from './input-error.js';
import { layUvs, type UvLayout } from './uv-layout.js';

/** One primitive of one node, and the ranges of its elements in the joined arrays. */
export interface Piece {
  /** The name of its node, followed by that of its material if they differ: "head", "head/skin". */
  name: string;
  /** The names that select it: of its node, its mesh and its material, and `name`. */
  aliases: string[];
  /** The matrix from its own space to that of the arrays, column-major; of a skinned mesh, in the bind pose. */
  matrix: Matrix;
  firstVertex: number;
  vertexCount: number;
  firstTriangle: number;
  triangleCount: number;
  /** Its positions as stored, decoded, in the shape that its morph targets give it, 3 per vertex. */
  localPositions: Float32Array;
  /** Its triangles among its own vertices, with the winding that they have in the file. */
  localIndices: Uint32Array;
}

/** A primitive of a node, as a reader finds it. */
interface Found {
  node: string | undefined;
  mesh: string | undefined;
  material: string | undefined;
  /** What it is called if neither node nor mesh has a name. */
  place: string;
  /** How many primitives its mesh has. */
  primitives: number;
  matrix: Matrix;
  positions: Float32Array;
  indices: Uint32Array;
}

/** The piece that a primitive makes after others. */
export function nextPiece(pieces: readonly Piece[], { node, mesh, material, ...found }: Found): Piece {
  const own = node || mesh || found.place;
  const name = material && material !== own && found.primitives > 1 ? `${own}/${material}` : own;
  const [firstVertex, firstTriangle] = endOf(pieces);
  return {
    name,
    aliases: [...new Set([node, mesh, material, name])].filter((one) => one !== undefined && one !== '') as string[],
    matrix: found.matrix,
    firstVertex,
    vertexCount: found.positions.length / 3,
    firstTriangle,
    triangleCount: found.indices.length / 3,
    localPositions: found.positions,
    localIndices: found.indices,
  };
}

/** Numbers the elements of pieces anew, as some were left out. */
export function renumber(pieces: readonly Piece[]): void {
  pieces.forEach((piece, p) => ([piece.firstVertex, piece.firstTriangle] = endOf(pieces.slice(p - 1, p))));
}

/** How many vertices and triangles there are in pieces. */
export function endOf(
  pieces: readonly Pick<Piece, 'firstVertex' | 'vertexCount' | 'firstTriangle' | 'triangleCount'>[],
): [vertices: number, triangles: number] {
  const last = pieces.at(-1);
  return last ? [last.firstVertex + last.vertexCount, last.firstTriangle + last.triangleCount] : [0, 0];
}

const kTriangles = 4;
const kTriangleStrip = 5;
const kTriangleFan = 6;

/** Whether a primitive of this mode consists of triangles: a list, a strip or a fan. */
export const hasTriangles = (mode: number): boolean => mode >= kTriangles && mode <= kTriangleFan;

/** Places pieces around an origin. @returns where that is in the scene. */
export function moveTo(pieces: readonly Piece[], origin: Origin): Vector {
  const place =
    origin === 'own' ? originOf(pieces.map(({ localPositions: points, matrix }) => ({ points, matrix }))) : origin;
  for (const piece of pieces) piece.matrix = fromOrigin(piece.matrix, place);
  return place;
}

/**
 * Joins pieces into arrays, with a group for each. Vertices keep their order, transforms are applied in double
 * precision and rounded once, and the winding of mirrored pieces is reversed.
 */
export const joinPieces = (pieces: readonly Piece[]): Mesh & { indices: Uint32Array } => ({
  ...joinParts(
    pieces.map(({ localPositions: positions, localIndices: indices, matrix }) => ({ positions, indices, matrix })),
  ).mesh,
  names: pieces.map(({ name, aliases }) => [name, ...aliases]),
});

/** @throws {InputError} that names the first value of an attribute that is not a finite number. */
export function requireFinite(place: string, semantic: string, values: Float32Array, size: number): void {
  const bad = values.findIndex((value) => !Number.isFinite(value));
  if (bad >= 0)
    throw new InputError(
      `${place}: ${semantic} of vertex ${Math.floor(bad / size)} has ${values[bad]}, which is not a finite number`,
    );
}

/**
 * The positions of an accessor, in the shape that is shown.
 * @param place    Its primitive, for messages.
 * @param weights  Of its morph targets; those beyond are 0.
 * @param deltas   The positions of a morph target.
 * @throws {InputError} that names the vertex.
 */
export function decodePositions(
  place: string,
  accessor: AccessorData,
  weights: readonly number[],
  deltas: (target: number) => AccessorData | null | undefined,
): Float32Array {
  const decode = (path: string, one: AccessorData) => {
    if (one.getElementSize() !== 3) throw new InputError(`${place}.${path}.POSITION is ${one.getType()}, not VEC3`);
    return decodeFloats(one);
  };
  const morphs = weights.flatMap((weight, t) => {
    const found = weight === 0 ? undefined : deltas(t);
    return found ? [{ weight, deltas: decode(`targets[${t}]`, found) }] : [];
  });
  const positions = morphed(decode('attributes', accessor), morphs);
  requireFinite(place, 'POSITION', positions, 3);
  return positions;
}

/**
 * The triangles of a primitive, 3 corners each, strips and fans expanded.
 * @param array  Its indices; `null` if it has none.
 * @throws {InputError} that names the index.
 */
export function decodeTriangles(
  place: string,
  array: ArrayLike<number> | null,
  mode: number,
  vertexCount: number,
): Uint32Array {
  const corners = array ? Uint32Array.from(array) : Uint32Array.from({ length: vertexCount }, (_, v) => v);
  const bad = corners.findIndex((vertex) => vertex >= vertexCount);
  if (bad >= 0)
    throw new InputError(`${place}: indices[${bad}] = ${corners[bad]} is out of range (${vertexCount} vertices)`);
  if (mode === kTriangles) {
    if (corners.length % 3 !== 0) throw new InputError(`${place} has ${corners.length} corners, not 3 per triangle`);
    return corners;
  }
  const expanded = new Uint32Array(3 * Math.max(corners.length - 2, 0));
  for (let t = 0; t < expanded.length / 3; ++t) {
    // As the specification orders them: every other triangle of a strip turns; a fan goes round its first vertex.
    const [a, b, c] = mode === kTriangleStrip ? [t, t + 1 + (t % 2), t + 2 - (t % 2)] : [t + 1, t + 2, 0];
    expanded.set([corners[a]!, corners[b]!, corners[c]!], 3 * t);
  }
  return expanded;
}

/**
 * The UVs of a piece in the texture that they are laid on.
 * @param place  The piece, for messages.
 * @throws {InputError}
 */
export function decodeUvs(
  place: string,
  { set, transform }: UvLayout,
  accessor: AccessorData,
  vertexCount: number,
): Float32Array {
  if (accessor.getElementSize() !== 2)
    throw new InputError(`${place}.attributes.${set} is ${accessor.getType()}, not VEC2`);
  if (accessor.getCount() !== vertexCount)
    throw new InputError(`${place} has ${accessor.getCount()} ${set} for ${vertexCount} vertices`);
  const uvs = decodeFloats(accessor);
  return layUvs(uvs, transform);
}
