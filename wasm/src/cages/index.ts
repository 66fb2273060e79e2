/**
 * Cages for models that have none: made afresh for one model, fitted from a template, or moved into place.
 *
 * Each call takes seconds and runs in a worker. The first call starts one, others at the same time start more, up to the number of
 * cores, at least two and at most four, or what `init({ workers })` says; further calls wait. One worker, or as many as `init` was told,
 * stay when nothing is left to do. A worker loads its
 * WebAssembly, `cagecast-cages.wasm`, when it starts: until a function is called, nothing of it is loaded.
 * @module cagecast/cages
 */

import type { Mesh } from '../api/mesh.js';
import type { PartNames } from '../api/parts.js';
import { CagecastError } from '../index.js';
import { type CallOptions, type OnProgress, type WorkerOptions, WorkerQueue } from '../worker/queue.js';
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
export { objTemplate } from './obj-template.js';
export { type TemplateName, templateNames } from './template-names.js';
export { loadTemplate } from './templates.js';
export type * from './types.js';
export type { WorkerOptions };
export { CagecastError };

/** Options of every call. */
export interface CageCallOptions extends CallOptions {
  /**
   * Told several times a second how far the call is: a share 0..1 that never falls, and what it does (`hull`, `unwrap`, …). If it
   * throws, the call is cancelled, and its promise rejects with what was thrown.
   */
  onProgress?: OnProgress | undefined;
}

/** Workers at most: each has a memory of its own, and more of them than cores gain nothing. */
const kMaxWorkers = 4;
const cores = globalThis.navigator?.hardwareConcurrency ?? kMaxWorkers;

const queue = new WorkerQueue(spawn, Math.max(2, Math.min(kMaxWorkers, cores)));

/** A rejection if a document or a scene is given instead of a model: it cannot be sent to the worker. */
function unreadOf(fn: string, model: Partial<CageModel> | undefined): Promise<never> | undefined {
  if (typeof model !== 'object' || model === null || model.positions !== undefined) return undefined;
  const text = 'model has no positions; see cageModel of cagecast/gltf and cagecast/three';
  return Promise.reject(new CagecastError('badArgument', fn, text, { argument: 'model' }));
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
 * const cage = await makeCage({ positions, indices, groups, parts: ['skin', 'eye_left', 'eye_right'] });
 * const result = transfer(cage, { positions, indices, groups });
 */
export function makeCage(model: CageModel, options: MakeOptions & CageCallOptions = {}): Promise<Cage> {
  return unreadOf('makeCage', model) ?? queue.withOptions('makeCage', [model], options);
}

/**
 * Moves a template cage onto another model, so that one texture fits both. Its triangles, UVs and holes stay.
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
  return unreadOf('fitCage', model) ?? queue.withOptions('fitCage', [template, model, landmarks], options);
}

/**
 * Finds the landmarks of a head or a figure by names of parts, names of joints and shape.
 * @throws {CagecastError} as `makeCage`.
 */
export function findLandmarks(model: CageModel, options: CageCallOptions = {}): Promise<FoundLandmarks> {
  return unreadOf('findLandmarks', model) ?? queue.withOptions('findLandmarks', [model], options);
}

/**
 * Moves, turns and scales a cage that is slightly off its model into place, and bends it where it is inside the model. A cage in
 * place stays as it is. Its landmarks and holes stay.
 * @param cage  With UVs.
 * @throws {CagecastError} as `fitCage`.
 */
export function refineCage(
  cage: Mesh | Cage | Template,
  model: CageModel,
  options: RefineOptions & CageCallOptions = {},
): Promise<Cage> {
  return unreadOf('refineCage', model) ?? queue.withOptions('refineCage', [cage, model], options);
}

/**
 * Whether parts of these names are excluded if nothing is said of them: eyes, teeth, tongues, hair and glasses; of vehicles windows, wheels,
 * lights and the interior.
 * @param names  As those of a `Mesh`.
 * @throws {CagecastError} `badArgument`
 */
export function excludedByName(names: PartNames, options: CallOptions = {}): Promise<boolean[]> {
  return queue.withOptions('excludedByName', [names], options);
}

/**
 * Starts a worker and loads its WebAssembly before it is needed, or several. Not necessary: every call does it.
 * @throws {CagecastError} `badOption`; `unsupported` if a worker cannot start.
 */
export function init(options: WorkerOptions = {}): Promise<void> {
  return queue.init(options);
}

/** Ends the workers and frees their memory. Pending calls reject with code `aborted`; the next call starts a new worker. */
export function terminate(): void {
  queue.terminate();
}
