/**
 * The functions of `cagecast`, off the main thread: the same names and arguments, with promises.
 *
 * All calls share one worker, which starts with the first call and runs them in order; a service with more cores calls
 * `init({ workers })`, after which each call takes the first worker that is idle, or waits for one.
 * @module cagecast/worker
 */
import type {
  Classification,
  ClassifyOptions,
  CutTarget,
  Mesh,
  Projection,
  ProjectOptions,
  SplitVertices,
  TransferOptions,
  TransferResult,
} from '../api/index.js';
import { CagecastError } from '../core/error.js';
import type { Inspection, InspectOptions } from '../inspect/index.js';
import type { Prepared, PrepareOptions } from '../parts/prepare.js';
import { type CallOptions, type WorkerOptions, WorkerQueue } from './queue.js';
import { spawn } from './spawn.js';

export { Visibility, Zone } from '../generated/enums.js';
export type * from '../index.js';
export type { CallOptions, WorkerOptions };
export { CagecastError };

const queue = new WorkerQueue(spawn);

/**
 * Starts the worker before it is needed, or several. Not necessary: every call starts one.
 * @throws {CagecastError} `badOption`; `unsupported` if a worker cannot start.
 */
export function init(options: WorkerOptions = {}): Promise<void> {
  return queue.init(options);
}

/** As `transfer` of `cagecast`, off the main thread. There is no `reuse`: all arrays are new. */
export function transfer(
  cage: Mesh,
  target: Mesh,
  options: TransferOptions & CallOptions = {},
): Promise<TransferResult> {
  return withOptions('transfer', [cage, target], options);
}

/** As `project` of `cagecast`, off the main thread. */
export function project(cage: Mesh, target: Mesh, options: ProjectOptions & CallOptions = {}): Promise<Projection> {
  return withOptions('project', [cage, target], options);
}

/** As `classify` of `cagecast`, off the main thread. On the main thread it takes less time than the messages do. */
export function classify(projection: Projection, options: ClassifyOptions & CallOptions = {}): Promise<Classification> {
  return withOptions('classify', [projection], options);
}

/** As `splitVertices` of `cagecast`, off the main thread. */
export function splitVertices(
  target: Mesh,
  cornerUvs: Float32Array,
  options: CallOptions = {},
): Promise<SplitVertices> {
  return withOptions('splitVertices', [target, cornerUvs], options);
}

/** As `cutBorders` of `cagecast`, off the main thread. Only the required fields of `result` are copied. */
export function cutBorders(
  cage: Mesh,
  target: Mesh,
  result: Pick<TransferResult, 'zones' | 'segments' | 'segmentStats'>,
  options: TransferOptions & CallOptions = {},
): Promise<CutTarget> {
  const { zones, segments, segmentStats } = result ?? {};
  return withOptions('cutBorders', [cage, target, result && { zones, segments, segmentStats }], options);
}

/** As `inspect` of `cagecast`, off the main thread. */
export function inspect(cage: Mesh, target: Mesh, options: InspectOptions & CallOptions = {}): Promise<Inspection> {
  return withOptions('inspect', [cage, target], options);
}

/** As `prepareParts` of `cagecast/engines`, off the main thread. */
export function prepareParts(
  cage: Mesh | undefined,
  target: Mesh,
  options: PrepareOptions & CallOptions = {},
): Promise<Prepared> {
  return withOptions('prepareParts', [cage, target], options);
}

/** Ends the worker and frees its memory. Pending calls reject with code `aborted`; the next call starts a new worker. */
export function terminate(): void {
  queue.terminate();
}

function withOptions<T>(fn: string, args: unknown[], options: CallOptions & { reuse?: unknown }): Promise<T> {
  // The worker would overwrite its own copy of it.
  if (options?.reuse !== undefined)
    return Promise.reject(
      new CagecastError('badOption', fn, 'options.reuse is not for the worker, whose results are always new arrays'),
    );
  return queue.withOptions(fn, args, options);
}
