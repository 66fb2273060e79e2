import { CagecastError, isRecord, show } from '../../core/error.js';
import { nodeModule } from '../../core/node.js';
import { plainArray } from '../../core/typed-arrays.js';
import { firstLine, InputError } from '../../scene/input-error.js';
import { exceeds } from '../checks/read-limits.js';
import { type Format, fileKind } from '../kinds.js';
import { checks } from './checks/index.js';
import { type FormatLimits, limitsOf } from './limits.js';
import type { Answer } from './protocol.js';
import { spawn } from './spawn-formats.js';

/** Reads a file beside a model. */
export interface Companions {
  /**
   * The bytes of a file that the model names: the materials of an OBJ (MTL), images. Undefined if it is not there: then its
   * material has no image. Called once for each. Default: there are none.
   * @param name  As it stands in the model, with slashes.
   */
  read?: ((name: string) => Promise<Uint8Array | undefined>) | undefined;
  /**
   * Called for each file that the model names and the GLB goes without: it was not found, or glTF does not have such images.
   * Default: nothing is said.
   * @param reason  For people: "it was not found".
   */
  onMissing?: ((name: string, reason: string) => void) | undefined;
  /** Limits other than the default ones. */
  limits?: Partial<FormatLimits> | undefined;
  /** Cancels the call: its promise rejects with the signal's reason, and its thread ends at once. */
  signal?: AbortSignal | undefined;
}

/**
 * Makes a GLB of a model in another format: FBX 7 or newer, OBJ with its MTL, PLY, STL, USDZ or USD, as three.js reads it.
 *
 * Kept: triangles, normals, UVs, vertex colours, skins, morph targets, names, the places of nodes, colours and images of materials, whose
 * PNG, JPEG and WebP bytes stay as they are. Lost: animations, cameras, lights, lines and points, images of other types, and what glTF's own
 * materials do not have. What an FBX or USD says of its units becomes metres; other units stay, and y is up. Vertices that are alike become
 * one.
 *
 * The GLB is valid: triangles with corners that are not there, or not at finite places, are left out; what else is not a finite number
 * gets its default, and factors are brought within 0 … 1.
 *
 * The file is read in a worker of its own, which ends afterwards, within limits of time and memory, after a look at what it says of
 * itself. three.js is in the worker's script. Cost: that of the loader, linear in the vertices, and a tenth of a second for the worker.
 * @param bytes  The whole file. Its content says which format it is.
 * @throws {CagecastError} `badArgument`: the file is of another kind, or cannot be read, with the reason, such as a limit;
 * `badOption`; `unsupported` if this host cannot start a worker.
 *
 * @example
 * import { toGlb } from 'cagecast/gltf';
 *
 * const glb = await toGlb(await readFile('head.obj'), { read: (name) => readFile(`models/${name}`).catch(() => undefined) });
 */
export async function toGlb(bytes: Uint8Array, companions: Companions = {}): Promise<Uint8Array> {
  const wrong = (text: string, cause?: unknown) =>
    new CagecastError('badArgument', 'toGlb', text, { argument: 'bytes', cause });
  const own = plainArray(bytes, 'Uint8Array');
  if (!own) throw wrong(`bytes is ${show(bytes)}, not a Uint8Array`);
  const limits = checkedLimits(own.length, companions.limits);
  companions.signal?.throwIfAborted();
  const kind = fileKind(own);
  if (kind?.format === undefined)
    throw wrong(kind ? `is ${kind.name}; ${kind.advice}` : 'is neither FBX, OBJ, PLY, STL nor USDZ');
  let glb: Uint8Array | undefined;
  try {
    if (own.length > limits.bytes) throw exceeds(`it has ${own.length} bytes`, 'bytes', limits);
    await checks[kind.format](own, limits);
    glb = await readInWorker(own, kind.format, limits, companions);
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    throw wrong(`is ${kind.name}, but cannot be read (${error.message})`, error);
  }
  if (!glb) throw wrong(`is ${kind.name} without any triangle`);
  return glb;
}

function checkedLimits(bytes: number, given: Partial<FormatLimits> = {}): FormatLimits {
  const bad = (text: string) => new CagecastError('badOption', 'toGlb', text, { argument: 'limits' });
  if (!isRecord(given)) throw bad(`limits is ${show(given)}, not an object`);
  const limits = limitsOf(bytes, given);
  for (const [name, value] of Object.entries(limits))
    if (typeof value !== 'number' || !(value >= 0)) throw bad(`limits.${name} is ${show(value)}, not a number ≥ 0`);
  return limits;
}

/** Megabytes that the heap of a thread in Node may have beside what `memory` says, and at most. */
const [kSpareHeap, kMaxHeap] = [256, 4096];

/**
 * Has a worker read a file, whatever its loader does with it, and ends it.
 * @throws {InputError} that says what is wrong with the file; {CagecastError} if there can be no worker.
 */
function readInWorker(
  bytes: Uint8Array,
  format: Format,
  limits: FormatLimits,
  { read = async () => undefined, onMissing = () => {}, signal }: Companions,
): Promise<Uint8Array | undefined> {
  return new Promise((resolve, reject) => {
    let end = () => {};
    const settle = (finish: () => void) => {
      end();
      end = () => {};
      finish();
    };
    const fail = (error: unknown) => settle(() => reject(error));
    const clock = new Clock(limits.seconds, () =>
      fail(exceeds(`its loader takes more than ${limits.seconds.toLocaleString('en')} seconds`, 'seconds', limits)),
    );
    const files = new FilesBeside(read, limits);
    const told = new Set<string>();
    const onAnswer = async (answer: Answer) => {
      if ('begun' in answer) clock.run(answer.times);
      else if ('missing' in answer) {
        const [name, reason] = answer.missing;
        if (told.has(name)) return;
        told.add(name);
        onMissing(name, reason);
      } else if ('ask' in answer) {
        clock.stop();
        const found = await files.find(answer.name);
        clock.run();
        thread.post({ ask: answer.ask, found }, []);
      } else if ('wrong' in answer) fail(new InputError(answer.wrong));
      else settle(() => resolve(answer.glb));
    };
    const onFailure = (message: string) => {
      // What the heap of a thread in Node ends with.
      if (/memory limit/.test(message)) fail(exceeds('its loader takes all memory that it may have', 'memory', limits));
      else fail(unsupported(`the worker failed (${message})`));
    };
    const heap = Math.min(kMaxHeap, kSpareHeap + Math.ceil((2 * limits.memory) / 2 ** 20));
    let thread: ReturnType<typeof spawn>;
    try {
      thread = spawn((answer) => void onAnswer(answer).catch(fail), onFailure, heap);
    } catch (cause) {
      reject(unsupported(`this host cannot start the worker (${firstLine(cause)})`, cause));
      return;
    }
    const onAbort = () => fail(signal!.reason);
    end = () => {
      clock.end();
      signal?.removeEventListener('abort', onAbort);
      thread.terminate();
    };
    signal?.addEventListener('abort', onAbort);
    if (signal?.aborted) return onAbort();
    thread.setBusy(true);
    const own = Uint8Array.from(bytes);
    thread.post({ bytes: own, format, limits }, [own.buffer]);
  });
}

const unsupported = (reason: string, cause?: unknown): CagecastError =>
  new CagecastError('unsupported', 'toGlb', `${reason}; other formats are only read in one`, { cause });

/** Milliseconds between two looks at the clock. */
const kTick = 50;

/**
 * Tells when a thread has run for some seconds, breaks not counted: of its CPU on Linux, else of that of all threads in Node. So
 * other programs do not count.
 */
class Clock {
  readonly #onEnd: () => void;
  #left: number;
  #last = { time: 0, cpu: 0 };
  #timer: ReturnType<typeof setInterval> | undefined;
  #breaks = 0;
  #times: string | undefined;

  constructor(seconds: number, onEnd: () => void) {
    this.#left = 1000 * seconds;
    this.#onEnd = onEnd;
  }

  /**
   * Begins, or goes on once each break has ended.
   * @param times Linux's file of the thread's times.
   */
  run(times = this.#times): void {
    this.#times = times;
    if (this.#breaks > 0) --this.#breaks;
    if (this.#breaks > 0) return;
    this.#last = this.#now;
    this.#timer = setInterval(() => this.#look(), kTick);
  }

  stop(): void {
    if (this.#breaks++ > 0) return;
    clearInterval(this.#timer);
    this.#look();
  }

  /** Stops for good. */
  end(): void {
    this.#breaks = Infinity;
    clearInterval(this.#timer);
  }

  get #now(): { time: number; cpu: number } {
    const time = performance.now();
    try {
      // Its first number is in nanoseconds; 0 where Linux does not count.
      const text = this.#times && nodeModule('node:fs')!.readFileSync(this.#times, 'utf8');
      const cpu = Number.parseInt(text ?? '', 10) / 1e6;
      if (cpu > 0) return { time, cpu };
    } catch {
      // The thread has ended.
    }
    this.#times = undefined;
    const used = globalThis.process?.cpuUsage?.();
    return { time, cpu: used ? (used.user + used.system) / 1000 : time };
  }

  #look(): void {
    const { time, cpu } = this.#now;
    this.#left -= Math.min(time - this.#last.time, cpu - this.#last.cpu);
    this.#last = { time, cpu };
    if (this.#left < 0) this.#onEnd();
  }
}

/** The files beside a model, counted. */
class FilesBeside {
  readonly #read: NonNullable<Companions['read']>;
  readonly #limits: FormatLimits;
  readonly #found = new Map<string, Promise<Uint8Array | undefined>>();
  #bytes = 0;

  constructor(read: NonNullable<Companions['read']>, limits: FormatLimits) {
    this.#read = read;
    this.#limits = limits;
  }

  /** Reads each once. @throws {InputError} if there are too many, or too large ones. */
  find(name: string): Promise<Uint8Array | undefined> {
    const known = this.#found.get(name);
    if (known) return known;
    const { files, bytes } = this.#limits;
    if (this.#found.size >= files)
      throw exceeds(`it names more than ${files.toLocaleString('en')} files beside it`, 'files', this.#limits);
    const found = this.#content(name).then((content) => {
      this.#bytes += content?.length ?? 0;
      if (this.#bytes > bytes)
        throw exceeds(`the files beside it have more than ${bytes.toLocaleString('en')} bytes`, 'bytes', this.#limits);
      return content;
    });
    this.#found.set(name, found);
    return found;
  }

  async #content(name: string): Promise<Uint8Array | undefined> {
    try {
      return await this.#read(name);
    } catch {
      return undefined; // as one that is not there
    }
  }
}
