import { statSync } from 'node:fs';
import { isTemplateName } from '../../cages/template-names.js';
import { errorInFile, type ReadModel } from '../../gltf/read-model.js';
import { hasCages } from '../../parts/own-cages.js';
import { clearPrimitives } from '../../scene/clear-textures.js';
import { extract, type WhichCount } from '../../scene/extract.js';
import { InputError } from '../../scene/input-error.js';
import type { UvSetChoice } from '../../scene/uv-sets.js';
import { decodeImage } from '../io/images.js';
import type { Io } from '../io/io.js';
import { readGltf } from '../io/read-gltf.js';
import type { ReadOptions } from '../model/reading.js';

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
  if (whichCount === 'cage' && isTemplateName(path) && !statSync(path, { throwIfNoEntry: false })?.isFile())
    throw new InputError(`no such file; to fit the template of this name, give --template ${path}`).in(path);
  const read = await readGltf(path, reading, bytes);
  const file = whichCount === 'cage' ? read : { ...read, clear: await clearPrimitives(read, decodeImage) };
  const extracted = extract(file, 'own', whichCount, '; name what counts by --keep');
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

/** The cage that a target has with it. @throws {InputError} that names the file, if it has none. */
export function cageIn({ file: target }: ReadModel, cageUvs: UvSetChoice | undefined): ReadModel {
  const file = { ...target, cageUvs };
  const extracted = extract(file, 'own', 'cage');
  if (hasCages(extracted.parts)) return { file, extracted };
  throw new InputError(
    'has no cage: no mesh in it is named as an outer cage, as Head_OuterCage of Head_Geo; give one with --cage, or let --cage auto make one',
  ).in(file.path);
}

/** Calls the core for two models. @throws {InputError} that names the file at fault and the place in it. */
export function inFile<Result>(models: { target: ReadModel; cage: ReadModel }, call: () => Result): Result {
  try {
    return call();
  } catch (error) {
    throw errorInFile(error, models);
  }
}
