import { Matrix4, type Object3D, type SkinnedMesh, type Mesh as ThreeMesh } from 'three';
import { placeMeshes, type Skin } from '../../parts/skin.js';
import { type Attribute, valuesOf } from './attributes.js';
import { isInstanced } from './flags.js';

/**
 * Returns the matrices from meshes to the scene: their world matrices; for skinned meshes, those by which their skeletons place them
 * in the bind pose; for instanced meshes, those of the first instance. World matrices must be up to date. Whether a skeleton has
 * moved follows from all meshes that it holds, so give them together. Cost: linear in the vertices of skinned meshes.
 */
export function placesOf(meshes: readonly ThreeMesh[]): Matrix4[] {
  const all = meshes.map((mesh) => {
    const place = new Matrix4();
    if (isInstanced(mesh)) mesh.getMatrixAt(0, place);
    const skin = isAttached(mesh) ? skinOf(mesh) : undefined;
    return { node: mesh as Object3D, matrix: place.premultiply(mesh.matrixWorld).elements, skin };
  });
  const nodes = {
    parentOf: ({ parent }: Object3D) => parent,
    worldOf: ({ matrixWorld }: Object3D) => matrixWorld.elements,
  };
  return placeMeshes(all, nodes).map((place) => new Matrix4().fromArray(place));
}

/** Whether a mesh is where its skeleton is. A detached one is where it is itself. */
const isAttached = (mesh: ThreeMesh): mesh is SkinnedMesh => (mesh as SkinnedMesh).bindMode === 'attached';

export function skinOf(mesh: SkinnedMesh): Skin<Object3D> {
  const { skeleton, bindMatrix, geometry } = mesh;
  const values = (name: string) => {
    const attribute = geometry.getAttribute(name) as Attribute | undefined;
    return attribute ? valuesOf(attribute) : new Float32Array();
  };
  return {
    joints: skeleton?.bones ?? [],
    inverseOf: (b) => skeleton!.boneInverses[b]!.elements,
    bind: bindMatrix.elements,
    held: values('skinIndex'),
    weights: values('skinWeight'),
    positions: values('position'),
    isFloat: geometry.getAttribute('position')?.array instanceof Float32Array,
  };
}
