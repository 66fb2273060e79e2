import type { HoleShare, SegmentStats, Timings } from './records.js';

/** A value of an enumeration in C++. */
export type EnumValue = { readonly value: number };
/** An enumeration in C++: its values by name. It is the class of its values, too. */
export type Enum = Record<string, EnumValue>;

export type CoreValue = number | boolean | EnumValue;
/** All options, as C++ takes them. */
export type CoreOptions = { [name: string]: CoreValue } & { steps: Record<string, CoreValue> };

/** A mesh whose arrays have the right types; missing ones are empty. */
export interface CheckedMesh {
  positions: Float32Array;
  indices: Uint32Array | Uint16Array | Uint8Array;
  uvs: Float32Array;
  groups: Uint32Array;
  poses: Float32Array;
}

/** Groups by list. */
export type PartNumbers = Partial<Record<'ignore' | 'keep' | 'exclude', Uint32Array>>;

/** Parts, locks and masks, as C++ takes them. */
export interface CoreOverrides {
  parts: PartNumbers;
  locks: CoreLock[];
  masks: { vertices?: Int8Array; triangles?: Int8Array };
}
interface CoreLock {
  segment: number;
  lock: EnumValue;
}

/** How a call ended: `ok`, or the name and sentence of what went wrong, and the argument at fault, empty if there is none. */
interface Status {
  code: string;
  message: string;
  argument: string;
  at: number;
}

/** The arrays of an answer are views of WebAssembly memory: copy them before the next call. */
export interface Answer {
  status: Status;
}

/** A segment, as C++ has it. */
export type CoreSegment = Omit<SegmentStats, 'culledBy'> & { culledBy: EnumValue };

type U8 = Uint8Array<ArrayBuffer>;
type U32 = Uint32Array<ArrayBuffer>;
type F32 = Float32Array<ArrayBuffer>;

interface ProjectedAnswer extends Answer {
  uvs: F32;
  cornerUvs: F32;
  triangles: U32;
  distances: F32;
  segments: U32;
  segmentStats: CoreSegment[];
  timings: Timings;
  peakBytes: number;
}
interface ProjectAnswer extends ProjectedAnswer {
  visibility: U8;
  recovery: U32;
  hiddenBy: U32;
  hiders: U32;
  holeShares: HoleShare[];
  indices: U32;
}
interface ClassifyAnswer extends Answer {
  zones: U8;
  cosmeticTriangles: U8;
  segmentStats: CoreSegment[];
}
interface TransferAnswer extends ProjectedAnswer, ClassifyAnswer {}
interface SplitAnswer extends Answer {
  sources: U32;
  indices: U32;
  uvs: F32;
}
interface CutAnswer extends Answer {
  sources: U32;
  weights: F32;
  indices: U32;
  triangles: U32;
  uvs: F32;
  cornerUvs: F32;
  zones: U8;
  cosmeticTriangles: U8;
}

/** What C++ needs of a projection to classify it. */
export interface CoreProjection {
  visibility: Uint8Array;
  segments: Uint32Array;
  segmentStats: CoreSegment[];
  recovery: Uint32Array;
  hiddenBy: Uint32Array;
  hiders: Uint32Array;
  holeShares: HoleShare[];
  indices: Uint32Array;
}

/** What C++ needs of a transfer to cut its target. */
export interface CoreDecision {
  zones: Uint8Array;
  segments: Uint32Array;
  /** 1 per segment. */
  culledBy: EnumValue[];
}

/** The working memory of calls, and what the last one left to be copied. */
export interface Workspace {
  project(cage: CheckedMesh, target: CheckedMesh, options: CoreOptions, overrides: CoreOverrides): ProjectAnswer;
  transfer(cage: CheckedMesh, target: CheckedMesh, options: CoreOptions, overrides: CoreOverrides): TransferAnswer;
  classify(projection: CoreProjection, options: CoreOptions, overrides: CoreOverrides): ClassifyAnswer;
  splitVertices(target: CheckedMesh, cornerUvs: Float32Array): SplitAnswer;
  cutBorders(
    cage: CheckedMesh,
    target: CheckedMesh,
    decision: CoreDecision,
    options: CoreOptions,
    overrides: CoreOverrides,
  ): CutAnswer;
  release(): void;
}

/** What wasm/bindings.cpp binds: besides these, its enumerations by name. */
export type CoreModule = {
  Workspace: new () => Workspace;
  presetOptions(preset: EnumValue): CoreOptions;
  /** The value of `recovery` from which on it names a hole. */
  throughHole: number;
  /** The most triangles a mesh may have. */
  maxTriangles: number;
} & { [type: string]: Enum };

type Core = { module: CoreModule };

/** The names of an enumeration's values. */
export function namesOf({ module }: Core, type: string): string[] {
  const values = module[type]!;
  return Object.keys(values).filter((name) => values[name] instanceof (values as unknown as new () => object));
}

/** The name of a value. */
export const nameOf = ({ module }: Core, type: string, value: unknown): string =>
  Object.keys(module[type]!).find((name) => module[type]![name] === value)!;
