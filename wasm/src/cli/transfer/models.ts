import { cageGlb } from '../../cages/cage-glb.js';
import type { Cage } from '../../cages/types.js';
import {
  type Extracted,
  extract,
  type Part,
  partOf,
  primitivePath,
  uvLayout,
  type WhichCount,
} from '../../gltf/extract-file.js';
import type { ReadOptions } from '../../gltf/files.js';
import { InputError } from '../../gltf/input-error.js';
import { type GltfFile, readGltf } from '../../gltf/read-gltf.js';
import { CagecastError } from '../../index.js';
import { hasCages } from '../../parts/own-cages.js';
import type { Io } from '../io/io.js';
import { quoted } from '../model/text.js';

/** A file, and all triangles of its scene. */
export interface ReadModel {
  file: GltfFile;
  extracted: Extracted;
}

/** How a model is read. */
interface ModelOptions {
  /** Its content, if it is known already. */
  bytes?: Uint8Array | undefined;
  /** Default: as of a cage. */
  whichCount?: WhichCount;
}

/** Reads a model. @throws {InputError} that names the file. */
export async function readModel(
  path: string,
  reading: ReadOptions,
  io: Io,
  { bytes, whichCount = 'cage' }: ModelOptions = {},
): Promise<ReadModel> {
  io.step(`reading ${path}`);
  const file = await readGltf(path, reading, bytes);
  const extracted = extract(file, 'own', whichCount);
  if (extracted.mesh.indices.length > 0) return { file, extracted };
  const what = (file.json.meshes ?? []).length === 0 ? 'meshes' : 'triangles in its scene';
  throw new InputError(`has no ${what}; at least one triangle is needed`).in(path);
}

/** How many models a batch keeps. */
const kMaxKept = 8;

/** Returns a `readModel` that keeps the last models that it was asked for. */
export function cachedReading(): typeof readModel {
  const known = new Map<string, Promise<ReadModel>>();
  return (path, reading, io) => {
    const key = JSON.stringify([path, reading]);
    const model = known.get(key) ?? readModel(path, reading, io);
    known.delete(key);
    known.set(key, model);
    for (const [oldest] of known) if (known.size > kMaxKept) known.delete(oldest);
    return model;
  };
}

/** The same if it has UVs, as a cage must. @throws {InputError} that names the file and the primitive. */
export function withUvs(model: ReadModel): ReadModel {
  const { file, extracted } = model;
  if (extracted.mesh.uvs !== undefined) return model;
  const setOf = (part: Part) => uvLayout(file.json, part).set;
  const part = extracted.parts.find(
    (one) => file.json.meshes![one.mesh]!.primitives[one.primitive]!.attributes[setOf(one)] === undefined,
  )!;
  throw new InputError(
    `${primitivePath(part)} (${quoted(part.name)}) has no ${setOf(part)}: the texture is drawn in the cage's UVs`,
  ).in(file.path);
}

/** The cage that a target has with it. @throws {InputError} that names the file, if it has none. */
export function cageIn({ file }: ReadModel): ReadModel {
  const extracted = extract(file, 'own', 'cage');
  if (hasCages(extracted.parts)) return { file, extracted };
  throw new InputError(
    'has no cage: no mesh in it is named as an outer cage, as Head_OuterCage of Head_Geo; give one with --cage, or let --cage auto make one',
  ).in(file.path);
}

/** A cage around a model, as if it was read from a file. */
export async function readBack(cage: Cage, path: string, { extracted: { origin } }: ReadModel): Promise<ReadModel> {
  const file = await readGltf(path, undefined, cageGlb({ ...cage, origin }));
  return { file, extracted: extract(file, origin, 'cage') };
}

/** A cage around the origin of its target. */
export function besideOf({ extracted: { origin } }: ReadModel, cage: ReadModel): ReadModel {
  const isBeside = cage.extracted.origin.every((x, k) => x === origin[k]);
  return isBeside ? cage : { ...cage, extracted: extract(cage.file, origin, 'cage') };
}

/** Calls the core for two models. @throws {InputError} that names the file at fault and the place in it. */
export function inFile<Result>(models: { target: ReadModel; cage: ReadModel }, call: () => Result): Result {
  try {
    return call();
  } catch (error) {
    if (!(error instanceof CagecastError)) throw error;
    const { reason, argument, code, at } = error;
    const { file, extracted } = models[argument === 'cage' ? 'cage' : 'target'];
    const perVertex = { nonFinitePosition: 3, tooLarge: 3, nonFiniteUv: 2 }[code as string];
    const part = perVertex === undefined ? undefined : partOf(extracted.parts, Math.floor(at / perVertex));
    const where = part ? ` (${primitivePath(part)}, ${quoted(part.name)})` : '';
    throw new InputError(`${reason}${where}`).in(file.path);
  }
}
