import createModule from '#glue';
import { compile } from '#wasm';
import { CagecastError, type Code } from './error.js';
import { failureOf, givenModule, type InitOptions, instantiate, notInitialised, unsupported } from './instantiate.js';
import { type Answer, type CoreModule, type CoreSegment, nameOf, type Workspace } from './module.js';
import type { SegmentStats } from './records.js';
import { overwrite, realLength } from './typed-arrays.js';

let starting: Promise<void> | undefined;
let compiled: WebAssembly.Module | undefined;
let instance: Core | undefined;

/** An instance of the module, and the one workspace of its calls. */
interface Core {
  module: CoreModule;
  workspace: Workspace;
}

function makeCore(module: WebAssembly.Module): Core {
  const core = instantiate<CoreModule>(createModule, module, 'Workspace');
  return { module: core, workspace: new core.Workspace() };
}

/**
 * Compiles the WebAssembly module. Importing the package alone does nothing. It may be called several times, even at the same time:
 * all calls share one module, and the options of the first count.
 * @throws {CagecastError} `unsupported` if the host cannot run WebAssembly with SIMD; the next call tries again. `badOption`
 */
export function init(): Promise<void>; // such as for `.then(init)`
export function init(options: InitOptions): Promise<void>;
export function init(options: InitOptions = {}): Promise<void> {
  starting ??= start(options).catch((cause: unknown) => {
    starting = undefined;
    throw unsupported(cause);
  });
  return starting;
}

async function start(options: InitOptions): Promise<void> {
  const module = await (givenModule(options) ?? compile());
  instance = makeCore(module);
  compiled = module;
}

/** Arrays that may be written over, by their names in the answer. */
export type Reusable = Record<string, Uint8Array | Uint32Array | Float32Array>;

/**
 * Uses the core. If a call runs out of memory or traps, its instance is discarded, and the next call gets a new one.
 * @throws {CagecastError} `notInitialised`, `outOfMemory`, `internal`
 */
export function useCore<A>(fn: string, use: (core: Core) => A): A {
  if (compiled === undefined) throw notInitialised(fn);
  try {
    instance ??= makeCore(compiled);
    return use(instance);
  } catch (cause) {
    dropInstance();
    throw failureOf(fn, cause);
  }
}

/**
 * Calls a function of the core. Arrays of the answer are written into arrays of `reusable` with the same name and length, unless the
 * call throws.
 * @returns the answer; the caller owns its arrays.
 * @throws {CagecastError} with the error that the core reports; and as `useCore`.
 */
export function callCore<A extends Answer>(fn: string, call: (core: Core) => A, reusable: Reusable = {}): Own<A> {
  const { status, ...answer } = useCore(fn, (core) => {
    const { status, ...views } = call(core);
    if (status.code !== 'ok') return { status } as A;
    const copies = copyViews(views, reusable);
    core.workspace.release();
    return { status, ...withNames(core, copies) } as A;
  });
  if (status.code === 'ok') return answer as unknown as Own<A>;
  if (status.code === 'outOfMemory') dropInstance();
  throw new CagecastError(status.code as Code, fn, status.message, status);
}

/** An answer without its status, as users get it: with names in place of enumeration values. */
type Own<A> = { [Name in Exclude<keyof A, 'status'>]: A[Name] extends CoreSegment[] ? SegmentStats[] : A[Name] };

function withNames(core: Core, answer: { segmentStats?: CoreSegment[] }): object {
  return answer.segmentStats
    ? {
        ...answer,
        segmentStats: answer.segmentStats.map((segment) => ({
          ...segment,
          culledBy: nameOf(core, 'CulledBy', segment.culledBy),
        })),
      }
    : answer;
}

/** Replaces the views of WebAssembly memory in an answer by copies of them. */
function copyViews(views: Record<string, unknown>, reusable: Reusable): object {
  // Allocate first: if that fails, no array of the caller is overwritten.
  const copies = Object.entries(views).map(([name, view]) => {
    if (!ArrayBuffer.isView(view)) return [name, view] as const;
    const earlier = reusable[name];
    return [name, fits(earlier, view as Uint8Array) ? earlier : (view as Uint8Array).slice()] as const;
  });
  for (const [name, copy] of copies)
    if (ArrayBuffer.isView(copy) && copy === reusable[name]) overwrite(copy, views[name] as Uint8Array);
  return Object.fromEntries(copies);
}

/** Whether an array has just the room for a view. An empty one may have been moved away. */
const fits = (array: Reusable[string] | undefined, { length }: Uint8Array): boolean =>
  array !== undefined && length > 0 && realLength(array) === length;

/** Frees the instance's memory, which can grow but never shrink. The next call makes a new instance. */
function dropInstance(): void {
  instance = undefined;
}
