import type { Accessor, GLTF } from '@gltf-transform/core';
import type { Mesh } from '../mesh.js';
import { InputError } from './input-error.js';
import { determinant, identity, localMatrix, multiply, type Matrix } from './matrix.js';
import type { GltfFile } from './read.js';

/** One primitive of one node, and where its elements lie in the concatenated arrays. */
export interface Part {
  /** Its node's name, with its material's where that adds something: "head", "head/skin". */
  name: string;
  /** Its place in the file's JSON. */
  node: number;
  mesh: number;
  primitive: number;
  /** From its own space to the scene's, column by column; the identity for a skinned mesh. */
  matrix: Matrix;
  firstVertex: number;
  vertexCount: number;
  firstTriangle: number;
  triangleCount: number;
  /** Its positions as stored, decoded, 3 per vertex. */
  localPositions: Float32Array;
  /** Its triangles among its own vertices, with the winding that they have in the file. */
  localIndices: Uint32Array;
}

/** All triangles of a glTF's scene as arrays, and the parts they come from. */
export interface Extracted {
  /** With one group per part; with UVs if every primitive has a first set. */
  mesh: Mesh & { indices: Uint32Array };
  /** In the order of their vertices. */
  parts: Part[];
}

const triangles = 4;
const triangleStrip = 5;
const triangleFan = 6;

/**
 * Collects the triangles of a glTF's default scene (else its first), depth first, in the scene's space.
 *
 * Vertices keep their order and number; each primitive of each node is a group of its own. Transforms are applied in
 * double precision and rounded last; the winding of mirrored parts is turned, so that outside stays outside. A skinned
 * mesh is taken as it is stored, in its bind pose: as the format demands, the transform of its node does not move it.
 * Points and lines are left out, and so are morphs.

 * @throws {InputError} that names the file, the primitive and the element.
 */
export function extract(file: GltfFile): Extracted {
  try {
    const parts = listParts(file);
    const last = parts.at(-1);
    const vertexCount = last ? last.firstVertex + last.vertexCount : 0;
    const triangleCount = last ? last.firstTriangle + last.triangleCount : 0;
    const positions = new Float32Array(3 * vertexCount);
    const indices = new Uint32Array(3 * triangleCount);
    const groups = new Uint32Array(vertexCount);
    parts.forEach((part, group) => {
      placePositions(part, positions);
      placeIndices(part, indices);
      groups.fill(group, part.firstVertex, part.firstVertex + part.vertexCount);
    });
    const uvs = readUvs(file, parts, vertexCount);
    return { mesh: { positions, indices, groups, ...(uvs && { uvs }) }, parts };
  } catch (error) {
    throw error instanceof InputError ? error.in(file.path) : error;
  }
}

/** "meshes[0].primitives[1]", as it is found in the file's JSON. */
export function placeOf(part: Part): string {
  return `meshes[${part.mesh}].primitives[${part.primitive}]`;
}

/** The part that a vertex belongs to. */
export function partOf(parts: readonly Part[], vertex: number): Part | undefined {
  return parts.find((part) => vertex >= part.firstVertex && vertex < part.firstVertex + part.vertexCount);
}

function listParts(file: GltfFile): Part[] {
  const { meshes = [], nodes = [], materials = [] } = file.json;
  const parts: Part[] = [];
  let firstVertex = 0;
  let firstTriangle = 0;
  // A stack of its own: a chain of nodes may be longer than the one of JavaScript.
  const stack = roots(file.json).map((node) => ({ node, parent: identity })).reverse();
  for (let next = stack.pop(); next; next = stack.pop()) {
    const nodeDef = nodes[next.node]!;
    const matrix = multiply(next.parent, localMatrix(nodeDef));
    for (const child of [...(nodeDef.children ?? [])].reverse()) stack.push({ node: child, parent: matrix });
    if (nodeDef.mesh === undefined) continue;
    const meshDef = meshes[nodeDef.mesh]!;
    meshDef.primitives.forEach((primitive, p) => {
      const place = `meshes[${nodeDef.mesh}].primitives[${p}]`;
      const localPositions = readPositions(file, place, nodeDef.mesh!, p);
      if (localPositions === undefined) return;
      const localIndices = readTriangles(file, place, nodeDef.mesh!, p, localPositions.length / 3);
      if (localIndices === undefined) return;
      const name = nodeDef.name ?? meshDef.name ?? `nodes[${next.node}]`;
      const material = primitive.material === undefined ? undefined : materials[primitive.material]?.name;
      const part: Part = {
        name: material !== undefined && material !== name && meshDef.primitives.length > 1 ? `${name}/${material}` : name,
        node: next.node,
        mesh: nodeDef.mesh!,
        primitive: p,
        matrix: nodeDef.skin === undefined ? matrix : identity,
        firstVertex,
        vertexCount: localPositions.length / 3,
        firstTriangle,
        triangleCount: localIndices.length / 3,
        localPositions,
        localIndices,
      };
      parts.push(part);
      firstVertex += part.vertexCount;
      firstTriangle += part.triangleCount;
    });
  }
  return parts;
}

function roots({ scene, scenes = [], nodes = [] }: GLTF.IGLTF): number[] {
  const chosen = scenes[scene ?? 0];
  if (chosen) return chosen.nodes ?? [];
  // A file without scenes is a library of nodes: all of it, then.
  const children = new Set(nodes.flatMap((node) => node.children ?? []));
  return nodes.map((_, n) => n).filter((n) => !children.has(n));
}

/** The accessor of a primitive, decoded, and checked to have as many elements as the file says. */
function accessorOf(file: GltfFile, place: string, mesh: number, primitive: number, semantic: string): Accessor | undefined {
  const { attributes } = file.json.meshes![mesh]!.primitives[primitive]!;
  if (attributes[semantic] === undefined) return undefined;
  const accessor = file.geometry.getRoot().listAccessors()[attributes[semantic]];
  const expected = file.json.accessors![attributes[semantic]]!.count;
  if (accessor?.getArray() === null || accessor?.getCount() !== expected) {
    throw new InputError(`${place}.attributes.${semantic} has ${accessor?.getCount() ?? 0} elements, not the ${expected} of its accessor`);
  }
  return accessor;
}

function readPositions(file: GltfFile, place: string, mesh: number, primitive: number): Float32Array | undefined {
  const accessor = accessorOf(file, place, mesh, primitive, 'POSITION');
  if (accessor === undefined) return undefined;
  if (accessor.getElementSize() !== 3) throw new InputError(`${place}.attributes.POSITION is ${accessor.getType()}, not VEC3`);
  const positions = decodeFloats(accessor);
  const bad = positions.findIndex((value) => !Number.isFinite(value));
  if (bad >= 0) throw new InputError(`${place}: POSITION of vertex ${Math.floor(bad / 3)} has ${positions[bad]}, which is not a finite number`);
  return positions;
}

/** All components of an accessor as 32-bit floats, with normalised integers decoded. */
export function decodeFloats(accessor: Accessor): Float32Array {
  const array = accessor.getArray()!;
  if (array instanceof Float32Array) return array;
  if (!accessor.getNormalized()) return Float32Array.from(array as ArrayLike<number>);
  const size = accessor.getElementSize();
  const out = new Float32Array(array.length);
  const element: number[] = [];
  for (let i = 0; i < accessor.getCount(); ++i) out.set(accessor.getElement(i, element), i * size);
  return out;
}

/** The triangles of a primitive, strips and fans expanded; `undefined` if it is of points or lines. */
function readTriangles(file: GltfFile, place: string, mesh: number, primitive: number, vertexCount: number): Uint32Array | undefined {
  const { indices, mode = triangles } = file.json.meshes![mesh]!.primitives[primitive]!;
  if (mode < triangles || mode > triangleFan) return undefined;
  const accessor = indices === undefined ? undefined : file.geometry.getRoot().listAccessors()[indices];
  const array = accessor?.getArray() ?? undefined;
  if (indices !== undefined && array === undefined) throw new InputError(`${place}.indices has no data`);
  const corners = array ? Uint32Array.from(array as ArrayLike<number>) : Uint32Array.from({ length: vertexCount }, (_, v) => v);
  const bad = corners.findIndex((vertex) => vertex >= vertexCount);
  if (bad >= 0) throw new InputError(`${place}: indices[${bad}] = ${corners[bad]} is out of range (${vertexCount} vertices)`);
  if (mode === triangles) {
    if (corners.length % 3 !== 0) throw new InputError(`${place} has ${corners.length} corners, not 3 per triangle`);
    return corners;
  }
  const expanded = new Uint32Array(3 * Math.max(corners.length - 2, 0));
  for (let t = 0; t < expanded.length / 3; ++t) {
    // As the specification orders them: every other triangle of a strip turns; a fan goes round its first vertex.
    const [a, b, c] = mode === triangleStrip ? [t, t + 1 + (t % 2), t + 2 - (t % 2)] : [t + 1, t + 2, 0];
    expanded.set([corners[a]!, corners[b]!, corners[c]!], 3 * t);
  }
  return expanded;
}

function placePositions({ matrix: m, localPositions, firstVertex }: Part, out: Float32Array): void {
  if (m === identity || m.every((value, i) => value === identity[i])) {
    out.set(localPositions, 3 * firstVertex);
    return;
  }
  for (let at = 0; at < localPositions.length; at += 3) {
    const [x, y, z] = [localPositions[at]!, localPositions[at + 1]!, localPositions[at + 2]!];
    const to = 3 * firstVertex + at;
    out[to] = m[0]! * x + m[4]! * y + m[8]! * z + m[12]!;
    out[to + 1] = m[1]! * x + m[5]! * y + m[9]! * z + m[13]!;
    out[to + 2] = m[2]! * x + m[6]! * y + m[10]! * z + m[14]!;
  }
}

function placeIndices({ matrix, localIndices, firstVertex, firstTriangle }: Part, out: Uint32Array): void {
  const mirrored = determinant(matrix) < 0;
  for (let at = 0; at < localIndices.length; at += 3) {
    const to = 3 * firstTriangle + at;
    out[to] = firstVertex + localIndices[at]!;
    out[to + (mirrored ? 2 : 1)] = firstVertex + localIndices[at + 1]!;
    out[to + (mirrored ? 1 : 2)] = firstVertex + localIndices[at + 2]!;
  }
}

function readUvs(file: GltfFile, parts: Part[], vertexCount: number): Float32Array | undefined {
  const uvs = new Float32Array(2 * vertexCount);
  for (const part of parts) {
    const accessor = accessorOf(file, placeOf(part), part.mesh, part.primitive, 'TEXCOORD_0');
    if (accessor === undefined) return undefined;
    if (accessor.getElementSize() !== 2) throw new InputError(`${placeOf(part)}.attributes.TEXCOORD_0 is ${accessor.getType()}, not VEC2`);
    if (accessor.getCount() !== part.vertexCount) {
      throw new InputError(`${placeOf(part)} has ${accessor.getCount()} TEXCOORD_0 for ${part.vertexCount} vertices`);
    }
    uvs.set(decodeFloats(accessor), 2 * part.firstVertex);
  }
  return parts.length > 0 ? uvs : undefined;
}
