/**
 * Carries a texture that was drawn for a cage onto any mesh, and finds the Non-Cosmetic Zones that must not receive it.
 * @module cagecast
 */
export { CagecastError, type Code } from './error.js';
export { init } from './engine.js';
export type { Mesh } from './mesh.js';
export type { ClassifyOptions, Preset, ProjectOptions, TransferOptions } from './options.js';
export {
  classify,
  project,
  transfer,
  type Classification,
  type Projected,
  type Projection,
  type SegmentStats,
  type Timings,
  type TransferResult,
} from './transfer.js';
export { Zone } from './zone.js';
