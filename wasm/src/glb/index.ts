/**
 * A model file in, the painted file or a picture out: what `cagecast transfer` and `cagecast thumbnail` do, as functions for Node, pages and
 * edge functions.
 * @module cagecast/glb
 */
export { type PaintedGlb, type PaintOptions, paintGlb } from './paint-glb.js';
export type { Thumbnail, ThumbnailOptions } from './thumbnail/options.js';
export { thumbnail } from './thumbnail/thumbnail.js';
export type { Angles, ViewName } from './thumbnail/views.js';
