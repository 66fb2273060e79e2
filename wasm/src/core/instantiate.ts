import { CagecastError, notStarted, show } from './error.js';

/** Options of `init`. */
export interface InitOptions {
  /**
   * The WebAssembly, compiled or as bytes: what `cagecast/cagecast.wasm` is, or for `cagecast/cages` `cagecast/cagecast-cages.wasm`. For
   * hosts that neither fetch files of the package nor compile at run time, such as edge functions. Default: the package's own.
   */
  module?: object | undefined;
}

/** The module among options, compiled; nothing if there is none. @throws {CagecastError} `badOption` */
export function givenModule({ module }: InitOptions): Promise<WebAssembly.Module> | undefined {
  if (module === undefined) return undefined;
  if (module instanceof WebAssembly.Module) return Promise.resolve(module);
  if (ArrayBuffer.isView(module) || module instanceof ArrayBuffer) return WebAssembly.compile(module as BufferSource);
  const reason = `options.module is ${show(module)}, neither a WebAssembly.Module nor its bytes`;
  throw new CagecastError('badOption', 'init', reason);
}

/**
 * Makes a fresh instance of a compiled module: a few milliseconds.
 * @param createModule  What Emscripten's glue exports.
 * @param ready         The name of something that the module binds.
 */
export function instantiate<Module extends object>(
  createModule: (module: object) => PromiseLike<unknown>,
  module: WebAssembly.Module,
  ready: keyof Module,
): Module {
  const glue: Partial<Module> = {};
  let failure: unknown;
  // The glue registers the functions synchronously; the promise that it returns is for the same object.
  createModule(
    Object.assign(glue, {
      instantiateWasm(imports: WebAssembly.Imports, receive: (instance: WebAssembly.Instance) => void): object {
        try {
          const made = new WebAssembly.Instance(module, imports);
          receive(made);
          return made.exports;
        } catch (cause) {
          // Not thrown: the glue would print it, and keep it to itself.
          failure = cause;
          return {};
        }
      },
    }),
  ).then(undefined, () => {});
  if (failure !== undefined) throw failure;
  if (glue[ready] === undefined)
    throw new CagecastError('internal', 'init', 'the WebAssembly module did not start at once');
  return glue as Module;
}

/** The error of a call before `init` has resolved. */
export const notInitialised = (fn: string): CagecastError =>
  new CagecastError('notInitialised', fn, 'Cagecast is not ready; await init() once before the first call');

/** The error of a call into WebAssembly that threw something. */
export const failureOf = (fn: string, cause: unknown): CagecastError =>
  // RangeError: an array for JavaScript could not be had. "Aborted", or a number (an exception of C++): C++ could not
  // allocate where it cannot say so.
  cause instanceof RangeError || typeof cause === 'number' || String(cause).includes('Aborted')
    ? new CagecastError('outOfMemory', fn, 'not enough memory', { cause })
    : new CagecastError('internal', fn, `the WebAssembly module failed (${String(cause)})`, { cause });

/** The error of an `init` that failed. */
export const unsupported = (cause: unknown): CagecastError =>
  cause instanceof CagecastError
    ? cause
    : new CagecastError('unsupported', 'init', notStarted('the WebAssembly module', cause), { cause });
