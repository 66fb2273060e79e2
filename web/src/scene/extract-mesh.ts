import { placesOf } from 'cagecast/three';
import {
  type BufferAttribute,
  type InterleavedBufferAttribute,
  Matrix4,
  Mesh,
  type Object3D,
  type Texture,
  Vector3,
} from 'three';
import { Pace } from '../platform/pace';

/** One triangle mesh of the scene, and the ranges of its elements in the concatenated arrays. */
export interface Primitive {
  /** The three.js mesh. */
  mesh: Mesh;
  /** Its name, for people. */
  name: string;
  firstVertex: number;
  vertexCount: number;
  firstTriangle: number;
  triangleCount: number;
  /** From its own space to the scene's, at the time it was read. */
  matrix: Matrix4;
  /** Whether its matrix mirrors it; its winding is reversed then. */
  mirrored: boolean;
}

/** All triangles of a scene as arrays in world space, as the transfer takes them. */
export interface ExtractedMesh {
  /** 3 per vertex, in the scene's space; they may be deformed. */
  positions: Float32Array;
  /** The positions in the file, if `positions` may have been deformed. */
  rest?: Float32Array;
  /** 3 per triangle, counter-clockwise seen from outside. */
  indices: Uint32Array;
  /** 2 per vertex, of the set of the base colour texture, else of the first; absent unless every primitive has it. */
  uvs?: Float32Array;
  /** 1 per vertex: the index of its primitive. Only vertices of the same primitive are welded. */
  groups: Uint32Array;
  primitives: Primitive[];
}

const kIdentity = new Matrix4();
const kSlice = 16384; // vertices or triangles per slice, which takes a few milliseconds

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/**
 * Reads all triangle meshes below `root`, depth first, into one set of arrays.
 * Vertices keep their order. World matrices are applied in double precision, and the result is rounded once. The winding of
 * mirrored primitives is reversed, so that triangles keep facing outward.
 * @param root   A scene that has not been moved since it was loaded.
 * @param nameOf The name of a mesh in its file, if any.
 * @throws Error that names the primitive and the element that cannot be read; or if there are no triangles.
 */
export async function extractMesh(
  root: Object3D,
  nameOf: (mesh: Mesh) => string | undefined = () => undefined,
): Promise<ExtractedMesh> {
  root.updateMatrixWorld(true);
  const primitives = listPrimitives(root, nameOf);
  const last = primitives.at(-1);
  if (!last) throw new Error('the file contains no triangles, only points, lines or an empty scene');
  const vertexCount = last.firstVertex + last.vertexCount;
  const positions = new Float32Array(3 * vertexCount);
  const indices = new Uint32Array(3 * (last.firstTriangle + last.triangleCount));
  const groups = new Uint32Array(vertexCount);
  const pace = new Pace();
  for (const [group, primitive] of primitives.entries()) {
    for (const [from, to] of slices(primitive.vertexCount)) {
      copyPositions(primitive, positions, from, to);
      await pace.rest();
    }
    for (const [from, to] of slices(primitive.triangleCount)) {
      copyIndices(primitive, indices, 3 * from, 3 * to);
      await pace.rest();
    }
    groups.fill(group, primitive.firstVertex, primitive.firstVertex + primitive.vertexCount);
  }

  const hasUvs = primitives.every(({ mesh }) => mesh.geometry.hasAttribute(uvNameOf(mesh)));
  return { positions, indices, groups, primitives, ...(hasUvs && { uvs: copyUvs(primitives, vertexCount) }) };
}

/** Splits a count into ranges of `kSlice`. */
function* slices(count: number): Iterable<[number, number]> {
  for (let from = 0; from < count; from += kSlice) yield [from, Math.min(from + kSlice, count)];
}

function listPrimitives(root: Object3D, nameOf: (mesh: Mesh) => string | undefined): Primitive[] {
  let firstVertex = 0;
  let firstTriangle = 0;
  const meshes: Mesh[] = [];
  root.traverse((object) => object instanceof Mesh && meshes.push(object));
  return placesOf(meshes).map((matrix, m) => {
    const mesh = meshes[m]!;
    const name = nameOf(mesh) || mesh.name || mesh.parent?.name || `part ${m}`;
    if ('isInstancedMesh' in mesh)
      throw new Error(`“${name}” uses instancing, which is not supported; give each instance a node of its own`);
    const { index, attributes } = mesh.geometry;
    const vertexCount = attributes.position?.count ?? 0;
    const cornerCount = index ? index.count : vertexCount;
    if (cornerCount % 3 !== 0) {
      throw new Error(`“${name}” has ${cornerCount} triangle corners, which is not a multiple of three`);
    }
    const triangleCount = cornerCount / 3;
    const mirrored = matrix.determinant() < 0;
    const primitive = { mesh, name, firstVertex, vertexCount, firstTriangle, triangleCount, matrix, mirrored };
    firstVertex += vertexCount;
    firstTriangle += triangleCount;
    return primitive;
  });
}

function copyPositions({ mesh, firstVertex, matrix }: Primitive, out: Float32Array, from: number, to: number): void {
  const position = mesh.geometry.attributes.position as Attribute;
  const point = new Vector3();
  const identity = matrix.equals(kIdentity); // which would make all of a point NaN if one coordinate is
  for (let i = from; i < to; i++) {
    // Decode quantised positions to floats before applying the matrix, as other glTF readers do.
    point.set(Math.fround(position.getX(i)), Math.fround(position.getY(i)), Math.fround(position.getZ(i)));
    if (!identity) point.applyMatrix4(matrix);
    point.toArray(out, 3 * (firstVertex + i));
  }
}

function copyIndices(
  { mesh, name, firstVertex, vertexCount, firstTriangle, mirrored }: Primitive,
  out: Uint32Array,
  from: number,
  to: number,
): void {
  const { index } = mesh.geometry;
  const base = 3 * firstTriangle;
  for (let corner = from; corner < to; corner++) {
    const vertex = index ? index.getX(corner) : corner;
    // Check per primitive: after concatenation, an index out of range would point into the next primitive.
    if (vertex >= vertexCount) {
      throw new Error(`indices[${corner}] = ${vertex} of “${name}” is out of range (${vertexCount} vertices)`);
    }
    out[base + corner] = firstVertex + vertex;
  }
  if (mirrored) reverseWinding(out.subarray(base + from, base + to));
}

/** Swaps the last two corners of every triangle. */
export function reverseWinding(indices: Uint32Array): void {
  for (let at = 0; at < indices.length; at += 3) {
    const second = indices[at + 1]!;
    indices[at + 1] = indices[at + 2]!;
    indices[at + 2] = second;
  }
}

/** The attribute of UVs by which the base colour texture of a mesh lies on it; the first if it has none. */
function uvNameOf({ material }: Mesh): string {
  const channel = (material as { map?: Texture | null }).map?.channel ?? 0;
  return channel === 0 ? 'uv' : `uv${channel}`;
}

function copyUvs(primitives: Primitive[], vertexCount: number): Float32Array {
  const uvs = new Float32Array(2 * vertexCount);
  for (const { mesh, firstVertex } of primitives) {
    const uv = mesh.geometry.getAttribute(uvNameOf(mesh)) as Attribute;
    for (let i = 0; i < uv.count; i++) {
      uvs[2 * (firstVertex + i)] = uv.getX(i);
      uvs[2 * (firstVertex + i) + 1] = uv.getY(i);
    }
  }
  return uvs;
}
