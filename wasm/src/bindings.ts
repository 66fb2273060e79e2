import type { CheckedMesh } from './mesh.js';

/**
 * The functions of bindings.cpp, as Emscripten's glue names them: numbers in, the address of an answer's table out. The module of
 * cagecast/borders, of bindings_borders.cpp, has `_cutBorders` in place of the other steps.
 */
export interface Glue {
  _room(place: number, bytes: number): number;
  _presetOptions(preset: number): number;
  _project(): number;
  _transfer(): number;
  _beginTransfer(): number;
  _endTransfer(): number;
  _classify(): number;
  _splitVertices(vertexCount: number): number;
  _cutBorders(): number;
  _release(): void;
}

/** How a call into the core ended: numbers of `Code` and `Argument` in core/include/cagecast/mesh.hpp; 0 is success. */
export interface Answer {
  code: number;
  argument: number;
  at: number;
}

type AnyArray = Uint8Array | Uint32Array | Float32Array | Float64Array;

/** Arrays that may be written over, by their names in the answer. */
export type Reusable = Record<string, AnyArray>;

const u8 = (memory: ArrayBuffer, at: number, bytes: number) => new Uint8Array(memory, at, bytes);
const u32 = (memory: ArrayBuffer, at: number, bytes: number) => new Uint32Array(memory, at, bytes / 4);
const f32 = (memory: ArrayBuffer, at: number, bytes: number) => new Float32Array(memory, at, bytes / 4);
const f64 = (memory: ArrayBuffer, at: number, bytes: number) => new Float64Array(memory, at, bytes / 8);

// The arrays of answers, in the order of bindings.cpp.
const presetArrays = { options: f64 };
const classifyArrays = { zones: u8, cosmeticTriangles: u8, culledSegments: u8, margins: f64 };
const begunArrays = { segmentStats: f64 };
const splitArrays = { sources: u32, indices: u32, uvs: f32 };
const cutArrays = {
  sources: u32,
  weights: f32,
  indices: u32,
  triangles: u32,
  uvs: f32,
  cornerUvs: f32,
  zones: u8,
  cosmeticTriangles: u8,
};
const projectedArrays = {
  uvs: f32,
  cornerUvs: f32,
  zones: u8,
  triangles: u32,
  distances: f32,
  segments: u32,
  /** Points, A, E, C, D, group and first copy of each segment. */
  segmentStats: f64,
  /** The timings, in their order, and the peak of memory. */
  numbers: f64,
};
const projectArrays = {
  ...projectedArrays,
  restores: u32,
  /** Hole, segment, exposed and uncovered area of each share. */
  holeShares: f64,
  /** The target's. */
  indices: u32,
};
const transferArrays = { ...projectedArrays, cosmeticTriangles: u8, culledSegments: u8, margins: f64 };

type Layout = Record<string, (memory: ArrayBuffer, at: number, bytes: number) => AnyArray>;
/**
 * An answer and its arrays; those of a failure are missing. Numbers (Float64Array) are there to make objects of, at once: they are
 * views, which the next call takes away. All else is the caller's own.
 */
type AnswerOf<L extends Layout> = Answer & { [Name in keyof L]: ReturnType<L[Name]> };
export type ProjectedAnswer = AnswerOf<typeof projectedArrays>;
export type ProjectAnswer = AnswerOf<typeof projectArrays>;
export type TransferAnswer = AnswerOf<typeof transferArrays>;
export type BegunAnswer = AnswerOf<typeof begunArrays>;
export type ClassifyAnswer = AnswerOf<typeof classifyArrays>;
export type SplitAnswer = AnswerOf<typeof splitArrays>;
export type CutAnswer = AnswerOf<typeof cutArrays>;

type Indices = Uint32Array | Uint16Array | Uint8Array;

/** What the core needs to classify; `segmentStats` and `holeShares` in numbers, as in `ProjectAnswer`. */
export interface CoreProjection {
  zones: Uint8Array;
  segments: Uint32Array;
  segmentStats: Float64Array;
  restores: Uint32Array;
  holeShares: Float64Array;
  indices: Indices;
}

/** What the core needs of a transfer to cut its target. */
export interface CoreDecided {
  zones: Uint8Array;
  segments: Uint32Array;
  /** 1 per segment. */
  culledSegments: Uint8Array;
}

/**
 * The functions of the core, on arrays; `options` are numbers in the order of options.ts. Arrays of `into` that have the name, and
 * the length, of one of the answer become that one; unless the call fails, or throws.
 */
export interface Bindings {
  presetOptions(preset: number): Float64Array;
  project(cage: CheckedMesh, target: CheckedMesh, options: readonly number[], into?: Reusable): ProjectAnswer;
  transfer(cage: CheckedMesh, target: CheckedMesh, options: readonly number[], into?: Reusable): TransferAnswer;
  /** Does what of a transfer goes before locks; `endTransfer`, called next, does the rest. */
  beginTransfer(cage: CheckedMesh, target: CheckedMesh, options: readonly number[]): BegunAnswer;
  endTransfer(locks: Uint8Array, into?: Reusable): TransferAnswer;
  classify(projection: CoreProjection, options: readonly number[], locks: Uint8Array, into?: Reusable): ClassifyAnswer;
  splitVertices(indices: Indices, cornerUvs: Float32Array, vertexCount: number): SplitAnswer;
  cutBorders(cage: CheckedMesh, target: CheckedMesh, options: readonly number[], decided: CoreDecided): CutAnswer;
}

/** Brings arrays into WebAssembly memory and out of it. What a call leaves there is freed when the next one begins. */
export function bind(core: Glue, memory: WebAssembly.Memory): Bindings {
  type View = {
    new (buffer: ArrayBuffer, at: number, length: number): { set(source: ArrayLike<number>): void };
    BYTES_PER_ELEMENT: number;
  };

  const put = (place: number, Type: View, source: ArrayLike<number>) => {
    if (source.length === 0) return;
    const at = core._room(place, source.length * Type.BYTES_PER_ELEMENT);
    if (at === 0) throw new RangeError('WebAssembly memory is full');
    new Type(memory.buffer, at, source.length).set(source);
  };
  const putMesh = (place: number, { positions, indices, uvs, groups }: CheckedMesh) => {
    put(place, Float32Array, positions);
    put(place + 1, Uint32Array, indices);
    put(place + 2, Float32Array, uvs);
    put(place + 3, Uint32Array, groups);
  };
  const putMeshes = (options: readonly number[], cage: CheckedMesh, target: CheckedMesh) => {
    core._release();
    put(0, Float64Array, options);
    putMesh(1, cage);
    putMesh(5, target);
  };
  const take = <L extends Layout>(table: number, layout: L, into: Reusable = {}): AnswerOf<L> => {
    const { buffer } = memory;
    const names = Object.keys(layout);
    const head = new Uint32Array(buffer, table, 3 + 2 * names.length);
    const [code, argument, at] = [head[0]!, head[1]!, head[2]!];
    if (code !== 0) return { code, argument, at } as AnswerOf<L>;
    const views = names.map((name, i) => layout[name]!(buffer, head[3 + 2 * i]!, head[4 + 2 * i]!));
    // What is new first: if there is no memory for it, nothing is written over.
    const arrays = views.map((view, i) =>
      view instanceof Float64Array ? view : (reusable(into[names[i]!], view) ?? copyOf(view)),
    );
    const answer: Record<string, unknown> = { code, argument, at };
    arrays.forEach((array, i) => {
      if (array === into[names[i]!]) array.set(views[i]!);
      answer[names[i]!] = array;
    });
    return answer as AnswerOf<L>;
  };

  return {
    presetOptions: (preset) => take(core._presetOptions(preset), presetArrays).options,
    project(cage, target, options, into) {
      putMeshes(options, cage, target);
      return take(core._project(), projectArrays, into);
    },
    transfer(cage, target, options, into) {
      putMeshes(options, cage, target);
      return take(core._transfer(), transferArrays, into);
    },
    beginTransfer(cage, target, options) {
      putMeshes(options, cage, target);
      return take(core._beginTransfer(), begunArrays);
    },
    endTransfer(locks, into) {
      put(9, Uint8Array, locks);
      return take(core._endTransfer(), transferArrays, into);
    },
    classify({ zones, segments, segmentStats, restores, holeShares, indices }, options, locks, into) {
      core._release();
      put(0, Float64Array, options);
      put(1, Uint8Array, zones);
      put(2, Uint32Array, segments);
      put(3, Float64Array, segmentStats);
      put(4, Uint32Array, restores);
      put(5, Float64Array, holeShares);
      put(6, Uint32Array, indices);
      put(7, Uint8Array, locks);
      return take(core._classify(), classifyArrays, into);
    },
    splitVertices(indices, cornerUvs, vertexCount) {
      core._release();
      put(0, Uint32Array, indices);
      put(1, Float32Array, cornerUvs);
      return take(core._splitVertices(vertexCount), splitArrays);
    },
    cutBorders(cage, target, options, { zones, segments, culledSegments }) {
      putMeshes(options, cage, target);
      put(9, Uint8Array, zones);
      put(10, Uint32Array, segments);
      put(11, Uint8Array, culledSegments);
      return take(core._cutBorders(), cutArrays);
    },
  };
}

/** An array in which there is room for just what a view shows. An empty one may be what is left of one that was moved away. */
function reusable(array: AnyArray | undefined, { length }: AnyArray): AnyArray | undefined {
  return length > 0 && array?.length === length ? array : undefined;
}

/** Copies what a view shows. A slice of the memory itself would be filled with zeros before it is written. */
function copyOf<A extends AnyArray>(view: A): A {
  return new (view.constructor as new (source: A) => A)(view);
}
