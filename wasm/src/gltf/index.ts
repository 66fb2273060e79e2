/**
 * Model files: a model in, the painted file or a picture out, in Node, pages and edge functions; other formats as GLBs; checks of files
 * of strangers. And functions for glTF-Transform, which add a UV set, the Non-Cosmetic Zones and an overlay to a document.
 * @module cagecast/gltf
 */
export { type CheckOptions, checkGltf, checkImage } from './checks/check-gltf.js';
export type { ReadLimits } from './checks/read-limits.js';
export {
  addCage,
  type BakeOptions,
  type BakeReport,
  bake,
  type CagecastOptions,
  type CageModelOptions,
  cagecast,
  cageModel,
  cageTemplate,
  type ImageCodec,
  type LeftOut,
  type MaskSources,
  type Paints,
  type PartRange,
  type Parts,
} from './documents.js';
export {
  type Angles,
  type Companions,
  type FormatLimits,
  type PaintedGlb,
  type PaintOptions,
  paintGlb,
  type Thumbnail,
  type ThumbnailOptions,
  thumbnail,
  toGlb,
  type ViewName,
} from './files.js';
export { type FileKind, type Format, fileKind } from './kinds.js';
