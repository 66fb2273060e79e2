import createModule from '#glue';
import { compile } from '#wasm';
import { type Bindings, bind, type Glue } from './bindings.js';
import { CagecastError } from './error.js';

let starting: Promise<void> | undefined;
let compiled: WebAssembly.Module | undefined;
let instance: Bindings | undefined;

/** Makes a fresh instance of the compiled module: about a millisecond. */
function instantiate(module: WebAssembly.Module): Bindings {
  const glue: Partial<Glue> = {};
  let memory: WebAssembly.Memory | undefined;
  let failure: unknown;
  // The glue takes the instance and registers the functions at once; what it returns is a promise for the same object.
  createModule(
    Object.assign(glue, {
      instantiateWasm(imports: WebAssembly.Imports, receive: (instance: WebAssembly.Instance) => void): object {
        let made: WebAssembly.Instance;
        try {
          made = new WebAssembly.Instance(module, imports);
        } catch (cause) {
          // The glue keeps it to itself.
          throw (failure = cause);
        }
        // It goes by another name with every release of Emscripten.
        memory = Object.values(made.exports).find((entry) => entry instanceof WebAssembly.Memory);
        receive(made);
        return made.exports;
      },
    }),
  ).then(undefined, () => {});
  if (failure !== undefined) throw failure;
  if (glue._room === undefined || memory === undefined)
    throw new CagecastError('internal', 'init: the WebAssembly module did not start at once');
  return bind(glue as Glue, memory);
}

/**
 * Makes Cagecast ready: compiles the WebAssembly module. Nothing starts before it is called.
 * It may be called any number of times, also at once: all calls share one start.
 * @throws {CagecastError} `unsupported` if the host cannot run WebAssembly with SIMD; the next call tries again.
 */
export function init(): Promise<void> {
  starting ??= start().catch((cause: unknown) => {
    starting = undefined;
    if (cause instanceof CagecastError) throw cause;
    throw new CagecastError('unsupported', `init: this host cannot run the WebAssembly module (${String(cause)})`, 0, {
      cause,
    });
  });
  return starting;
}

async function start(): Promise<void> {
  const module = await compile();
  instance = instantiate(module);
  compiled = module;
}

/**
 * Calls the core, and outlives its end: a call that runs out of memory or traps costs its instance, not the next call.
 * @throws {CagecastError} `notInitialised`, `outOfMemory`, `internal`
 */
export function callCore<A>(fn: string, call: (bindings: Bindings) => A): A {
  if (compiled === undefined) {
    throw new CagecastError('notInitialised', `${fn}: Cagecast is not ready; await init() once before the first call`);
  }
  try {
    instance ??= instantiate(compiled);
    return call(instance);
  } catch (cause) {
    dropInstance();
    // RangeError: an array for JavaScript could not be had. "Aborted", or a number (an exception of C++): C++ could not
    // allocate where it cannot say so.
    const memory = cause instanceof RangeError || typeof cause === 'number' || String(cause).includes('Aborted');
    throw memory
      ? new CagecastError('outOfMemory', `${fn}: not enough memory for this target and cage`, 0, { cause })
      : new CagecastError('internal', `${fn}: the WebAssembly module failed (${String(cause)})`, 0, { cause });
  }
}

/** Gives the instance's memory back; the next call makes a new one. WebAssembly memory grows but never shrinks. */
export function dropInstance(): void {
  instance = undefined;
}
