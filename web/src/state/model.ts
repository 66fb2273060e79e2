import type { Landmarks } from 'cagecast/cages';
import { type AnimationClip, type Mesh, type Object3D, Vector3 } from 'three';
import type { LoadedGltf, Part } from '#three';
import type { Sample } from './sample';

/** One triangle mesh of the scene, and the ranges of its elements in the concatenated arrays; its name is for people. */
export interface Primitive extends Omit<Part, 'geometry'> {
  mesh: Mesh;
  /** Whether its matrix mirrors it; its winding is reversed then. */
  mirrored: boolean;
  /** The weights of its morph targets in the file, which have shaped its positions. */
  weights: readonly number[];
}

/** All triangles of a scene as arrays in world space, as the transfer takes them. */
export interface ExtractedMesh {
  /** 3 per vertex, in the scene's space; they may be deformed. */
  positions: Float32Array;
  /** The positions in the file, if `positions` may have been deformed. */
  rest?: Float32Array;
  /** Where the vertices are in poses of the face, as `poses` of a `Mesh`. */
  poses?: Float32Array | undefined;
  /** 3 per triangle, counter-clockwise seen from outside. */
  indices: Uint32Array;
  /** 2 per vertex: where it is in its base colour texture; without one, the first set. Absent unless every primitive has UVs. */
  uvs?: Float32Array | undefined;
  /** Of a cage, as `otherUvSets` of a `Mesh`. */
  otherUvSets?: readonly number[] | undefined;
  /** 1 per vertex: the index of its primitive. Only vertices of the same primitive are welded. */
  groups: Uint32Array;
  primitives: Primitive[];
  /** The groups of what a figure wears or carries: it stays bare unless the user decides otherwise. */
  accessories: readonly number[];
  /** The names of each group. */
  names: string[][];
  /** Of a cage, the names of the parts that it leaves bare. */
  bare: string[];
  /** The names of what is left out, as it is not drawn, or is a cage, a marker or a collision shape. */
  leftOut: readonly string[];
}

/** A loaded model: the scene to show, and its triangles for the transfer. */
export interface Model {
  /** The file's name, for people. */
  name: string;
  /** The file, then those it refers to. */
  files: readonly File[];
  scene: Object3D;
  /** The scene with what says which nodes are the bones of a VRM. */
  loaded: LoadedGltf;
  animations: readonly AnimationClip[];
  mesh: ExtractedMesh;
  /** The same as a cage: its outer cages if there are any, else all, drawn or not. */
  cageMesh: ExtractedMesh;
  /** How long it took to read, in milliseconds; absent for what was not read from a file. */
  spent?: number;
  /** A message about images that cannot be shown; the model is usable all the same. */
  damage?: string;
  /** The sample it belongs to; undefined for the user's own files. */
  sample?: Sample;
}

const cages = new WeakMap<Model, Model>();
const targets = new WeakMap<Model, Model>();

/** A model as it is a cage. */
export function asCage(model: Model): Model {
  if (model.mesh === model.cageMesh) return model;
  const cage = cages.get(model) ?? { ...model, mesh: model.cageMesh };
  cages.set(model, cage);
  targets.set(cage, model);
  return cage;
}

/** The cage that a model has with it: the meshes that are named so. */
export const ownCage = (model: Model): Model | undefined =>
  model.cageMesh.leftOut.length > 0 && model.mesh.primitives.length > 0 ? asCage(model) : undefined;

/** Landmarks of the model that a cage is for, as the cage's file has them, in the space of its scene. */
export function landmarksOf({ scene }: Pick<Model, 'scene'>): Landmarks {
  const found: Record<string, Landmarks[string]> = {};
  scene.traverse((object) => {
    const landmarks = Object.entries((object.userData['landmarks'] ?? {}) as Landmarks);
    if (landmarks.length > 0) object.updateWorldMatrix(true, false);
    for (const [name, at] of landmarks) {
      const { x, y, z } = object.localToWorld(new Vector3(...at));
      found[name] = [x, y, z];
    }
  });
  return found;
}

/** Whether a cage has landmarks of a face. */
export const hasFace = (cage: Pick<Model, 'scene'>): boolean =>
  Object.keys(landmarksOf(cage)).some((name) => name.startsWith('eye_'));

/** A model as it is a target. @throws Error that begins with the file's name, if nothing of it is drawn. */
export function asTarget(cage: Model): Model {
  const model = targets.get(cage) ?? cage;
  if (model.mesh.primitives.length > 0) return model;
  throw new Error(`${model.name}: nothing of it is drawn but cages, markers and collision shapes; open it as a cage`);
}

/** Where the origin of a model that was moved is in the scene of its file. */
export const originOf = ({ scene: { position } }: Model): [number, number, number] => [
  0 - position.x,
  0 - position.y,
  0 - position.z,
];

/** Reads models. The page's own is `loadModel`; tests hand in others. */
export interface Loader {
  /**
   * @param companions Files a .gltf may refer to (its .bin, its images), found by name.
   * @param signal Ends the reading of a model of another format, which may take long.
   * @throws Error with a message that begins with the file's name.
   */
  load(file: File, companions?: readonly File[], signal?: AbortSignal): Promise<Model>;
  /** Loads a GLB that comes with the page, and is trusted. */
  loadOwn(file: File): Promise<Model>;
  /** Frees the GPU memory of a model. */
  dispose(model: Model): void;
}
