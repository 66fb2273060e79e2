/** Baking: the paint in a model's own UVs, and back. */

export { type BakeOptions, type BakePart, type BakeResult, type BakeTarget, bakeTexture, cageTexture } from './bake.js';
export { type Image, mostTexels, resize } from './image.js';
export { areaOf, type Baked, type FillOptions, fill, type Layout, layOver } from './layout.js';
export { type MaskImages, maskTriangles, maskVertices } from './mask-triangles.js';
export type { Kind, Wrap } from './raster.js';
export { type RegionMaskOptions, regionMask } from './region-mask.js';
