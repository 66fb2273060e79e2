import { CagecastError, init as initCore } from '../../api/index.js';
import { type Choice, choose } from '../../cages/choose.js';
import { fitCage, init, makeCage } from '../../cages/sync.js';
import type { Cage, CageModel, Fit, FitOptions, Landmarks, MakeOptions, Template } from '../../cages/types.js';
import type { ReadModel } from '../../gltf/read-model.js';
import { inspect } from '../../inspect/index.js';
import { cageModelOf } from '../../scene/cage-model.js';
import { InputError } from '../../scene/input-error.js';
import { decodeSmall } from '../io/images.js';
import type { Io } from '../io/io.js';

/** Makes a cage for a model. @throws {InputError} that names the file. */
export async function makeCageFor(model: ReadModel, options: MakeOptions, io: Io): Promise<Cage> {
  await init();
  const read = await cageModelWithColors(model, io);
  return calling('making a cage', { model: model.file.path }, io, (onProgress) =>
    makeCage(read, { ...options, onProgress }),
  );
}

/** A model with base colours, as far as their images can be read. */
function cageModelWithColors({ file, extracted }: ReadModel, io: Io): Promise<CageModel> {
  io.step('looking at the colours');
  return cageModelOf(file, extracted, decodeSmall);
}

/** A template, landmarks of the model (none if there is no file of them), and the files that they come from. */
interface FitSources {
  template: Template;
  landmarks: Landmarks | undefined;
  files: { template: string; landmarks?: string | undefined };
  options: FitOptions;
}

/** How a model came by its cage: by the name or file of a template, or `made`; and what was tried. */
export interface Chosen extends Pick<Choice, 'tried'> {
  template: string;
}

/** Chooses the cage of a model. @throws {InputError} that names the file at fault. */
export async function chooseCageFor(
  model: ReadModel,
  { landmarks, files, options }: Omit<FitSources, 'template'>,
  io: Io,
): Promise<{ cage: Cage; fit: Fit | undefined; choice: Chosen }> {
  await initCore();
  const read = await cageModelWithColors(model, io);
  return calling('choosing the cage', { model: model.file.path, ...files }, io, async (onProgress) => {
    const engine = { fitCage, makeCage, inspect };
    const { cage, fit, template, tried } = await choose(engine, read, { landmarks, ...options, onProgress });
    return { cage, fit, choice: { template, tried } };
  });
}

/** Fits a template to a model. @throws {InputError} that names the file at fault. */
export async function fitCageTo(
  model: ReadModel,
  { template, landmarks, files, options }: FitSources,
  io: Io,
): Promise<Fit> {
  await init();
  const read = await cageModelWithColors(model, io);
  return calling('fitting the cage', { model: model.file.path, ...files }, io, (onProgress) =>
    fitCage(template, read, landmarks, { ...options, onProgress }),
  );
}

/** Calls a function that takes seconds, and shows how far it is. @param files  By the arguments that they are given as. */
async function calling<Result>(
  what: string,
  files: Record<string, string | undefined>,
  io: Io,
  call: (onProgress: (share: number, stage: string) => void) => Result | Promise<Result>,
): Promise<Result> {
  io.step(what);
  await init();
  try {
    return await call((share, stage) => io.share(`${what}: ${stage}`, share));
  } catch (error) {
    if (!(error instanceof CagecastError)) throw error;
    throw new InputError(error.reason, { cause: error }).in(files[error.argument ?? 'model'] ?? files['model']!);
  }
}
