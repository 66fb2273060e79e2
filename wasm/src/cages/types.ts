import type { Mesh } from '../api/mesh.js';
import type { Parts } from '../api/parts.js';
import type { Image } from '../bake/index.js';

/** x, y, z in the space of the model. */
export type Position = readonly [x: number, y: number, z: number];

/** Named spots on a model, such as `nose_tip` or `eye_centre_left`: docs/cages.md lists the names. */
export type Landmarks = Record<string, Position>;

/** The vertices along the border of each hole of a cage that has a name. */
export type Holes = Record<string, readonly number[]>;

/** A closed outline in the UVs of a cage: its corners, at least 3. */
export type Outline = readonly (readonly [u: number, v: number])[];

/**
 * Regions of a cage by name, such as `lips`, in its UVs: what an odd number of a region's outlines surrounds. They are known wherever
 * the cage is fitted to; `regionMask` of `cagecast/engines` makes images of them.
 */
export type Regions = Record<string, readonly Outline[]>;

/** A joint of a skeleton, in the pose in which the mesh is given. */
export interface Joint {
  /** As in the file, or, in a VRM, the name of its bone (`leftUpperArm`). */
  name: string;
  position: Position;
  /** Its parent's place in the list; -1, the default, for a root. */
  parent?: number | undefined;
}

/** What a part looks like without light: its image, if it has one, times a colour. */
export interface BaseColor {
  /** Red, green, blue in linear light, 0..1. Default: white. */
  factor?: readonly [red: number, green: number, blue: number] | undefined;
  /**
   * Lies on the part by the model's UVs, and is repeated beyond 0..1. Pixels whose alpha is below one half are not there. 512 pixels
   * along the longest side say enough. Parts may share one. Default: none.
   */
  image?: Image | undefined;
  /** Whether that says all: `false` where an image could not be read. Default: true. */
  isKnown?: boolean | undefined;
}

/**
 * The model of a cage: a mesh as for `transfer`, with all that is known about it. Its UVs belong to `baseColors`; by its `names`, parts are
 * excluded. `cageModel` of
 * `cagecast/gltf` and `cagecast/three` reads it from a model.
 */
export interface CageModel extends Mesh {
  /** The skeleton's joints. Default: none. */
  joints?: readonly Joint[] | undefined;
  /** 1 per triangle: 1 must not be painted. Default: none of them; for that leave it out, as an empty array is an error. */
  marks?: Uint8Array | undefined;
  /**
   * Where names say that the face is, such as those of morph targets: `eye_inner`, `eye_outer` and `mouth_corner` of both sides, and
   * `mouth`, the middle between the lips. Given landmarks count more, found ones less. Default: none.
   */
  hints?: Landmarks | undefined;
  /**
   * The joint that holds each vertex most, as its place in `joints`; 65535 for none. What a head's joints hold is where a face is
   * looked for. Default: not known.
   */
  vertexJoints?: Uint16Array | undefined;
  /**
   * What each part looks like, by its number in `groups`. A painted face is looked for in it where names, bones and shape do not say
   * enough. Default: not known.
   */
  baseColors?: readonly BaseColor[] | undefined;
}

/** What a model is: it decides resolution, tightness and seams of a cage. */
export type Kind = 'automatic' | 'head' | 'body' | 'prop';

/** A cage: a mesh for `transfer`, and spots of the model that it was made for. */
export interface Cage {
  /** 3 per vertex, in the space of the model. */
  positions: Float32Array<ArrayBuffer>;
  /** 2 per vertex, 0..1. Seams have a vertex for each side. */
  uvs: Float32Array<ArrayBuffer>;
  /** 3 per triangle, counter-clockwise seen from outside. */
  indices: Uint32Array<ArrayBuffer>;
  /** What a fit needs of a template. May be empty. */
  landmarks: Landmarks;
  /** May be empty. */
  holes: Holes;
  /** What it was made for; `automatic` if that is not known. */
  kind: Kind;
  /** Those of its template. Default: none. */
  regions?: Regions | undefined;
  /**
   * Names of parts of its model that were excluded. Transfers to loaded models exclude parts of these names, too. Default: none.
   */
  bare?: readonly string[] | undefined;
}

/** A cage that is to be fitted to other models. A `Cage` is one. */
export interface Template extends Mesh {
  uvs: Float32Array;
  /** Spots of the model that the cage was made for, by the names that docs/cages.md lists: 4 to 300. */
  landmarks: Landmarks;
  /** Default: none. */
  holes?: Holes | undefined;
  /** The fitted cage gets it, too. Default: `automatic`. */
  kind?: Kind | undefined;
  /** The fitted cage gets them, too. Default: none. */
  regions?: Regions | undefined;
}

/** What a fit found. */
export interface Fit {
  cage: Cage;
  /** Landmarks of the model that were used, given and found. */
  used: Landmarks;
  /** How certain each of `used` is, 0..1; 1 for a given one, or the place of a bone. */
  confidence: Record<string, number>;
  /** Landmarks of the template that were not found: give these for a better fit. */
  missing: string[];
  /**
   * Landmarks of `used` that are guesses, because fewer than four were known: the model is taken for the template's own, stretched to
   * its size. Give some of these first: eyes, nose, mouth and chin of a head. Empty if enough were known.
   */
  guessed: string[];
}

/** What was found on a model. */
export interface FoundLandmarks {
  landmarks: Landmarks;
  /** How certain each landmark is, 0.5..1; 1 for those that a bone tells. */
  confidence: Record<string, number>;
  /** Landmarks that were not found, or are too uncertain. */
  missing: string[];
  /** `VRM`, `Mixamo`, `Ready Player Me`, `Roblox R15`, `VRoid`, `Rigify`, `other`, `unknown`; empty without a skeleton. */
  rig: string;
  /** What the model seems to be. */
  kind: Kind;
}

/**
 * Options of `makeCage`. Lengths are shares of the diagonal of the model's bounding box, 0.0005 to 0.2. 0, the default of all
 * numbers, means by kind.
 */
export interface MakeOptions {
  /** Parts to ignore, keep or exclude. Holes are over excluded parts, also those of `excludedByName` unless they are kept. */
  parts?: Parts | undefined;
  /** Default: `automatic`. */
  kind?: Kind | undefined;
  /** Triangles of the cage, about: 50 to 20,000. By kind: heads and props 600, bodies 1500. */
  triangles?: number | undefined;
  /** Gaps narrower than twice this, or two voxels, are bridged. By kind: heads and props 0.02, bodies 0.008. */
  closing?: number | undefined;
  /** Distance of the cage from the model. By kind: heads and props 0.01, bodies 0.004. */
  offset?: number | undefined;
  /** Voxels along the longest side of the grid that the hull is made on: 16 to 400. By kind: heads and props 140, bodies 240. */
  voxels?: number | undefined;
}

/** Options of `fitCage`. */
export interface FitOptions {
  /** Parts to ignore, keep or exclude. Excluded parts are no skin, nor are those of `excludedByName` unless they are kept. */
  parts?: Parts | undefined;
}

/** Options of `refineCage`. */
export interface RefineOptions {
  /** How far off the cage may be, as a share of the model's diagonal: 0.001 to 0.2. Default: 0.05. */
  reach?: number | undefined;
}
