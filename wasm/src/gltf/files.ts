/** The functions on the bytes of files: a file of their own in the package, which pages that use documents do not carry. */
export type { FormatLimits } from './formats/limits.js';
export { type Companions, toGlb } from './formats/to-glb.js';
export type { PaintedGlb, PaintOptions } from './paint/options.js';
export { paintGlb } from './paint/paint-glb.js';
export type { Thumbnail, ThumbnailOptions } from './thumbnail/options.js';
export { thumbnail } from './thumbnail/thumbnail.js';
export type { Angles, ViewName } from './thumbnail/views.js';
