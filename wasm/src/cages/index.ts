/**
 * Cages for models that have none: made afresh for one model, fitted from a template, or moved into place.
 *
 * Each call takes seconds and runs in a worker. The first call starts one, others at the same time start more, up to the number of
 * cores, at least two and at most four, or what `init({ workers })` says; further calls wait. One worker, or as many as `init` was told,
 * stay when nothing is left to do. With `worker: false`, and where there are no workers, a call runs on the thread that makes it. The
 * WebAssembly, `cagecast-cages.wasm`, is loaded by the first call.
 * @module cagecast/cages
 */

import type { InitOptions, Mesh, PartNames } from '../api/index.js';
import { faultOfNames } from '../api/option-names.js';
import { CagecastError, isRecord, show } from '../core/error.js';
import { inspect } from '../worker/index.js';
import { type CallOptions, faultOfCall, type OnProgress, type WorkerOptions, WorkerQueue } from '../worker/queue.js';
import { hasWorkers } from '../worker/thread-of.js';
import { type Choice, type ChooseOptions, choose } from './choose.js';
import { spawn } from './spawn-cages.js';
import type {
  Cage,
  CageModel,
  Fit,
  FitOptions,
  FoundLandmarks,
  Landmarks,
  MakeOptions,
  RefineOptions,
  Template,
} from './types.js';

export { cageGlb } from './cage-glb.js';
export type { Choice, ChooseOptions, Tried } from './choose.js';
export { objTemplate } from './obj-template.js';
export { type TemplateName, templateNames } from './template-names.js';
export { loadTemplate } from './templates.js';
export type * from './types.js';
export type { WorkerOptions };

/** Options of every call. */
export interface CageCallOptions extends CallOptions {
  /**
   * Told several times a second how far the call is: a share 0..1 that never falls, and what it does (`hull`, `unwrap`, …). If it
   * throws, the call is cancelled, and its promise rejects with what was thrown.
   */
  onProgress?: OnProgress | undefined;
  /**
   * Whether the call runs in a worker. Without, it keeps its thread busy, and `signal` ends it at its start only. Default: as
   * `init` was told; else true where there are workers: in browsers, Node, Deno and Bun, but not in edge functions.
   */
  worker?: boolean | undefined;
}

/** Options of `init`. */
export interface CagesInitOptions extends WorkerOptions, InitOptions, Pick<CageCallOptions, 'worker'> {}

/** Workers at most: each has a memory of its own, and more of them than cores gain nothing. */
const kMaxWorkers = 4;
const cores = globalThis.navigator?.hardwareConcurrency ?? kMaxWorkers;

const queue = new WorkerQueue(spawn, Math.max(2, Math.min(kMaxWorkers, cores)));

/** What `init` was told of `worker`. */
let told: boolean | undefined;

/** Whether calls run in a worker, if they do not say so themselves. */
const usual = (): boolean => told ?? hasWorkers();

/** Calls a function, in a worker or here. @param args  Its other arguments. */
function call<T>(fn: keyof typeof import('./sync.js'), args: unknown[], options: CageCallOptions): Promise<T> {
  if (!isRecord(options)) return queue.withOptions<T>(fn, args, options);
  const { worker = usual(), ...given } = options;
  return worker === true ? queue.withOptions<T>(fn, args, given) : callHere<T>(fn, args, { worker, ...given });
}

async function callHere<T>(fn: keyof typeof import('./sync.js'), args: unknown[], given: CageCallOptions): Promise<T> {
  const { worker, signal, move: _, ...options } = given;
  const fault = faultOfWorker(worker) ?? faultOfCall(given);
  if (fault !== undefined) throw new CagecastError('badOption', fn, fault);
  signal?.throwIfAborted();
  const here = await import('./sync.js');
  await here.init();
  return (here[fn] as (...args: unknown[]) => T)(...args, options);
}

/** What is wrong with a choice of `worker`, if anything is. */
const faultOfWorker = (worker: unknown): string | undefined =>
  typeof worker === 'boolean' ? undefined : `options.worker is ${show(worker)}, not true or false`;

/** @throws {CagecastError} if a document, a scene or a promise is given instead of a model, which cannot be sent to a worker. */
function checkIsRead(fn: string, model: Partial<CageModel> | undefined): void {
  if (typeof model !== 'object' || model === null || model.positions !== undefined) return;
  const text = 'model has no positions; await cageModel() of cagecast/gltf or cagecast/three';
  throw new CagecastError('badArgument', fn, text, { argument: 'model' });
}

/**
 * Makes a cage for a model: a hull around it, with holes over the parts that are not painted, unwrapped into few charts.
 *
 * Cost: some seconds.
 * @throws {CagecastError} `badModel` if no cage can be made for the model, with the reason; `badOption`, `badArgument`,
 * `outOfMemory`; `unsupported` if the worker or its WebAssembly cannot be loaded.
 *
 * @example
 * import { makeCage } from 'cagecast/cages';
 *
 * const cage = await makeCage({ positions, indices, groups, names: ['skin', 'eye_left', 'eye_right'] });
 * const result = transfer(cage, { positions, indices, groups });
 */
export async function makeCage(model: CageModel, options: MakeOptions & CageCallOptions = {}): Promise<Cage> {
  checkIsRead('makeCage', model);
  return call('makeCage', [model], options);
}

/**
 * Moves a template cage onto another model, so that one texture fits both. Its triangles and UVs stay. A hole for an eye
 * or a mouth is closed by further triangles where nothing is behind it: no opening, no other colour, no piece or morph target of its own.
 *
 * Cost: some seconds.
 * @param template   A cage, and landmarks of the model that it was made for.
 * @param landmarks  Of the model, by the names of the template's; they override those that are found. At most 300. Default: none.
 * @returns the cage, and which landmarks were used and which are missing.
 * @throws {CagecastError} `badModel`, `badTemplate` or `badLandmarks` if the model, the template or the landmarks cannot be used,
 * with the reason; else as `makeCage`.
 */
export async function fitCage(
  template: Template,
  model: CageModel,
  landmarks?: Landmarks,
  options: FitOptions & CageCallOptions = {},
): Promise<Fit> {
  checkIsRead('fitCage', model);
  return call('fitCage', [template, model, landmarks], options);
}

/**
 * Chooses the cage of a model that came alone. Fits the templates that it likely needs, one after another, until one is good; if none
 * is, makes a cage, too. The best verdict of `inspect` counts, then whether it is in doubt (nearly unfit, or with a hole over nothing), then
 * the order: models with the same template can wear the same paint.
 *
 * Cost: of one `fitCage`, if that is good; else also of `makeCage`. `inspect` runs in the worker of `cagecast/worker`.
 * @throws {CagecastError} as `makeCage`, if there is no cage at all.
 *
 * @example
 * import { chooseCage } from 'cagecast/cages';
 *
 * const { cage, template, verdict, tried } = await chooseCage(await cageModel(gltf));
 */
export async function chooseCage(model: CageModel, options: ChooseOptions & CageCallOptions = {}): Promise<Choice> {
  checkIsRead('chooseCage', model);
  const { worker, ...given } = options;
  const engine = {
    fitCage: (template: Template, of: CageModel, landmarks: Landmarks | undefined, one: FitOptions & CageCallOptions) =>
      fitCage(template, of, landmarks, { worker, ...one }),
    makeCage: (of: CageModel, one: MakeOptions & CageCallOptions) => makeCage(of, { worker, ...one }),
    inspect,
  };
  return choose(engine, model, given);
}

/**
 * Finds the landmarks of a head or a figure by names of parts, names of joints and shape.
 * @throws {CagecastError} as `makeCage`.
 */
export async function findLandmarks(model: CageModel, options: CageCallOptions = {}): Promise<FoundLandmarks> {
  checkIsRead('findLandmarks', model);
  return call('findLandmarks', [model], options);
}

/**
 * Moves, turns and scales a cage that is slightly off its model into place, and bends it where it is inside the model. A cage in
 * place stays as it is. Its landmarks and holes stay.
 * @param cage  With UVs.
 * @throws {CagecastError} as `fitCage`.
 */
export async function refineCage(
  cage: Mesh | Cage | Template,
  model: CageModel,
  options: RefineOptions & CageCallOptions = {},
): Promise<Cage> {
  checkIsRead('refineCage', model);
  return call('refineCage', [cage, model], options);
}

/**
 * Whether parts of these names are excluded if nothing is said of them: eyes, teeth, tongues, hair and glasses; of vehicles windows, wheels,
 * lights and the interior.
 * @param names  As those of a `Mesh`.
 * @throws {CagecastError} `badArgument`
 */
export function excludedByName(
  names: PartNames,
  options: Omit<CageCallOptions, 'onProgress'> = {},
): Promise<boolean[]> {
  return call('excludedByName', [names], options);
}

/**
 * Starts a worker and loads its WebAssembly before it is needed, or several. Not necessary: every call does it.
 * @param options  `module` is for calls without a worker, and the first one counts.
 * @throws {CagecastError} `badOption`; `unsupported` if a worker cannot start, or the WebAssembly.
 */
export async function init(options: CagesInitOptions = {}): Promise<void> {
  const names = faultOfNames('init', 'options', options, ['workers', 'worker', 'module']);
  const { module, worker = module === undefined ? usual() : false, ...workers } = options ?? {};
  const fault = names ?? faultOfWorker(worker);
  if (fault !== undefined) throw new CagecastError('badOption', 'init', fault);
  if (options.worker !== undefined || module !== undefined) told = worker;
  if (worker) await queue.init(workers);
  else await (await import('./sync.js')).init({ module });
}

/** Ends the workers and frees their memory. Pending calls reject with code `aborted`; the next call starts a new worker. */
export function terminate(): void {
  queue.terminate();
}
