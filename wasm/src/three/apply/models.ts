// What models and cages may be given as, everywhere in `cagecast/three`.
import { BufferAttribute, BufferGeometry, type Object3D } from 'three';
import type { Mesh } from '../../api/mesh.js';
import type { Cage } from '../../cages/types.js';
import { show } from '../../core/error.js';
import type { VrmExtensions } from '../../parts/joints.js';
import { notA, wrong } from '../errors.js';

import { isGeometry, isObject } from './flags.js';

/**
 * A model: a scene, mesh or geometry, or what GLTFLoader loaded. Only of the latter the skeleton of a VRM is known by its bones, and
 * its face by its expressions; else the names of objects and morph targets count.
 */
export type Loaded = Object3D | BufferGeometry | LoadedGltf;

/** A cage: as a model, or as arrays, such as a `Cage` or `Template` of `cagecast/cages`. */
export type LoadedCage = Loaded | Mesh;

/** How a glTF lays a texture on UVs. */
interface TextureInfo {
  texCoord?: number;
  extensions?: {
    KHR_texture_transform?: {
      offset?: [number, number];
      rotation?: number;
      scale?: [number, number];
      texCoord?: number;
    };
  };
}

/** What GLTFLoader loads, as far as it is used here. */
export interface LoadedGltf {
  scene: Object3D;
  userData?: Record<string, unknown>;
  parser?: {
    associations?: Map<object, { nodes?: number; meshes?: number; primitives?: number } | undefined>;
    json?: {
      extensions?: VrmExtensions;
      meshes?: { primitives: { material?: number }[] }[];
      materials?: { pbrMetallicRoughness?: { baseColorTexture?: TextureInfo } }[];
    };
  };
}

export const isLoadedGltf = (model: unknown): model is LoadedGltf =>
  (model as LoadedGltf | undefined)?.scene?.isObject3D === true;

/** Whether something is a mesh as arrays. */
export const isArrays = <T extends Mesh>(cage: Loaded | T): cage is T =>
  (cage as Mesh | undefined)?.positions !== undefined;

/** Whether something is a model or a cage, of any kind. */
export const isModel = (one: unknown): boolean =>
  isLoadedGltf(one) || isGeometry(one as never) || isObject(one as never) || isArrays(one as Loaded);

/**
 * The scene, mesh or geometry of a model, or of a cage.
 * @param argument  Its name, for messages: only a `cage` or `template` may be arrays.
 * @throws {CagecastError} `badArgument`
 */
export function objectOf(model: LoadedCage, argument = 'model'): Object3D | BufferGeometry {
  if (isLoadedGltf(model)) return model.scene;
  if (isArrays(model)) {
    if (isCage(argument)) return geometryOf(model);
  } else if (isGeometry(model) || isObject(model)) return model;
  const what = `a loaded glTF, a scene, a mesh${isCage(argument) ? ', a geometry or a cage of cagecast/cages' : ' or a geometry'}`;
  throw wrong(`${argument} is ${show(model)}, not ${what}`, undefined, undefined, { argument });
}

/** Whether an argument is a cage, by its name. */
export const isCage = (argument: string): boolean => argument === 'cage' || argument === 'template';

/** The geometry of a cage's arrays, which it shares, with what else is known of it in its `userData`. */
export function geometryOf(cage: Mesh & Partial<Omit<Cage, keyof Mesh>>): BufferGeometry {
  const { positions, uvs, indices, landmarks = {}, holes = {}, kind = 'automatic', regions, bare } = cage;
  for (const [name, array] of Object.entries({ positions, indices }))
    if (!ArrayBuffer.isView(array)) throw notA('a typed array', `cage.${name}`, array);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  if (uvs) geometry.setAttribute('uv', new BufferAttribute(uvs, 2));
  geometry.setIndex(new BufferAttribute(indices, 1));
  geometry.userData = { landmarks, holes, kind, ...(regions && { regions }), ...(bare && { bare }) };
  return geometry;
}
