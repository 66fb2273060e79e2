import { placeOf } from 'cagecast/three';
import { type BufferAttribute, type InterleavedBufferAttribute, Matrix4, Mesh, type Object3D, Vector3 } from 'three';
import { Pace } from '../platform/pace';

/** One triangle mesh of the scene, and where its elements lie in the concatenated arrays. */
export interface Part {
  /** The mesh these elements were read from. */
  mesh: Mesh;
  /** Its name, for people. */
  name: string;
  firstVertex: number;
  vertexCount: number;
  firstTriangle: number;
  triangleCount: number;
  /** From its own space to the scene's: where it lay when it was read. */
  matrix: Matrix4;
  /** Whether its winding was turned, as its place in the scene mirrors it. */
  mirrored: boolean;
}

/** All triangles of a scene as raw arrays in world space, in the shape the transfer takes. */
export interface ExtractedMesh {
  /** 3 per vertex, in the scene's space. They may move; `rest` keeps where they were then. */
  positions: Float32Array;
  /** The positions as the file has them, if they have moved. */
  rest?: Float32Array;
  /** 3 per triangle, counter-clockwise seen from outside. */
  indices: Uint32Array;
  /** 2 per vertex, from the first UV set; absent unless every part has one. */
  uvs?: Float32Array;
  /** 1 per vertex: the number of its part, so that only vertices of one part are welded. */
  groups: Uint32Array;
  parts: Part[];
}

const kIdentity = new Matrix4();
const kSlice = 16384; // vertices or triangles that are read at a stretch: some milliseconds

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/**
 * Reads all triangle meshes below `root`, depth first, into one set of arrays.
 * Vertices keep their number and order; world matrices are applied in double precision and rounded last; the winding of
 * mirrored parts is flipped, so that every triangle keeps its outside.
 * @param root   A scene that has not been moved since it was loaded.
 * @param nameOf What its file calls a mesh, if it does.
 * @throws Error that names the part and the element, where a part cannot be read on its own; or if there is none.
 */
export async function extractMesh(
  root: Object3D,
  nameOf: (mesh: Mesh) => string | undefined = () => undefined,
): Promise<ExtractedMesh> {
  root.updateMatrixWorld(true);
  const parts = listParts(root, nameOf);
  if (parts.length === 0)
    throw new Error('there are no triangles in it: a mesh is wanted, not points, lines or an empty scene');
  const last = parts.at(-1);
  const vertexCount = last ? last.firstVertex + last.vertexCount : 0;
  const triangleCount = last ? last.firstTriangle + last.triangleCount : 0;

  const positions = new Float32Array(3 * vertexCount);
  const indices = new Uint32Array(3 * triangleCount);
  const groups = new Uint32Array(vertexCount);
  const pace = new Pace();
  for (const [group, part] of parts.entries()) {
    for (const [from, to] of slices(part.vertexCount)) {
      copyPositions(part, positions, from, to);
      await pace.rest();
    }
    for (const [from, to] of slices(part.triangleCount)) {
      copyIndices(part, indices, 3 * from, 3 * to);
      await pace.rest();
    }
    groups.fill(group, part.firstVertex, part.firstVertex + part.vertexCount);
  }

  const hasUvs = parts.every((part) => part.mesh.geometry.hasAttribute('uv'));
  return { positions, indices, groups, parts, ...(hasUvs && { uvs: copyUvs(parts, vertexCount) }) };
}

/** Ranges that a count is taken in, one after the other. */
function* slices(count: number): Iterable<[number, number]> {
  for (let from = 0; from < count; from += kSlice) yield [from, Math.min(from + kSlice, count)];
}

function listParts(root: Object3D, nameOf: (mesh: Mesh) => string | undefined): Part[] {
  const parts: Part[] = [];
  let firstVertex = 0;
  let firstTriangle = 0;
  root.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    const name = nameOf(object) || object.name || object.parent?.name || `part ${parts.length}`;
    if ('isInstancedMesh' in object)
      throw new Error(`“${name}” is shown in many places at once (instances); give each a node of its own first`);
    const { index, attributes } = object.geometry as Mesh['geometry'];
    const vertexCount = attributes.position?.count ?? 0;
    const cornerCount = index ? index.count : vertexCount;
    if (cornerCount % 3 !== 0) {
      throw new Error(`“${name}” has ${cornerCount} triangle corners, which is not a multiple of three`);
    }
    const triangleCount = cornerCount / 3;
    const matrix = placeOf(object).clone();
    parts.push({
      mesh: object,
      name,
      firstVertex,
      vertexCount,
      firstTriangle,
      triangleCount,
      matrix,
      mirrored: matrix.determinant() < 0,
    });
    firstVertex += vertexCount;
    firstTriangle += triangleCount;
  });
  return parts;
}

function copyPositions({ mesh, firstVertex, matrix }: Part, out: Float32Array, from: number, to: number): void {
  const position = mesh.geometry.attributes.position as Attribute;
  const point = new Vector3();
  const identity = matrix.equals(kIdentity);
  for (let i = from; i < to; i++) {
    // A quantised position decodes to a float before the matrix is applied, as every glTF reader stores it.
    point.set(Math.fround(position.getX(i)), Math.fround(position.getY(i)), Math.fround(position.getZ(i)));
    if (!identity) point.applyMatrix4(matrix);
    point.toArray(out, 3 * (firstVertex + i));
  }
}

function copyIndices(
  { mesh, name, firstVertex, vertexCount, firstTriangle, mirrored }: Part,
  out: Uint32Array,
  from: number,
  to: number,
): void {
  const { index } = mesh.geometry;
  const base = 3 * firstTriangle;
  for (let corner = from; corner < to; corner++) {
    const vertex = index ? index.getX(corner) : corner;
    // Checked per part: once concatenated, an index too large would point into the next part.
    if (vertex >= vertexCount) {
      throw new Error(`indices[${corner}] = ${vertex} of “${name}” is out of range (${vertexCount} vertices)`);
    }
    out[base + corner] = firstVertex + vertex;
  }
  if (mirrored) turnWinding(out.subarray(base + from, base + to));
}

/** Swaps the last two corners of every triangle. */
export function turnWinding(indices: Uint32Array): void {
  for (let at = 0; at < indices.length; at += 3) {
    const second = indices[at + 1]!;
    indices[at + 1] = indices[at + 2]!;
    indices[at + 2] = second;
  }
}

function copyUvs(parts: Part[], vertexCount: number): Float32Array {
  const uvs = new Float32Array(2 * vertexCount);
  for (const { mesh, firstVertex } of parts) {
    const uv = mesh.geometry.attributes.uv as Attribute;
    for (let i = 0; i < uv.count; i++) {
      uvs[2 * (firstVertex + i)] = uv.getX(i);
      uvs[2 * (firstVertex + i) + 1] = uv.getY(i);
    }
  }
  return uvs;
}
