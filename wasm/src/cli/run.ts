import { cageGlb } from '../cages/cage-glb.js';
import type { Cage } from '../cages/types.js';
import { FileModel } from '../gltf/bake/bake-file.js';
import { masksOf } from '../gltf/bake/masks.js';
import { type Extracted, extract, type Part, partOf, primitivePath, uvLayout } from '../gltf/extract-file.js';
import type { ReadOptions } from '../gltf/files.js';
import { InputError, withName } from '../gltf/input-error.js';
import { type GltfFile, readGltf } from '../gltf/read-gltf.js';
import {
  CagecastError,
  type CutTarget,
  cutBorders,
  init,
  type Masks,
  type TransferOptions,
  type TransferResult,
  transfer,
} from '../index.js';
import { readImage } from './bake/images.js';
import { makeCageFor, partsLeftOut } from './make-cage.js';
import { quoted, type Rules, transferOptions } from './options.js';
import { type UvBounds, withinBounds, withoutLacking } from './paint/cage-area.js';
import type { Progress } from './progress.js';

/** Two files, read and transferred. */
export interface Run {
  targetFile: GltfFile;
  target: Extracted;
  cageFile: GltfFile;
  cage: Extracted;
  /** The cage before its UVs were moved to those of the texture. */
  wholeCage: ReadModel;
  /** The names of the parts that the cage was made without, if it was made on the way. */
  excluded?: readonly string[] | undefined;
  /** What `transfer` was called with. */
  options: TransferOptions;
  result: TransferResult;
}

/** The files of a transfer, and how they are read. */
export interface Sources {
  target: string;
  cage: string;
  /** The part of the cage's UVs that the texture covers; by default 0..1. */
  uvBounds?: UvBounds | undefined;
  /** A cage with the UVs of all triangles that count; others count as cut away. */
  referenceCage?: string | undefined;
  rules: Rules;
  reading: ReadOptions;
}

/** The name of a cage that is made on the way; a file of this name is `./auto`. */
export const autoCage = 'auto';

/**
 * Reads target and cage, or makes a cage, and runs the transfer.
 * @param readCage  How cages are read.
 * @param target    If it is read already.
 * @throws {InputError} that names the file at fault.
 */
export async function runTransfer(
  sources: Sources,
  progress: Progress,
  readCage: typeof readModel = readModel,
  target?: ReadModel,
): Promise<Run> {
  const { rules, reading } = sources;
  const read = target ?? (await readModel(sources.target, reading, progress));
  const masks = await readMasks(read, rules, reading);
  const isMade = sources.cage === autoCage;
  const leftOut = isMade ? await partsLeftOut(read) : [];
  const options = { ...optionsFor(read, rules, leftOut), ...(masks && { masks }) };
  const cageOf = async (path: string) => withUvs(await readCage(path, reading, progress));
  const whole = isMade ? await madeCage(read, progress) : await cageOf(sources.cage);
  const reference = sources.referenceCage === undefined ? undefined : await cageOf(sources.referenceCage);
  const drawn = withoutLacking(whole, reference);
  const run = await transferModels(read, withinBounds(drawn, sources.uvBounds), options, progress);
  const excluded = isMade ? excludedNames(read, leftOut, options) : undefined;
  return { ...run, wholeCage: drawn, excluded };
}

/** The masks of a target. @throws {InputError} that names the file at fault. */
async function readMasks(
  { file, extracted }: ReadModel,
  { masks, config, configMasks = [], maskFolder }: Rules,
  reading: ReadOptions,
): Promise<Masks | undefined> {
  if (!masks) return undefined;
  const [never, always] = await Promise.all(
    (['never', 'always'] as const).map((kind) => {
      const path = masks[kind];
      if (path === undefined) return undefined;
      if (!configMasks.includes(kind)) return readImage(path, reading);
      return readImage(path, reading, maskFolder).catch((error: unknown) => {
        throw withName(error, `${config}: "${kind}Mask"`);
      });
    }),
  );
  try {
    const images = never || always ? { never, always } : undefined;
    return masksOf(new FileModel(file, extracted.parts), undefined, { images, colors: masks.colors });
  } catch (error) {
    throw withName(error, file.path);
  }
}

/** Returns a `readModel` that keeps the last models that it was asked for. */
export function cachedReading(): typeof readModel {
  const most = 8;
  const known = new Map<string, Promise<ReadModel>>();
  return (path, reading, progress) => {
    const key = JSON.stringify([path, reading]);
    const model = known.get(key) ?? readModel(path, reading, progress);
    known.delete(key);
    known.set(key, model);
    for (const [oldest] of known) if (known.size > most) known.delete(oldest);
    return model;
  };
}

/** A file, and all triangles of its scene. */
export interface ReadModel {
  file: GltfFile;
  extracted: Extracted;
}

/** Reads a model. @param bytes  Its content, if it is known already. @throws {InputError} that names the file. */
export async function readModel(
  path: string,
  reading: ReadOptions,
  progress: Progress,
  bytes?: Uint8Array,
): Promise<ReadModel> {
  progress.step(`reading ${path}`);
  const file = await readGltf(path, reading, bytes);
  return { file, extracted: withTriangles(file, extract(file)) };
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

/** Makes a cage for a target, with default options. */
async function madeCage(target: ReadModel, progress: Progress): Promise<ReadModel> {
  const cage = await makeCageFor(target, {}, progress);
  return readBack(cage, autoCage);
}

/** A cage as if it was read from a file. */
export async function readBack(cage: Cage, path: string): Promise<ReadModel> {
  const file = await readGltf(path, undefined, cageGlb(cage));
  return { file, extracted: extract(file) };
}

/** Transfers from a cage to a target that are read. @throws {InputError} that names the file at fault. */
export async function transferModels(
  target: ReadModel,
  cage: ReadModel,
  options: TransferOptions,
  progress: Progress,
): Promise<Run> {
  const vertices = target.extracted.mesh.positions.length / 3;
  progress.step(`transferring to ${vertices.toLocaleString('en')} vertices`);
  await init();
  const files = { targetFile: target.file, target: target.extracted, cageFile: cage.file, cage: cage.extracted };
  try {
    return {
      ...files,
      wholeCage: cage,
      options,
      result: transfer(files.cage.mesh, files.target.mesh, options),
    };
  } catch (error) {
    throw inFile(error, files);
  }
}

/** The names of the parts that are left out and not kept. */
const excludedNames = ({ extracted }: ReadModel, leftOut: readonly boolean[], { locks }: TransferOptions): string[] => [
  ...new Set(extracted.parts.filter((_, p) => leftOut[p] && locks?.groups?.[p] !== 'keep').map(({ name }) => name)),
];

function optionsFor(model: ReadModel, rules: Rules, leftOut: readonly boolean[]): TransferOptions {
  try {
    return transferOptions(rules, model, leftOut);
  } catch (error) {
    throw withName(error, model.file.path);
  }
}

/** The same if it has triangles. @throws {InputError} that names the file. */
function withTriangles(file: GltfFile, extracted: Extracted): Extracted {
  if (extracted.mesh.indices.length === 0) {
    throw new InputError(
      `has no ${(file.json.meshes ?? []).length === 0 ? 'meshes' : 'triangles in its scene'}; at least one triangle is needed`,
    ).in(file.path);
  }
  return extracted;
}

/** Adds the file, and the place in it, to an error of the core; returns any other error unchanged. */
function inFile(
  error: unknown,
  { targetFile, target, cageFile, cage }: Pick<Run, 'targetFile' | 'target' | 'cageFile' | 'cage'>,
): unknown {
  if (!(error instanceof CagecastError)) return error;
  const { reason, argument, code, at } = error;
  const [{ path }, { parts }] = argument === 'cage' ? [cageFile, cage] : [targetFile, target];
  const perVertex = { nonFinitePosition: 3, tooLarge: 3, nonFiniteUv: 2 }[code as string];
  const part = perVertex === undefined ? undefined : partOf(parts, Math.floor(at / perVertex));
  const where = part ? ` (${primitivePath(part)}, ${quoted(part.name)})` : '';
  return new InputError(`${reason}${where}`).in(path);
}

/** Cuts the target. @throws {InputError} that names the file and the element at fault. */
export function cutTarget(run: Run, progress: Progress): CutTarget {
  progress.step('cutting borders');
  try {
    return cutBorders(run.cage.mesh, run.target.mesh, run.result, run.options);
  } catch (error) {
    throw inFile(error, run);
  }
}
