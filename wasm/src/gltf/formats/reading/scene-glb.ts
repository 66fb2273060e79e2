import type { GLTF, vec4 } from '@gltf-transform/core';
import { type Material, Matrix4, type Mesh, type Object3D, type SkinnedMesh } from 'three';
import { visibilityExtension } from '../../../parts/drawn.js';
import { joinBytes, packGlb, paddedLength } from '../../../parts/glb.js';
import { uvSetNames } from '../../../scene/uv-sets.js';
import { checkImages } from '../../checks/check-images.js';
import type { ReadLimits } from '../../checks/read-limits.js';
import { attributesOf, boundsOf, cornersOf, gathererOf } from './geometry.js';
import { MaterialWriter, named } from './materials.js';

/**
 * Writes what is drawn of a scene as a GLB; nothing if it has no triangle.
 * @param check  Told the bytes of the GLB as they become more; throws if they are too many.
 * @throws {InputError} if its images decode to more than the limit.
 */
export function sceneGlb(
  scene: Object3D,
  check: (bytes: number) => void,
  limits: Pick<ReadLimits, 'expansion'>,
): Uint8Array<ArrayBuffer> | undefined {
  const writer = new SceneWriter(check);
  scene.updateMatrixWorld(true);
  const root = writer.addNode(scene);
  writer.addSkins();
  return writer.hasTriangles ? writer.finish(root, limits) : undefined;
}

const types = { 1: 'SCALAR', 2: 'VEC2', 3: 'VEC3', 4: 'VEC4', 16: 'MAT4' } as const;
const componentTypes = { Float32Array: 5126, Uint32Array: 5125, Uint16Array: 5123 } as const;
type Values = Float32Array | Uint32Array | Uint16Array;

const areFinite = (numbers: readonly number[]): boolean => numbers.every((x) => Number.isFinite(x));

class SceneWriter {
  readonly #check: (bytes: number) => void;
  readonly #json: GLTF.IGLTF = { asset: { version: '2.0', generator: `Cagecast ${CAGECAST_VERSION}` } };
  readonly #chunks: Uint8Array[] = [];
  #length = 0;
  readonly #nodes = new Map<Object3D, number>();
  readonly #materials = new MaterialWriter(this.#json, (bytes) => this.#addView(bytes));

  constructor(check: (bytes: number) => void) {
    this.#check = check;
  }

  get hasTriangles(): boolean {
    return this.#json.meshes !== undefined;
  }

  /** Adds an object and all below it. @returns the number of its node. */
  addNode(object: Object3D): number {
    const { name, position, scale } = object;
    const rotation = object.quaternion.clone().normalize().toArray() as vec4;
    const node: GLTF.INode = {
      ...named(name),
      ...(position.lengthSq() > 0 && areFinite(position.toArray()) && { translation: position.toArray() }),
      ...(rotation[3] !== 1 && areFinite(rotation) && { rotation }),
      ...(!(scale.x === 1 && scale.y === 1 && scale.z === 1) &&
        areFinite(scale.toArray()) && { scale: scale.toArray() }),
      ...(!object.visible && { extensions: { [visibilityExtension]: { visible: false } } }),
    };
    if (!object.visible)
      this.#json.extensionsUsed = [...new Set([...(this.#json.extensionsUsed ?? []), visibilityExtension])];
    const number = (this.#json.nodes ??= []).push(node) - 1;
    this.#nodes.set(object, number);
    if ((object as Mesh).isMesh) {
      const mesh = this.#addMesh(object as Mesh);
      if (mesh !== undefined) node.mesh = mesh;
    }
    const children = object.children.map((child) => this.addNode(child));
    if (children.length > 0) node.children = children;
    return number;
  }

  #addMesh(mesh: Mesh): number | undefined {
    const { name, geometry, morphTargetDictionary, morphTargetInfluences } = mesh;
    const corners = cornersOf(geometry);
    if (corners === undefined || !(corners.kept?.includes(1) ?? corners.indices.length > 0)) return undefined;
    const joints = (mesh as Partial<SkinnedMesh>).skeleton?.bones.length ?? 0;
    const whole = attributesOf(geometry, corners, joints);
    const lists = trianglesByMaterial(mesh, whole.indices, corners.kept);
    if (lists.size === 0) return undefined;
    const gather = gathererOf(whole);
    const primitives = [...lists].map(([look, triangles]): GLTF.IMeshPrimitive => {
      const { attributes, targets, indices } = triangles.length < whole.indices.length ? gather(triangles) : whole;
      const deltas = targets.map((target) => ({ POSITION: this.#addAccessor(target, 3, true) }));
      return {
        attributes: Object.fromEntries(
          Object.entries(attributes).map(([semantic, { values, size }]) => [
            semantic,
            this.#addAccessor(values, size, semantic === 'POSITION'),
          ]),
        ),
        indices: this.#addAccessor(indices, 1),
        ...this.#materialOf(look, 'TEXCOORD_0' in attributes),
        ...(deltas.length > 0 && { targets: deltas }),
      };
    });
    const names = Object.keys(morphTargetDictionary ?? {});
    const weights = whole.targets.map((_, t) => morphTargetInfluences?.[t] ?? 0);
    const sets = geometry.userData[uvSetNames] as string[] | undefined;
    const extras = {
      ...(weights.length === names.length && names.length > 0 && { targetNames: names }),
      ...(sets && { [uvSetNames]: sets }),
    };
    const written: GLTF.IMesh = {
      ...named(geometry.name || name),
      primitives,
      ...(weights.length > 0 && { weights: weights.map((weight) => (Number.isFinite(weight) ? weight : 0)) }),
      ...(Object.keys(extras).length > 0 && { extras }),
    };
    return (this.#json.meshes ??= []).push(written) - 1;
  }

  #materialOf(material: Material | undefined, hasUvs: boolean): { material?: number } {
    // Some names, such as "constructor", lead a loader to what is none.
    return material?.isMaterial ? { material: this.#materials.add(material, hasUvs) } : {};
  }

  /** Adds the skins of all meshes, once all bones have their nodes. */
  addSkins(): void {
    for (const [object, number] of this.#nodes) {
      const { skeleton, bindMatrix, isSkinnedMesh } = object as SkinnedMesh;
      if (!isSkinnedMesh || !skeleton || this.#json.nodes![number]!.mesh === undefined) continue;
      const joints = skeleton.bones.map((bone) => this.#nodes.get(bone));
      if (joints.length === 0 || joints.includes(undefined)) continue;
      const inverses = skeleton.boneInverses.flatMap((inverse) =>
        affine(new Matrix4().multiplyMatrices(inverse, bindMatrix)),
      );
      const inverseBindMatrices = this.#addAccessor(Float32Array.from(inverses), 16);
      const skin = { joints: joints as number[], inverseBindMatrices };
      this.#json.nodes![number]!.skin = (this.#json.skins ??= []).push(skin) - 1;
    }
  }

  finish(root: number, limits: Pick<ReadLimits, 'expansion'>): Uint8Array<ArrayBuffer> {
    const images = [...this.#materials.images].map((bytes, i): [string, Uint8Array] => [`images[${i}]`, bytes]);
    checkImages(images, this.#length, limits);
    this.#json.scene = 0;
    this.#json.scenes = [{ nodes: [root] }];
    this.#json.buffers = [{ byteLength: this.#length }];
    return packGlb(this.#json, this.#chunks);
  }

  #addAccessor(values: Values, size: keyof typeof types, isBounded = false): number {
    const accessor = {
      bufferView: this.#addView(new Uint8Array(values.buffer, values.byteOffset, values.byteLength)),
      componentType: componentTypes[values.constructor.name as keyof typeof componentTypes],
      count: values.length / size,
      type: types[size],
      ...(isBounded && boundsOf(values)),
    };
    return (this.#json.accessors ??= []).push(accessor as GLTF.IAccessor) - 1;
  }

  #addView(bytes: Uint8Array): number {
    const view = { buffer: 0, byteOffset: this.#length, byteLength: bytes.byteLength };
    this.#chunks.push(bytes, new Uint8Array(paddedLength(bytes.byteLength) - bytes.byteLength));
    this.#length += paddedLength(bytes.byteLength);
    this.#check(this.#length);
    return (this.#json.bufferViews ??= []).push(view) - 1;
  }
}

/**
 * The corners of all triangles of each material. Files often go to and fro between few materials.
 * @param kept  Whether each triangle counts.
 */
function trianglesByMaterial(
  { geometry, material }: Mesh,
  indices: Uint32Array,
  kept: Uint8Array | undefined,
): Map<Material | undefined, Uint32Array> {
  const groups =
    Array.isArray(material) && geometry.groups.length > 0
      ? geometry.groups
      : [{ start: 0, count: Infinity, materialIndex: 0 }];
  const materials = [material].flat();
  const lists = new Map<Material | undefined, Uint32Array[]>();
  for (const { start, count, materialIndex = 0 } of groups) {
    const end = Math.min(indices.length, start + count);
    const all = indices.subarray(start, Math.max(start, end - ((end - start) % 3)));
    const some = kept ? all.filter((_, i) => kept[Math.floor((start + i) / 3)] === 1) : all;
    if (some.length < 3) continue;
    const look = materials[materialIndex];
    if (!lists.get(look)?.push(some)) lists.set(look, [some]);
  }
  const bytesOf = (corners: Uint32Array) => new Uint8Array(corners.buffer, corners.byteOffset, corners.byteLength);
  return new Map([...lists].map(([look, some]) => [look, new Uint32Array(joinBytes(some.map(bytesOf)).buffer)]));
}

/** The numbers of a matrix as glTF has those of joints: none that is not finite, and its last row is 0, 0, 0, 1. */
function affine(matrix: Matrix4): number[] {
  const numbers = matrix.toArray();
  if (!areFinite(numbers.map(Math.fround))) return new Matrix4().toArray();
  for (const [at, value] of [0, 0, 0, 1].entries()) numbers[4 * at + 3] = value;
  return numbers;
}
