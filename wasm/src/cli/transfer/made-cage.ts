import { findLandmarks, fitCage, init, makeCage, matchingParts } from '../../cages/sync.js';
import type { Cage, CageModel, Fit, FitOptions, Landmarks, MakeOptions, Template } from '../../cages/types.js';
import { FileModel } from '../../gltf/bake/bake-file.js';
import { baseColorsOf } from '../../gltf/bake/base-colors.js';
import { cageModelOf, partNamesOf } from '../../gltf/cage-file.js';
import { partsBelow } from '../../gltf/extract-file.js';
import { InputError } from '../../gltf/input-error.js';
import type { ReadModel } from '../../gltf/read-model.js';
import { CagecastError } from '../../index.js';
import { decodeImage } from '../io/images.js';
import type { Io } from '../io/io.js';
import { noSuchName } from './part-names.js';

/** Makes a cage for a model. @throws {InputError} that names the file. */
export async function makeCageFor(model: ReadModel, options: MakeOptions, io: Io): Promise<Cage> {
  const named = await withExcluded(model, options.exclude);
  const cage = await calling('making a cage', { model: model.file.path }, io, (onProgress) =>
    makeCage(named, { ...options, onProgress }),
  );
  return inOwnNames(cage, named, model);
}

/** The landmarks that are found on a model: with them, a cage that was made for it is a template. @throws {InputError} */
export async function landmarksOf(model: ReadModel, io: Io): Promise<Landmarks> {
  const read = await cageModelWithColors(model);
  return calling('finding landmarks', { model: model.file.path }, io, (onProgress) => {
    const { landmarks } = findLandmarks(read, { onProgress });
    return landmarks;
  });
}

/** A model with base colours, as far as their images can be read. */
async function cageModelWithColors({ file, extracted }: ReadModel): Promise<CageModel> {
  const colors = await baseColorsOf(new FileModel(file, extracted.parts), decodeImage);
  return { ...cageModelOf(file, extracted), ...colors };
}

/**
 * A model whose parts are known by patterns: if no part has such a name, all below nodes that have it get it.
 * @throws {InputError} that names the file and the pattern that matches nothing.
 */
async function withExcluded({ file, extracted }: ReadModel, patterns: readonly string[] = []): Promise<CageModel> {
  await init();
  const model = await cageModelWithColors({ file, extracted });
  const names = [...model.parts!];
  const { nodes = [] } = file.json;
  for (const pattern of patterns) {
    if (matchingParts(names, [pattern]).includes(true)) continue;
    const isAbove = matchingParts(
      nodes.map(({ name = '' }) => [name]),
      [pattern],
    );
    const below = partsBelow(file.json, extracted.parts, isAbove);
    if (below.length === 0) throw noSuchName(`--exclude ${pattern}`, { file, extracted }).in(file.path);
    const added = nodes.flatMap(({ name = '' }, n) => (isAbove[n] ? [name] : []));
    for (const p of below) names[p] = [names[p]!, added].flat();
  }
  return { ...model, parts: names };
}

/** A cage that leaves parts bare by names of their own, where it does by those of nodes above them. */
function inOwnNames(cage: Cage, named: CageModel, { file, extracted: { parts } }: ReadModel): Cage {
  const own = partNamesOf(file, parts).flat();
  const below = (node: string) => parts.flatMap(({ name }, p) => (named.parts![p]!.includes(node) ? [name] : []));
  const bare = cage.bare?.flatMap((name) => (own.includes(name) ? [name] : below(name)));
  return { ...cage, ...(bare && { bare }) };
}

/** A template, landmarks of the model (none if there is no file of them), and the files that they come from. */
interface FitSources {
  template: Template;
  landmarks: Landmarks | undefined;
  files: { template: string; landmarks?: string | undefined };
  options: FitOptions;
}

/** Fits a template to a model. @throws {InputError} that names the file at fault. */
export async function fitCageTo(
  model: ReadModel,
  { template, landmarks, files, options }: FitSources,
  io: Io,
): Promise<Fit> {
  const named = await withExcluded(model, options.exclude);
  const fit = await calling('fitting the cage', { model: model.file.path, ...files }, io, (onProgress) =>
    fitCage(template, named, landmarks, { ...options, onProgress }),
  );
  return { ...fit, cage: inOwnNames(fit.cage, named, model) };
}

/** Calls a function that takes seconds, and shows how far it is. @param files  By the arguments that they are given as. */
async function calling<Result>(
  what: string,
  files: Record<string, string | undefined>,
  io: Io,
  call: (onProgress: (share: number, stage: string) => void) => Result,
): Promise<Result> {
  io.step(what);
  await init();
  try {
    return call((share, stage) => io.share(`${what}: ${stage}`, share));
  } catch (error) {
    if (!(error instanceof CagecastError)) throw error;
    throw new InputError(error.reason, { cause: error }).in(files[error.argument ?? 'model'] ?? files['model']!);
  }
}
