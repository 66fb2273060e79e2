import createModule from '#glue';
import { compile } from '#wasm';
import { CagecastError } from './error.js';
import type { CheckedMesh } from './mesh.js';

/** How a call into the core ended: numbers of `Code` and `Argument` in core/include/cagecast/mesh.hpp; 0 is success. */
export interface Answer {
  code: number;
  argument: number;
  at: number;
}

/**
 * What bindings.cpp adds to an answer for what does not depend on the threshold. `segmentStats`: points, A, E, C, D, group and
 * first copy of each segment; `holeShares`: hole, segment, exposed and uncovered area of each share.
 */
export interface ProjectAnswer extends Answer {
  uvs: Float32Array<ArrayBuffer>;
  cornerUvs: Float32Array<ArrayBuffer>;
  zones: Uint8Array<ArrayBuffer>;
  triangles: Uint32Array<ArrayBuffer>;
  distances: Float32Array<ArrayBuffer>;
  segments: Uint32Array<ArrayBuffer>;
  segmentStats: Float64Array<ArrayBuffer>;
  restores: Uint32Array<ArrayBuffer>;
  holeShares: Float64Array<ArrayBuffer>;
  timings: Float64Array<ArrayBuffer>;
  peakBytes: number;
}

/** What bindings.cpp adds to an answer for step 5. */
export interface ClassifyAnswer extends Answer {
  zones: Uint8Array<ArrayBuffer>;
  cosmeticTriangles: Uint8Array<ArrayBuffer>;
  culledSegments: Uint8Array<ArrayBuffer>;
}

/** What bindings.cpp adds to an answer of `splitVertices`. */
export interface SplitAnswer extends Answer {
  sources: Uint32Array<ArrayBuffer>;
  indices: Uint32Array<ArrayBuffer>;
  uvs: Float32Array<ArrayBuffer>;
}

/** What the core needs to classify; `segmentStats` and `holeShares` in numbers, as in `ProjectAnswer`. */
export interface CoreProjection {
  zones: Uint8Array;
  segments: Uint32Array;
  segmentStats: Float64Array;
  restores: Uint32Array;
  holeShares: Float64Array;
  indices: Uint32Array | Uint16Array | Uint8Array;
}

/** The functions of bindings.cpp. All arrays they return are copies; `options` are numbers in the order of options.ts. */
export interface Bindings {
  presetOptions(preset: number): Float64Array<ArrayBuffer>;
  project(cage: CheckedMesh, target: CheckedMesh, options: Float64Array): ProjectAnswer;
  transfer(cage: CheckedMesh, target: CheckedMesh, options: Float64Array): ProjectAnswer & ClassifyAnswer;
  classify(projection: CoreProjection, options: Float64Array, locks: Uint8Array): ClassifyAnswer;
  splitVertices(indices: Uint32Array | Uint16Array | Uint8Array, cornerUvs: Float32Array, vertexCount: number): SplitAnswer;
}

let starting: Promise<void> | undefined;
let compiled: WebAssembly.Module | undefined;
let instance: Bindings | undefined;

/** Makes a fresh instance of the compiled module: about a millisecond. */
function instantiate(module: WebAssembly.Module): Bindings {
  const bindings: Partial<Bindings> = {};
  // The glue takes the instance and registers the functions at once; what it returns is a promise for the same object.
  void createModule(
    Object.assign(bindings, {
      instantiateWasm(imports: WebAssembly.Imports, receive: (instance: WebAssembly.Instance) => void): object {
        const made = new WebAssembly.Instance(module, imports);
        receive(made);
        return made.exports;
      },
    }),
  );
  if (bindings.transfer === undefined) throw new CagecastError('internal', 'init: the WebAssembly module did not start at once');
  return bindings as Bindings;
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
    throw new CagecastError('unsupported', `init: this host cannot run the WebAssembly module (${String(cause)})`, 0, { cause });
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
