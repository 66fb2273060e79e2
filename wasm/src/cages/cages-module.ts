import type { Image } from '../bake/image.js';
import type { Answer, CheckedMesh, Enum, EnumValue, PartNumbers } from '../core/module.js';

export interface CoreLandmark {
  name: string;
  position: [number, number, number];
  confidence: number;
}
export interface CageAnswer extends Answer {
  positions: Float32Array<ArrayBuffer>;
  uvs: Float32Array<ArrayBuffer>;
  indices: Uint32Array<ArrayBuffer>;
  landmarks: CoreLandmark[];
  kind: EnumValue;
}
export interface FitAnswer extends CageAnswer {
  missing: string[];
  guessed: string[];
  bare: number[];
  closed: number[];
}
export interface FoundAnswer extends Answer {
  landmarks: CoreLandmark[];
  missing: string[];
  rig: string;
  kind: EnumValue;
}

/** A model, as C++ takes it. */
export interface CoreModel {
  mesh: CheckedMesh;
  /** One name for each part. */
  parts: string[];
  joints: { name: string; position: number[]; parent: number }[];
  marks: Uint8Array;
  hints: CoreLandmark[];
  vertexJoints: Uint16Array;
  /** With the number of its image; -1 for none. */
  baseColors: { factor: [number, number, number]; image: number; isKnown: boolean }[];
  images: Image[];
}

/** A template, as C++ takes it. */
export interface CoreTemplate {
  mesh: CheckedMesh;
  landmarks: CoreLandmark[];
  kind: EnumValue;
}

export type CoreOptions = Record<string, number | EnumValue>;
type Report = (share: number, stage: string) => boolean;

/** What wasm/cages_bindings.cpp binds. */
export interface CagesModule {
  Kind: Enum;
  /** All options with their defaults. */
  makeOptions(): CoreOptions;
  refineOptions(): CoreOptions;
  makeCage(model: CoreModel, options: CoreOptions, parts: PartNumbers, report: Report): CageAnswer;
  fitCage(
    template: CoreTemplate,
    model: CoreModel,
    landmarks: CoreLandmark[],
    parts: PartNumbers,
    report: Report,
  ): FitAnswer;
  findLandmarks(model: CoreModel, report: Report): FoundAnswer;
  excludedByName(parts: string[]): boolean[];
  refineCage(cage: CheckedMesh, model: CoreModel, options: CoreOptions, report: Report): CageAnswer;
}
