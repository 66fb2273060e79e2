import {
  type CutTarget,
  cutBorders,
  init,
  type Masks,
  type TransferOptions,
  type TransferResult,
  transfer,
} from '../../api/index.js';
import type { Cage } from '../../cages/types.js';
import { masksOf } from '../../gltf/bake/mask-sources.js';
import { bareParts, besideOf, movedApart, type ReadModel, readBack, turned, withUvs } from '../../gltf/read-model.js';
import { isBackward } from '../../inspect/backward.js';
import { boxOf } from '../../inspect/geometry.js';
import { naming } from '../../scene/input-error.js';
import { Materials } from '../../scene/materials.js';
import type { UvSetChoice } from '../../scene/uv-sets.js';
import { readImage } from '../io/images.js';
import type { Io } from '../io/io.js';
import type { ReadOptions } from '../model/reading.js';
import type { Rules } from '../model/settings.js';
import { kAutoCage, type Sources } from '../model/sources.js';
import { withinBounds, withoutLacking } from './cage-area.js';
import { type Chosen, chooseCageFor, fitCageTo, makeCageFor } from './made-cage.js';
import { cageIn, inFile, readModel } from './models.js';
import { transferOptions } from './part-names.js';
import { readTarget } from './read-target.js';
import { readTemplate } from './template.js';

/** Two models, and what was transferred. */
export interface Run {
  target: ReadModel;
  cage: ReadModel;
  /** The cage before its UVs were moved to those of the texture. */
  wholeCage: ReadModel;
  /** Of the target before its parts were moved apart, if they were. */
  diagonal?: number;
  /** The names of the parts that stay bare because of their names. */
  bare?: readonly string[] | undefined;
  /** Whether the cage faced the other way, and was turned by half about the vertical axis. */
  isTurned?: boolean;
  /** How the cage was come by, if there was a template. */
  choice?: Chosen | undefined;
  /** What `transfer` was called with. */
  options: TransferOptions;
  result: TransferResult;
}

/**
 * Reads target and cage, or makes a cage, and runs the transfer.
 * @param readCage  How cages are read.
 * @param read      The target, if it is read already.
 * @throws {InputError} that names the file at fault.
 */
export async function runTransfer(
  { target: path, cage, template, isOwnCage, cageUvs, uvBounds, referenceCage, rules, reading }: Sources,
  io: Io,
  readCage: typeof readModel = readModel,
  read?: ReadModel,
): Promise<Run> {
  const target = read ?? (await readTarget(path, reading, io, rules));
  const masks = await readMasks(target, rules.masks, reading);
  const cageOf = async (file: string, uvs?: UvSetChoice) =>
    besideOf(
      target,
      withUvs(
        isOwnCage && file === cage ? cageIn(target, uvs) : await readCage(file, { ...reading, cageUvs: uvs }, io),
      ),
    );
  const { parts } = transferOptions(rules, target, []);
  const made = template === undefined ? undefined : await cageByTemplate(target, template, { parts, reading }, io);
  const own = made?.cage ?? (cage === kAutoCage ? await makeCageFor(target, { parts }, io) : undefined);
  const whole = own ? await readBack(own, template ?? kAutoCage, target) : await cageOf(cage, cageUvs);
  const bare = bareParts(target, whole);
  const options = { ...transferOptions(rules, target, bare), ...(masks && { masks }) };
  const reference = referenceCage === undefined ? undefined : await cageOf(referenceCage);
  const apart = movedApart(target, withoutLacking(whole, reference), '; --ignore leaves the part out');
  const { wholeCage } = apart;
  const first = await transferModels(apart.target, withinBounds(wholeCage, uvBounds), options, io);
  // Cages that have names know which way they face.
  const run = apart.target === target ? await faceForward(first, io) : first;
  const names = bare.flatMap((p) => (options.parts?.keep?.includes(p) ? [] : [target.extracted.parts[p]!.name]));
  const { diagonal } = boxOf(target.extracted.mesh.positions);
  return {
    ...run,
    wholeCage: run.isTurned ? turned(wholeCage) : wholeCage,
    diagonal,
    bare: [...new Set(names)],
    choice: made?.choice,
  };
}

/** A cage that is fitted, or chosen. @throws {InputError} that names the file at fault. */
async function cageByTemplate(
  target: ReadModel,
  template: string,
  { parts, reading }: Pick<TransferOptions, 'parts'> & { reading: ReadOptions },
  io: Io,
): Promise<{ cage: Cage; choice: Chosen }> {
  const sources = { landmarks: undefined, files: { template }, options: { parts } };
  if (template === kAutoCage) return chooseCageFor(target, sources, io);
  const from = await readTemplate(template, reading, io);
  const { cage } = await fitCageTo(target, { ...sources, template: from }, io);
  return { cage, choice: { template, tried: [] } };
}

/** A run as it is, or with its cage turned by half, if that faces the other way. */
async function faceForward(run: Run, io: Io): Promise<Run> {
  const { target, cage, options, result } = run;
  if (!isBackward(cage.extracted.mesh, target.extracted.mesh, result)) return run;
  return { ...(await transferModels(target, turned(cage), options, io)), isTurned: true };
}

/** The masks of a target. @throws {InputError} that names the file at fault. */
async function readMasks(
  { file, extracted }: ReadModel,
  { never, always, colors }: Rules['masks'],
  reading: ReadOptions,
): Promise<Masks | undefined> {
  if (!(never || always || colors)) return undefined;
  const [neverImage, alwaysImage] = await Promise.all(
    Object.entries({ never, always }).map(
      ([kind, mask]) =>
        mask &&
        (mask.config
          ? naming(`${mask.config.path}: "${kind}Mask"`, () => readImage(mask.path, reading, mask.config?.folder))
          : readImage(mask.path, reading)),
    ),
  );
  const images = never || always ? { never: neverImage, always: alwaysImage } : undefined;
  return naming(file.path, () => masksOf(new Materials(file, extracted.parts), undefined, { images, colors }));
}

/** Transfers from a cage to a target that are read. @throws {InputError} that names the file at fault. */
export async function transferModels(
  target: ReadModel,
  cage: ReadModel,
  options: TransferOptions,
  io: Io,
): Promise<Run> {
  io.step(`transferring to ${(target.extracted.mesh.positions.length / 3).toLocaleString('en')} vertices`);
  await init();
  const result = inFile({ target, cage }, () => transfer(cage.extracted.mesh, target.extracted.mesh, options));
  return { target, cage, wholeCage: cage, options, result };
}

/** Cuts the target. @throws {InputError} that names the file and the element at fault. */
export function cutTarget({ cage, target, result, options }: Run, io: Io): CutTarget {
  io.step('cutting borders');
  return inFile({ target, cage }, () => cutBorders(cage.extracted.mesh, target.extracted.mesh, result, options));
}
