// The functions on arrays. index.js of the package has them, and what imports this file shares them.

export { init } from '../core/engine.js';
export { CagecastError, type Code, type ErrorDetails } from '../core/error.js';
export type { InitOptions } from '../core/instantiate.js';
export type { HoleShare, Ratios, SegmentStats, Timings } from '../core/records.js';
export { Visibility, Zone } from '../generated/enums.js';
export { classify } from './classify.js';
export { type CutTarget, cutBorders } from './cut-borders.js';
export type { Mesh } from './mesh.js';
export {
  type ClassifyOptions,
  type Lock,
  type Locks,
  type Masks,
  type Preset,
  type PresetOptions,
  type ProjectOptions,
  presetOptions,
  type TransferOptions,
} from './options.js';
export type { PartNames, PartOf, Parts } from './parts.js';
export type { Classification, Projected, Projection, TransferResult } from './result.js';
export type { Reuse } from './reuse.js';
export { type SplitVertices, splitVertices } from './split-vertices.js';
export { project, transfer } from './transfer.js';
