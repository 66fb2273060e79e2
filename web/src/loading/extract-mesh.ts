import { extract } from 'cagecast/three';
import type { Mesh, Object3D } from 'three';
import type { ExtractedMesh, Primitive } from '../state/model';

/**
 * Reads all triangle meshes below `root`, depth first, into one set of arrays, as `extract` of `cagecast/three`.
 * @param root   A scene as it was loaded, perhaps moved as a whole.
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
    const weights = [...(mesh.morphTargetInfluences ?? [])];
    return { ...part, mesh, name, mirrored: part.matrix.determinant() < 0, weights };
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
