import { faultOfNames } from '../api/option-names.js';
import { CagecastError, isRecord, show } from '../core/error.js';
import type { Reply, Request, Spawn, Thread } from './protocol.js';

/** Options of every call. */
export interface CallOptions {
  /** Cancels the call: its promise rejects with the signal's reason, and running work ends at once. */
  signal?: AbortSignal | undefined;
  /**
   * Transfers arrays to the worker instead of copying them: arguments, and fields of arguments, not what lies deeper. The caller's
   * arrays are empty afterwards, and so are all others that share a buffer with them.
   */
  move?: boolean | undefined;
}

/** Options of `init`. */
export interface WorkerOptions {
  /**
   * How many workers there are at most, 1 to 64, all of which are started now and stay; each has a memory of its own. Default: as it
   * was, at first the number that the entry names.
   */
  workers?: number | undefined;
}

const kMaxWorkers = 64;

/** How far a call is: a share 0..1 that never falls, and what it does. */
export type OnProgress = (share: number, stage: string) => void;

/** What is wrong with the options of a call, if anything is. */
export function faultOfCall({ signal, move, onProgress }: CallOptions & { onProgress?: unknown }): string | undefined {
  if (signal !== undefined && typeof signal?.addEventListener !== 'function')
    return `options.signal is ${show(signal)}, not an AbortSignal`;
  if (move !== undefined && typeof move !== 'boolean') return `options.move is ${show(move)}, not true or false`;
  if (onProgress !== undefined && typeof onProgress !== 'function')
    return `options.onProgress is ${show(onProgress)}, not a function`;
  return undefined;
}

interface Job {
  request: Request;
  move: boolean;
  /** Why it cannot be sent, if that is known. */
  failure: CagecastError | undefined;
  onProgress: OnProgress | undefined;
  signal: AbortSignal | undefined;
  resolve(result: unknown): void;
  reject(error: unknown): void;
}

/** A worker, once it is started, and what it is doing. */
interface Slot {
  thread?: Thread | undefined;
  job?: Job | undefined;
}

/**
 * Calls that share workers. The first call starts one; each takes the first that is idle, starts another up to the limit, or waits.
 * They are begun in order. One worker stays when it is idle, or as many as `init` was told.
 */
export class WorkerQueue {
  readonly #spawn: Spawn;
  #mostWorkers: number;
  /** How many workers stay when they are idle. */
  #kept = 1;
  #lastId = 0;
  #slots: Slot[] = [];
  readonly #waiting: Job[] = [];

  constructor(spawn: Spawn, mostWorkers = 1) {
    this.#spawn = spawn;
    this.#mostWorkers = mostWorkers;
  }

  /** Starts a worker, or as many as there shall be. */
  async init(options: WorkerOptions = {}): Promise<void> {
    const fault = faultOfNames('init', 'options', options, ['workers']);
    if (fault !== undefined) throw new CagecastError('badOption', 'init', fault);
    const { workers } = options;
    if (workers !== undefined) {
      if (!Number.isInteger(workers) || workers < 1 || workers > kMaxWorkers)
        throw new CagecastError('badOption', 'init', `options.workers is ${show(workers)}, not 1 to ${kMaxWorkers}`);
      this.#mostWorkers = this.#kept = workers;
    }
    await Promise.all(Array.from({ length: workers ?? 1 }, () => this.call('init', [], {})));
  }

  /** Calls a function with the options of a call among its own. @param args  Its other arguments. */
  withOptions<T>(fn: string, args: unknown[], options: CallOptions & { onProgress?: OnProgress | undefined }) {
    if (!isRecord(options)) return this.call<T>(fn, [...args, options], {});
    const { signal, move, onProgress, ...rest } = options;
    const fault = faultOfCall(options);
    if (fault !== undefined) return Promise.reject<T>(new CagecastError('badOption', fn, fault));
    return this.call<T>(fn, [...args, rest], { signal, move, onProgress });
  }

  call<T>(
    fn: string,
    args: unknown[],
    { signal, move = false, onProgress }: CallOptions & { onProgress?: OnProgress | undefined },
  ): Promise<T> {
    return new Promise<T>((resolve, reject) => {
      if (signal?.aborted) return reject(signal.reason);
      let failure: CagecastError | undefined;
      try {
        if (!move) args = args.map(withOwnBuffers);
      } catch (cause) {
        failure = unsendable(fn, cause);
      }
      if (!failure && (this.#waiting.length > 0 || !this.#hasRoom)) {
        // It waits; what is sent later is what the arguments are now.
        try {
          args = structuredClone(args, { transfer: move ? buffersOf(args) : [] });
          move = true;
        } catch (cause) {
          failure = unsendable(fn, cause);
        }
      }
      this.#waiting.push({
        request: { id: ++this.#lastId, fn, args },
        move,
        failure,
        onProgress,
        signal,
        resolve: (result) => resolve(result as T),
        reject,
      });
      signal?.addEventListener('abort', this.#onAbort);
      this.#next();
    });
  }

  /** Ends the workers and frees their memory. Pending calls reject with code `aborted`; the next call starts a new worker. */
  terminate(): void {
    const jobs = this.#jobs;
    for (const slot of this.#slots) stop(slot);
    this.#waiting.length = 0;
    for (const job of jobs) job.reject(new CagecastError('aborted', job.request.fn, 'the worker was terminated'));
  }

  /** All jobs, those that are running first. */
  get #jobs(): Job[] {
    return [...this.#slots.flatMap(({ job }) => job ?? []), ...this.#waiting];
  }

  /** Whether a worker is idle or may be started. */
  get #hasRoom(): boolean {
    return this.#slots.length < this.#mostWorkers || this.#slots.some(({ job }) => !job);
  }

  /** Hands jobs that wait to workers, as long as there is room. */
  #next(): void {
    while (this.#waiting.length > 0 && this.#hasRoom) {
      const job = this.#waiting.shift()!;
      let slot = this.#slots.find(({ job, thread }) => !job && thread) ?? this.#slots.find((one) => !one.job);
      if (!slot) this.#slots.push((slot = {}));
      const error = this.#send(slot, job);
      if (error) job.reject(error);
    }
    const idle = this.#slots.filter(({ job }) => !job);
    for (const slot of idle.filter(({ thread }) => thread).slice(this.#kept)) stop(slot);
    for (const { thread } of idle) thread?.setBusy(false);
    this.#slots = this.#slots.filter(({ job, thread }) => job || thread);
  }

  /** Hands a job to a worker. @returns why that cannot be, if so. */
  #send(slot: Slot, job: Job): CagecastError | undefined {
    const { request, move, failure } = job;
    if (failure) return failure;
    try {
      slot.thread ??= this.#start(slot);
    } catch (cause) {
      const reason = `this host cannot start the worker (${String(cause)})`;
      return new CagecastError('unsupported', request.fn, reason, { cause });
    }
    try {
      slot.thread.setBusy(true);
      slot.thread.post(request, move ? buffersOf(request.args) : []);
      slot.job = job;
      return undefined;
    } catch (cause) {
      return unsendable(request.fn, cause);
    }
  }

  /** The only listener of a signal, however many calls have it. */
  readonly #onAbort = (): void => {
    for (const job of this.#jobs) if (job.signal?.aborted) this.#abort(job, job.signal.reason);
  };

  #start(slot: Slot): Thread {
    const thread = this.#spawn(
      (reply) => this.#onReply(slot, reply),
      (message) => {
        if (slot.thread !== thread) return; // It was ended, and another one works now.
        const { job } = slot;
        stop(slot);
        job?.reject(new CagecastError('unsupported', job.request.fn, `the worker failed (${message})`));
        this.#next();
      },
    );
    return thread;
  }

  #onReply(slot: Slot, reply: Reply): void {
    const { job } = slot;
    if (job?.request.id !== reply.id) return;
    if ('progress' in reply) {
      this.#tell(job, reply.progress);
      return;
    }
    slot.job = undefined;
    if ('error' in reply) job.reject(new CagecastError(...reply.error));
    else job.resolve(reply.result);
    this.#next();
  }

  /** Tells a caller how far its call is. What the caller's function throws ends the call. */
  #tell(job: Job, progress: [share: number, stage: string]): void {
    try {
      job.onProgress?.(...progress);
    } catch (error) {
      this.#abort(job, error);
    }
  }

  /** Ends a call that is still waiting or running. */
  #abort(job: Job, reason: unknown): void {
    const slot = this.#slots.find((one) => one.job === job);
    const place = this.#waiting.indexOf(job);
    if (place >= 0) this.#waiting.splice(place, 1);
    else if (!slot) return;
    job.reject(reason);
    if (!slot) return;
    // A call into WebAssembly cannot be interrupted, but its worker can be ended.
    stop(slot);
    // One signal may cancel those that wait as well, one after the other.
    queueMicrotask(() => this.#next());
  }
}

/** Ends a worker, whatever it does. */
function stop(slot: Slot): void {
  slot.thread?.terminate();
  slot.thread = slot.job = undefined;
}

/** The error for an argument that cannot be sent, such as a function or an array that was transferred before. */
const unsendable = (fn: string, cause: unknown): CagecastError =>
  new CagecastError('badArgument', fn, `the arguments cannot be sent to the worker (${String(cause)})`, { cause });

/** Copies arrays that use a part of their buffer only: to send such an array would send the whole buffer. */
function withOwnBuffers(value: unknown): unknown {
  if (ArrayBuffer.isView(value)) return isPart(value) ? ownArray(value) : value;
  if (typeof value !== 'object' || value === null || Object.getPrototypeOf(value) !== Object.prototype) return value;
  return Object.fromEntries(Object.entries(value).map(([name, field]) => [name, withOwnBuffers(field)]));
}

const isPart = (array: ArrayBufferView): array is ArrayBufferView<ArrayBuffer> =>
  array.buffer instanceof ArrayBuffer && array.buffer.byteLength > 0 && array.byteLength < array.buffer.byteLength;

function ownArray(array: ArrayBufferView<ArrayBuffer>): ArrayBufferView {
  const { buffer, byteOffset, byteLength } = array;
  const bytes = buffer.slice(byteOffset, byteOffset + byteLength);
  // Its real type: its constructor may be one of a library.
  const kind = Reflect.get(Object.getPrototypeOf(Uint8Array.prototype), Symbol.toStringTag, array) ?? 'DataView';
  return new globalThis[kind as 'Float32Array'](bytes);
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
