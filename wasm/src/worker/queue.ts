import { isRecord, show } from '../core/error.js';
import { CagecastError } from '../index.js';
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

/** How far a call is: a share 0..1 that never falls, and what it does. */
export type OnProgress = (share: number, stage: string) => void;

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

/** Calls that share one worker, which starts with the first call and carries them out in order. */
export class WorkerQueue {
  readonly #spawn: Spawn;
  #thread: Thread | undefined;
  #lastId = 0;
  /** The first job is running. */
  readonly #jobs: Job[] = [];

  constructor(spawn: Spawn) {
    this.#spawn = spawn;
  }

  /** Calls a function with the options of a call among its own. @param args  Its other arguments. */
  withOptions<T>(fn: string, args: unknown[], options: CallOptions & { onProgress?: OnProgress | undefined }) {
    if (!isRecord(options)) return this.call<T>(fn, [...args, options], {});
    const { signal, move, onProgress, ...rest } = options;
    const wrong = (text: string) => Promise.reject<T>(new CagecastError('badOption', fn, `options.${text}`));
    if (signal !== undefined && typeof signal?.addEventListener !== 'function')
      return wrong(`signal is ${show(signal)}, not an AbortSignal`);
    if (move !== undefined && typeof move !== 'boolean') return wrong(`move is ${show(move)}, not true or false`);
    if (onProgress !== undefined && typeof onProgress !== 'function')
      return wrong(`onProgress is ${show(onProgress)}, not a function`);
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
      if (!failure && this.#jobs.length > 0) {
        // It waits; what is sent later is what the arguments are now.
        try {
          args = structuredClone(args, { transfer: move ? buffersOf(args) : [] });
          move = true;
        } catch (cause) {
          failure = unsendable(fn, cause);
        }
      }
      this.#jobs.push({
        request: { id: ++this.#lastId, fn, args },
        move,
        failure,
        onProgress,
        signal,
        resolve: (result) => resolve(result as T),
        reject,
      });
      signal?.addEventListener('abort', this.#onAbort);
      if (this.#jobs.length === 1) this.#next();
    });
  }

  /** Ends the worker and frees its memory. Pending calls reject with code `aborted`; the next call starts a new worker. */
  terminate(): void {
    this.#stop();
    for (const job of this.#jobs.splice(0))
      job.reject(new CagecastError('aborted', job.request.fn, 'the worker was terminated'));
  }

  /** Hands the first job that can be sent to the worker. */
  #next(): void {
    for (let job = this.#jobs[0]; job; job = this.#jobs[0]) {
      const error = this.#send(job);
      if (!error) return;
      this.#jobs.shift();
      job.reject(error);
    }
    this.#thread?.setBusy(false);
  }

  /** Hands a job to the worker. @returns why that cannot be, if so. */
  #send({ request, move, failure }: Job): CagecastError | undefined {
    if (failure) return failure;
    try {
      this.#thread ??= this.#start();
    } catch (cause) {
      const reason = `this host cannot start the worker (${String(cause)})`;
      return new CagecastError('unsupported', request.fn, reason, { cause });
    }
    try {
      this.#thread.setBusy(true);
      this.#thread.post(request, move ? buffersOf(request.args) : []);
      return undefined;
    } catch (cause) {
      return unsendable(request.fn, cause);
    }
  }

  /** The only listener of a signal, however many calls have it. */
  readonly #onAbort = (): void => {
    for (const job of [...this.#jobs]) if (job.signal?.aborted) this.#abort(job, job.signal.reason);
  };

  #start(): Thread {
    const thread = this.#spawn(
      (reply) => this.#onReply(reply),
      (message) => {
        if (this.#thread !== thread) return; // It was ended, and another one works now.
        this.#stop();
        const job = this.#jobs[0];
        if (job) this.#finish(job, new CagecastError('unsupported', job.request.fn, `the worker failed (${message})`));
      },
    );
    return thread;
  }

  #onReply(reply: Reply): void {
    const job = this.#jobs[0];
    if (job?.request.id !== reply.id) return;
    if ('progress' in reply) this.#tell(job, reply.progress);
    else if ('error' in reply) this.#finish(job, new CagecastError(...reply.error));
    else this.#finish(job, undefined, reply.result);
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
    const place = this.#jobs.indexOf(job);
    if (place < 0) return;
    this.#jobs.splice(place, 1);
    job.reject(reason);
    if (place > 0) return;
    // A call into WebAssembly cannot be interrupted, but its worker can be ended.
    this.#stop();
    // One signal may cancel those that wait as well, one after the other.
    queueMicrotask(() => {
      if (!this.#thread) this.#next();
    });
  }

  #finish(job: Job, error: CagecastError | undefined, result?: unknown): void {
    this.#jobs.shift();
    if (error) job.reject(error);
    else job.resolve(result);
    this.#next();
  }

  #stop(): void {
    this.#thread?.terminate();
    this.#thread = undefined;
  }
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
