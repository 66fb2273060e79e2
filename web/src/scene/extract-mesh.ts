import { extract, type Part } from 'cagecast/three';
import type { Mesh, Object3D } from 'three';

/** One triangle mesh of the scene, and the ranges of its elements in the concatenated arrays; its name is for people. */
export interface Primitive extends Omit<Part, 'geometry'> {
  mesh: Mesh;
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
  /** 2 per vertex: where it is in its base colour texture; without one, the first set. Absent unless every primitive has UVs. */
  uvs?: Float32Array | undefined;
  /** 1 per vertex: the index of its primitive. Only vertices of the same primitive are welded. */
  groups: Uint32Array;
  primitives: Primitive[];
}

/**
 * Reads all triangle meshes below `root`, depth first, into one set of arrays, as `extract` of `cagecast/three`.
 * @param root   A scene that has not been moved since it was loaded.
 * @param nameOf The name of a mesh in its file, if any.
 * @throws Error that names the primitive and the element that cannot be read; or if there are no triangles.
 */
export function extractMesh(
  root: Object3D,
  nameOf: (mesh: Mesh) => string | undefined = () => undefined,
): ExtractedMesh {
  const { mesh, parts } = extract(root, 'the scene');
  if (parts.length === 0) throw new Error('the file contains no triangles, only points, lines or an empty scene');
  const primitives = parts.map(({ geometry, ...part }): Primitive => {
    const mesh = part.mesh as Mesh;
    const name = nameOf(mesh) || part.name;
    return { ...part, mesh, name, mirrored: part.matrix.determinant() < 0 };
  });
  return { ...mesh, primitives };
}

/** Swaps the last two corners of every triangle. */
export function reverseWinding(indices: Uint32Array): void {
  for (let at = 0; at < indices.length; at += 3) {
    const second = indices[at + 1]!;
    indices[at + 1] = indices[at + 2]!;
    indices[at + 2] = second;
  }
}
