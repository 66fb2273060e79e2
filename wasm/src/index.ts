/**
 * Transfers a texture that was drawn for a cage to any mesh, and finds the Non-Cosmetic Zones, which must not be painted; and checks whether a
 * cage fits.
 * @module cagecast
 */
export * from './api/index.js';
export {
  type Finding,
  type FindingCode,
  type Hole,
  type Inside,
  type Inspection,
  type InspectOptions,
  inspect,
  type Place,
  type Placement,
  type Segment,
  type Spots,
  type Topology,
  type UvLayout,
  type Verdict,
} from './inspect/index.js';
