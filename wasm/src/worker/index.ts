/**
 * The functions of `cagecast`, off the main thread: the same names and arguments, with promises.
 *
 * All calls share one worker, which starts with the first call and runs them in order.
 * @module cagecast/worker
 */
import { spawn } from '#spawn';
import { show } from '../api/error.js';
import {
  CagecastError,
  type Classification,
  type ClassifyOptions,
  type CutTarget,
  type Mesh,
  type Preset,
  type PresetOptions,
  type Projection,
  type ProjectOptions,
  type SplitVertices,
  type TransferOptions,
  type TransferResult,
} from '../index.js';
import type { Reply, Request, Thread } from './protocol.js';

export * from '../index.js';

/** Options of every call. */
export interface CallOptions {
  /** Cancels the call: its promise rejects with the signal's reason, and running work ends at once. */
  signal?: AbortSignal | undefined;
  /** Transfers the arrays of the arguments to the worker instead of copying them; the caller's arrays are empty afterwards. */
  move?: boolean | undefined;
}

interface Job {
  request: Request;
  move: boolean;
  settle(): void;
  resolve(result: unknown): void;
  reject(error: unknown): void;
}

let thread: Thread | undefined;
let lastId = 0;
/** The first job is running. */
const jobs: Job[] = [];

/** Starts the worker before it is needed. Not necessary: every call does it. @throws {CagecastError} `unsupported` */
export function init(): Promise<void> {
  return call('init', [], {});
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

/** As `classify` of `cagecast`, off the main thread. On the main thread it takes microseconds, less than the messages do. */
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

/** As `presetOptions` of `cagecast`, off the main thread. */
export function presetOptions(preset?: Preset, options: CallOptions = {}): Promise<PresetOptions> {
  return withOptions('presetOptions', [preset], options);
}

/** Ends the worker and frees its memory. Pending calls reject with code `aborted`; the next call starts a new worker. */
export function terminate(): void {
  stop();
  for (const job of jobs.splice(0)) {
    job.settle();
    job.reject(new CagecastError('aborted', `${job.request.fn}: the worker was terminated`));
  }
}

function withOptions<T>(fn: Request['fn'], args: unknown[], options: CallOptions): Promise<T> {
  if (typeof options !== 'object' || options === null) return call(fn, [...args, options], {});
  const { signal, move, ...rest } = options;
  const wrong = (text: string) => Promise.reject(new CagecastError('badOption', `${fn}: options.${text}`));
  if (signal !== undefined && typeof signal?.addEventListener !== 'function')
    return wrong(`signal is ${show(signal)}, not an AbortSignal`);
  if (move !== undefined && typeof move !== 'boolean') return wrong(`move is ${show(move)}, not true or false`);
  // The worker would overwrite its own copy of it.
  if ('reuse' in rest && rest.reuse !== undefined)
    return Promise.reject(
      new CagecastError('badOption', `${fn}: options.reuse is not for the worker, whose results are always new arrays`),
    );
  return call(fn, [...args, rest], { signal, move });
}

function call<T>(fn: Request['fn'], args: unknown[], { signal, move = false }: CallOptions): Promise<T> {
  return new Promise<T>((resolve, reject) => {
    if (signal?.aborted) return reject(signal.reason);
    const giveUp = () => {
      const place = jobs.indexOf(job);
      if (place < 0) return;
      jobs.splice(place, 1);
      job.settle();
      reject(signal?.reason);
      if (place > 0) return;
      // A call into WebAssembly cannot be interrupted, but its worker can be ended.
      stop();
      next();
    };
    const job: Job = {
      request: { id: ++lastId, fn, args },
      move,
      settle: () => signal?.removeEventListener('abort', giveUp),
      resolve: (result) => resolve(result as T),
      reject,
    };
    signal?.addEventListener('abort', giveUp, { once: true });
    jobs.push(job);
    if (jobs.length === 1) next();
  });
}

/** Hands the first job to the worker. */
function next(): void {
  const job = jobs[0];
  if (job === undefined) {
    thread?.setBusy(false);
    return;
  }
  try {
    thread ??= spawn(onReply, onFailure);
  } catch (cause) {
    const message = `${job.request.fn}: this host cannot start the worker (${String(cause)})`;
    finish(job, new CagecastError('unsupported', message, 0, { cause }));
    return;
  }
  try {
    thread.setBusy(true);
    thread.post(job.request, job.move ? buffersOf(job.request.args) : []);
  } catch (cause) {
    // An argument cannot be sent, such as a function or an array that was transferred before.
    finish(
      job,
      new CagecastError(
        'badArgument',
        `${job.request.fn}: the arguments cannot be sent to the worker (${String(cause)})`,
        0,
        { cause },
      ),
    );
  }
}

function onReply(reply: Reply): void {
  const job = jobs[0];
  if (job?.request.id !== reply.id) return;
  if ('error' in reply) finish(job, new CagecastError(reply.error.code, reply.error.message, reply.error.at));
  else finish(job, undefined, reply.result);
}

function onFailure(message: string): void {
  stop();
  const job = jobs[0];
  if (job) finish(job, new CagecastError('unsupported', `${job.request.fn}: the worker failed (${message})`));
}

function finish(job: Job, error: CagecastError | undefined, result?: unknown): void {
  jobs.shift();
  job.settle();
  if (error) job.reject(error);
  else job.resolve(result);
  next();
}

function stop(): void {
  thread?.terminate();
  thread = undefined;
}

function buffersOf(args: unknown[]): ArrayBuffer[] {
  const values = args.flatMap((arg) =>
    ArrayBuffer.isView(arg) ? [arg] : typeof arg === 'object' && arg !== null ? Object.values(arg) : [],
  );
  const buffers = values.filter((value) => ArrayBuffer.isView(value)).map((view) => view.buffer);
  // An empty buffer may have been transferred before. If it is listed, it arrives empty; if it is copied, the call throws.
  return [...new Set(buffers)].filter(
    (buffer): buffer is ArrayBuffer => buffer instanceof ArrayBuffer && buffer.byteLength > 0,
  );
}
