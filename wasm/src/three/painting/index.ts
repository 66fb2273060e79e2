/**
 * Painting on models that `cagecast/three` has painted: brush, eraser, stickers and text, in the UV space of the cage.
 * @module cagecast/three/paint
 */
export { type CageMesh, CageTexels, type Capsule, type SurfacePoint } from './cage-texels.js';
export { LayerPainter, type LayerPainterEvents, type PaintedLayers } from './layer-painter.js';
export { PaintedSheet, type PaintingSize, paintingSizes } from './painted-sheet.js';
export {
  createPainter,
  Painter,
  type PainterOptions,
  type StickerPlace,
  type StrokePoint,
  type Tool,
} from './painter.js';
export type { Spot } from './pick.js';
export { type PlacedSticker, type StickerFrame, StickerPainter, StickersSheet } from './placed-stickers.js';
export { type Aim, type BrushStyle, type PointerPosition, PointerStroke, type PointerView } from './pointer-stroke.js';
export {
  type StickerImage,
  type StickerPicture,
  StickerSheet,
  type StickerStyle,
  type StickerText,
} from './sticker.js';
export { Stroke, type StrokeShape } from './stroke.js';
export { type LaidSticker, type Sticker, StrokeLayer, type StrokeStyle } from './stroke-layer.js';
