import type {
  BufferGeometry,
  InstancedBufferAttribute,
  InstancedMesh,
  InterleavedBufferAttribute,
  Object3D,
  SkinnedMesh,
  Mesh as ThreeMesh,
} from 'three';

// Tested by three's own flags, not by class, because a page may have a second copy of three.
export const isGeometry = (object: Object3D | BufferGeometry): object is BufferGeometry =>
  (object as BufferGeometry | undefined)?.isBufferGeometry === true;
export const isObject = (object: Object3D): boolean => object?.isObject3D === true;
export const isSkinned = (mesh: ThreeMesh): mesh is SkinnedMesh => (mesh as SkinnedMesh).isSkinnedMesh === true;
export const isInstanced = (mesh: ThreeMesh): mesh is InstancedMesh => (mesh as InstancedMesh).isInstancedMesh === true;
/** Whether an attribute has a value for each instance, not for each vertex. */
export const isOfInstances = (attribute: object): boolean =>
  (attribute as InstancedBufferAttribute).isInstancedBufferAttribute === true ||
  ((attribute as InterleavedBufferAttribute).data as { isInstancedInterleavedBuffer?: true } | undefined)
    ?.isInstancedInterleavedBuffer === true;
export const isMesh = (object: Object3D): object is ThreeMesh => (object as ThreeMesh).isMesh === true;
