/**
 * For engines other than three.js: what a transfer makes of the vertex and index buffers of a model, on plain arrays.
 * @module cagecast/parts
 */

export {
  type AttributeArray,
  applySplit,
  applySplitToSkin,
  type Blends,
  type Rule,
  type SkinArrays,
  type Split,
} from './blend.js';
export type { Borders, PartCut } from './cut-part.js';
export { joinParts, type PartArrays } from './join-parts.js';
export { type Prepared, type PreparedPart, type PrepareOptions, paintedVertices, prepareParts } from './prepare.js';
export type { PartRange, SplitPart } from './split-part.js';
