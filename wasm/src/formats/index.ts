/**
 * Models of other formats as GLBs: FBX, OBJ, PLY, STL and USDZ, by the loaders of three.js.
 * @module cagecast/formats
 */
export { type Companions, toGlb } from './to-glb.js';
