/**
 * Carries a texture that was drawn for a cage onto any mesh, and finds the Non-Cosmetic Zones that must not receive it.
 * @module cagecast
 */

export { init } from './engine.js';
export { CagecastError, type Code } from './error.js';
export type { Into } from './into.js';
export type { Mesh } from './mesh.js';
export {
  type ClassifyOptions,
  type Lock,
  type Locks,
  type Preset,
  type PresetOptions,
  type ProjectOptions,
  presetOptions,
  type TransferOptions,
} from './options.js';
export { type SplitVertices, splitVertices } from './split.js';
export {
  type Classification,
  classify,
  type HoleShare,
  type Projected,
  type Projection,
  project,
  type SegmentStats,
  type Timings,
  type TransferResult,
  transfer,
} from './transfer.js';
export { Zone } from './zone.js';
