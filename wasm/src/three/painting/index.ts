/**
 * Painting on models that `cagecast/three` has painted, in the UV space of the cage: brush, eraser, stickers and text; and layers of
 * paint, drawn into one texture: order, opacity, tint, blend modes and undo.
 * @module cagecast/three/paint
 */

// What follows is marked `@internal`: it is for the demo page, and changes without notice.
export { readStraight } from '../gpu/straight.js';
export { Composite, maxCompositeSize } from '../layers/composite.js';
export { Edits } from '../layers/edits.js';
export { Emitter } from '../layers/emitter.js';
export { type Command, History } from '../layers/history.js';
export { type Blend, blendModes, type Layer, type Sheet, type Style } from '../layers/layer.js';
export { type ChangeOptions, createLayers, Layers, type LayersOptions, type NewLayer } from '../layers/layers.js';
export { setOwnRenderer } from '../layers/own-renderer.js';
export { PaintedSheet, type PaintingSize, paintingSizes } from '../layers/painted-sheet.js';
export type { SavedLayer, SavedLayers } from '../layers/saved-layers.js';
export { LayerStack, maxLayers } from '../layers/stack.js';
export type { SurfacePoint } from './cage-texels.js';
export { type CageMesh, CageTexels, type Capsule } from './cage-texels.js';
export { LayerPainter, type PaintedLayers } from './layer-painter.js';
export {
  createPainter,
  Painter,
  type PainterOptions,
  type StickerPlace,
  type StrokePoint,
  type Tool,
} from './painter.js';
export type { Spot } from './pick.js';
export type { BrushStyle } from './pointer-stroke.js';
export { type Aim, type PointerPosition, PointerStroke, type PointerView } from './pointer-stroke.js';
export type { StickerImage, StickerPicture, StickerText } from './sticker.js';
export { type StickerFrame, StickerPainter } from './sticker-painter.js';
export { type PlacedSticker, StickersSheet } from './stickers-sheet.js';
