import type { Mesh, Object3D } from 'three';
import { extract } from '#three';
import type { ExtractedMesh, Model, Primitive } from '../state/model';
import { haveSameUvs } from '../state/same-uvs';

/**
 * Reads all triangle meshes below `root`, depth first, into one set of arrays, as `extract` of `cagecast/three`: those that are drawn,
 * or of a cage its outer cages, or all if there are none.
 * @param root   A scene as it was loaded, perhaps moved as a whole.
 * @param nameOf The name of a mesh in its file, if any.
 * @throws Error that names the primitive and the element that cannot be read; or if there are no triangles.
 */
export function extractMesh(
  root: Object3D,
  nameOf: (mesh: Mesh) => string | undefined = () => undefined,
  slot: 'target' | 'cage' = 'target',
): ExtractedMesh {
  const { mesh, parts, leftOut, accessories, names, bare } = extract(root, slot === 'cage' ? 'cage' : 'the scene');
  if (parts.length === 0) throw new Error('the file contains no triangles, only points, lines or an empty scene');
  const primitives = parts.map(({ geometry, ...part }): Primitive => {
    const mesh = part.mesh as Mesh;
    const name = nameOf(mesh) || part.name;
    const weights = [...(mesh.morphTargetInfluences ?? [])];
    return { ...part, mesh, name, mirrored: part.matrix.determinant() < 0, weights };
  });
  // They would hide the model on the stage.
  if (slot === 'target') for (const { mesh, why } of leftOut) if (why === 'name') mesh.visible = false;
  return {
    ...mesh,
    names: names.map((own, group) => [...new Set([primitives[group]?.name ?? '', ...own])]),
    primitives,
    accessories,
    bare,
    leftOut: leftOut.map((one) => nameOf(one.mesh) || one.name),
  };
}

/** The meshes of a model, as a target and as a cage. @throws Error as `extractMesh`. */
export function meshesOf(
  root: Object3D,
  nameOf?: (mesh: Mesh) => string | undefined,
): Pick<Model, 'mesh' | 'cageMesh'> {
  let mesh: ExtractedMesh | undefined;
  let fault: unknown;
  try {
    mesh = extractMesh(root, nameOf);
    if (mesh.leftOut.length === 0) return { mesh, cageMesh: withCageUvs(mesh, root, nameOf) };
  } catch (error) {
    fault = error;
  }
  try {
    const cageMesh = extractMesh(root, nameOf, 'cage');
    const leftOut = cageMesh.primitives.map(({ name }) => name);
    return { mesh: mesh ?? { ...cageMesh, primitives: [], accessories: [], leftOut }, cageMesh };
  } catch (error) {
    throw fault ?? error;
  }
}

/** A mesh as a cage: itself, unless it has several sets of UVs, and the one for a texture is another or not known. */
function withCageUvs(mesh: ExtractedMesh, root: Object3D, nameOf?: (mesh: Mesh) => string | undefined): ExtractedMesh {
  if (!mesh.primitives.some(({ mesh: { geometry } }) => geometry.hasAttribute('uv1'))) return mesh;
  const cageMesh = extractMesh(root, nameOf, 'cage');
  return cageMesh.otherUvSets || !haveSameUvs({ mesh }, { mesh: cageMesh }) ? cageMesh : mesh;
}

/** Swaps the last two corners of every triangle. */
export function reverseWinding(indices: Uint32Array): void {
  for (let at = 0; at < indices.length; at += 3) {
    const second = indices[at + 1]!;
    indices[at + 1] = indices[at + 2]!;
    indices[at + 2] = second;
  }
}
