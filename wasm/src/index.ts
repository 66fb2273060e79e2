/**
 * Carries a texture that was drawn for a cage onto any mesh, and finds the Non-Cosmetic Zones that must not receive it.
 * @module cagecast
 */
export { CagecastError, type Code } from './error.js';
export { init } from './engine.js';
export type { Into } from './into.js';
export type { Mesh } from './mesh.js';
export { presetOptions, type ClassifyOptions, type Lock, type Locks, type Preset, type PresetOptions, type ProjectOptions, type TransferOptions } from './options.js';
export { splitVertices, type SplitVertices } from './split.js';
export {
  classify,
  project,
  transfer,
  type Classification,
  type HoleShare,
  type Projected,
  type Projection,
  type SegmentStats,
  type Timings,
  type TransferResult,
} from './transfer.js';
export { Zone } from './zone.js';
