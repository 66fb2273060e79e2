/**
 * Transfers a texture that was drawn for a cage to any mesh, and finds the Non-Cosmetic Zones, which must not be painted.
 * @module cagecast
 */

export { classify } from './api/classify.js';
export { type CutTarget, cutBorders } from './api/cut-borders.js';
export type { Mesh } from './api/mesh.js';
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
} from './api/options.js';
export type { PartNames, PartOf, Parts } from './api/parts.js';
export type { Classification, Projected, Projection, TransferResult } from './api/result.js';
export type { Reuse } from './api/reuse.js';
export { type SplitVertices, splitVertices } from './api/split-vertices.js';
export { project, transfer } from './api/transfer.js';
export { init } from './core/engine.js';
export { CagecastError, type Code, type ErrorDetails } from './core/error.js';
export type { InitOptions } from './core/instantiate.js';
export type { HoleShare, Ratios, SegmentStats, Timings } from './core/records.js';
export { Visibility, Zone } from './generated/enums.js';
