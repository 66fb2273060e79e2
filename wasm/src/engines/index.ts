/**
 * For engines other than three.js, on plain arrays: what a transfer makes of the vertex and index buffers of a model; and baking, the paint in
 * a model's own UVs, and back. Needs neither three.js nor a canvas.
 * @module cagecast/engines
 */
export {
  type Baked,
  type BakeOptions,
  type BakePart,
  type BakeResult,
  type BakeTarget,
  bakeTexture,
  cageTexture,
  type Image,
  type Kind,
  layOver,
  type MaskImages,
  maskTriangles,
  maskVertices,
  type RegionMaskOptions,
  regionMask,
  resize,
  type Wrap,
} from '../bake/index.js';
export { type RelayOptions, relayPaint } from '../bake/relay.js';
export {
  type AttributeArray,
  applySplit,
  applySplitToSkin,
  type Blends,
  type Rule,
  type SkinArrays,
  type Split,
} from '../parts/blend.js';
export type { Borders, PartCut } from '../parts/cut-part.js';
export { joinParts, type PartArrays } from '../parts/join-parts.js';
export {
  type Prepared,
  type PreparedPart,
  type PrepareOptions,
  paintedVertices,
  prepareParts,
} from '../parts/prepare.js';
export type { PartRange, SplitPart } from '../parts/split-part.js';
