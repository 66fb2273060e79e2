/** Drawing into textures, for layers and painting. */
export { kErased } from './erased.js';
export { refreshMipmaps } from './mipmaps.js';
export { drawerOf, drawTo, kMaxRects, Pass } from './pass.js';
export { disjoint, hull, isEmpty, kWhole, type Rect, toShares, toTexels } from './rect.js';
export { readStraight } from './straight.js';
