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

// Copies of views: a slice of the memory itself would be filled with zeros before it is written.
const u8 = (memory: ArrayBuffer, at: number, bytes: number) => new Uint8Array(new Uint8Array(memory, at, bytes));
const u32 = (memory: ArrayBuffer, at: number, bytes: number) => new Uint32Array(new Uint32Array(memory, at, bytes / 4));
const f32 = (memory: ArrayBuffer, at: number, bytes: number) => new Float32Array(new Float32Array(memory, at, bytes / 4));
const f64 = (memory: ArrayBuffer, at: number, bytes: number) => new Float64Array(new Float64Array(memory, at, bytes / 8));

// The arrays of answers, in the order of bindings.cpp.
const presetArrays = { options: f64 };
const classifyArrays = { zones: u8, cosmeticTriangles: u8, culledSegments: u8, margins: f64 };
const splitArrays = { sources: u32, indices: u32, uvs: f32 };
const cutArrays = { sources: u32, weights: f32, indices: u32, triangles: u32, uvs: f32, cornerUvs: f32, zones: u8, cosmeticTriangles: u8 };
const projectArrays = {
  uvs: f32,
  cornerUvs: f32,
  zones: u8,
  triangles: u32,
  distances: f32,
  segments: u32,
  /** Points, A, E, C, D, group and first copy of each segment. */
  segmentStats: f64,
  restores: u32,
  /** Hole, segment, exposed and uncovered area of each share. */
  holeShares: f64,
  /** The timings, in their order, and the peak of memory. */
  numbers: f64,
  /** This and the next ones after `transfer` only; else empty. */
  cosmeticTriangles: u8,
  culledSegments: u8,
  margins: f64,
};

type Layout = Record<string, (memory: ArrayBuffer, at: number, bytes: number) => object>;
/** An answer and its arrays, which are copies. Those of a failure are missing. */
type AnswerOf<L extends Layout> = Answer & { [Name in keyof L]: ReturnType<L[Name]> };
export type ProjectAnswer = AnswerOf<typeof projectArrays>;
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

/** The functions of the core, on arrays; `options` are numbers in the order of options.ts. */
export interface Bindings {
  presetOptions(preset: number): Float64Array;
  project(cage: CheckedMesh, target: CheckedMesh, options: Float64Array): ProjectAnswer;
  transfer(cage: CheckedMesh, target: CheckedMesh, options: Float64Array): ProjectAnswer;
  classify(projection: CoreProjection, options: Float64Array, locks: Uint8Array): ClassifyAnswer;
  splitVertices(indices: Indices, cornerUvs: Float32Array, vertexCount: number): SplitAnswer;
  cutBorders(cage: CheckedMesh, target: CheckedMesh, options: Float64Array, decided: CoreDecided): CutAnswer;
}

/** Brings arrays into WebAssembly memory and out of it. No view of it leaves: it is cut to length 0 when the memory grows. */
export function bind(core: Glue, memory: WebAssembly.Memory): Bindings {
  type Source = ArrayLike<number>;
  type View = { new (buffer: ArrayBuffer, at: number, length: number): { set(source: Source): void }; BYTES_PER_ELEMENT: number };

  const put = (...inputs: [View, Source][]) => {
    inputs.forEach(([Type, source], place) => {
      if (source.length === 0) return;
      const at = core._room(place, source.length * Type.BYTES_PER_ELEMENT);
      if (at === 0) throw new RangeError('WebAssembly memory is full');
      new Type(memory.buffer, at, source.length).set(source);
    });
  };
  const putMeshes = (options: Float64Array, cage: CheckedMesh, target: CheckedMesh, ...more: [View, Source][]) => {
    const arrays = [cage, target].flatMap(({ positions, indices, uvs, groups }): [View, Source][] => [
      [Float32Array, positions],
      [Uint32Array, indices],
      [Float32Array, uvs],
      [Uint32Array, groups],
    ]);
    put([Float64Array, options], ...arrays, ...more);
  };
  const take = <L extends Layout>(table: number, layout: L): AnswerOf<L> => {
    const names = Object.keys(layout);
    const [code = 0, argument = 0, at = 0, ...places] = new Uint32Array(memory.buffer, table, 3 + 2 * names.length);
    const array = (name: string, i: number) => layout[name]!(memory.buffer, places[2 * i]!, places[2 * i + 1]!);
    const arrays = code === 0 ? Object.fromEntries(names.map((name, i) => [name, array(name, i)])) : {};
    core._release();
    return { code, argument, at, ...arrays } as AnswerOf<L>;
  };

  return {
    presetOptions: (preset) => take(core._presetOptions(preset), presetArrays).options,
    project(cage, target, options) {
      putMeshes(options, cage, target);
      return take(core._project(), projectArrays);
    },
    transfer(cage, target, options) {
      putMeshes(options, cage, target);
      return take(core._transfer(), projectArrays);
    },
    classify({ zones, segments, segmentStats, restores, holeShares, indices }, options, locks) {
      const parts: [View, Source][] = [[Uint8Array, zones], [Uint32Array, segments], [Float64Array, segmentStats], [Uint32Array, restores]];
      put([Float64Array, options], ...parts, [Float64Array, holeShares], [Uint32Array, indices], [Uint8Array, locks]);
      return take(core._classify(), classifyArrays);
    },
    splitVertices(indices, cornerUvs, vertexCount) {
      put([Uint32Array, indices], [Float32Array, cornerUvs]);
      return take(core._splitVertices(vertexCount), splitArrays);
    },
    cutBorders(cage, target, options, { zones, segments, culledSegments }) {
      putMeshes(options, cage, target, [Uint8Array, zones], [Uint32Array, segments], [Uint8Array, culledSegments]);
      return take(core._cutBorders(), cutArrays);
    },
  };
}
