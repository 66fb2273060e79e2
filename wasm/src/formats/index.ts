/**
 * Models of other formats as GLBs: FBX, OBJ, PLY, STL and USDZ, by the loaders of three.js, in a worker for each.
 * @module cagecast/formats
 */
export type { FormatLimits } from './limits.js';
export { type Companions, toGlb } from './to-glb.js';
