/** All of this folder that other folders and the demo page use. What of it is public is in index.ts. */

export { likelyTemplate } from '../cages/likely-template.js';
export { matcher } from '../core/patterns.js';
export { maxCompositeSize } from '../gltf/look/saved-images.js';
export {
  maxLayers,
  type PaintingSize,
  paintingSizes,
  type SavedLayer,
  type SavedLayers,
} from '../gltf/look/saved-layers.js';
export type { Borders } from '../parts/cut-part.js';
export type { LeftOut } from '../parts/drawn.js';
export type { Apart } from '../parts/own-cages.js';
export type { Prepared, PreparedPart } from '../parts/prepare.js';
export type { PartRange } from '../parts/split-part.js';
export type { Applied, ApplyOptions, Saved } from './apply/apply-options.js';
export { applyTransfer, applyTransferAsync, moveApart, prepareTransfer } from './apply/apply-transfer.js';
export { zoneAttribute } from './apply/attributes.js';
export { cutGeometry } from './apply/cut-geometry.js';
export { giveBackTriangles } from './apply/earlier-overlays.js';
export { bareGroups, type Extracted, extract, type Part } from './apply/extract-scene.js';
export { cageGeometry, cageModel, cageTemplate } from './apply/loaded-cages.js';
export type { Loaded, LoadedCage, LoadedGltf } from './apply/models.js';
export { deserialize, serialize } from './apply/saved-transfer.js';
export type { Calling } from './apply/tasks.js';
export { readStraight } from './gpu/straight.js';
export { type InspectModelOptions, inspectModel } from './inspect-model.js';
export { Composite } from './layers/composite.js';
export { Edits } from './layers/edits.js';
export { Emitter } from './layers/emitter.js';
export { type Command, History } from './layers/history.js';
export { type Blend, blendModes, type Layer, type Sheet, type Style } from './layers/layer.js';
export { type ChangeOptions, createLayers, Layers, type LayersOptions, type NewLayer } from './layers/layers.js';
export { setOwnRenderer } from './layers/own-renderer.js';
export { PaintedSheet } from './layers/painted-sheet.js';
export { LayerStack } from './layers/stack.js';
export { setNodePainter } from './materials/node-paint.js';
export { type ModelMasks, modelMasks } from './model-masks.js';
export { type CageMesh, CageTexels, type Capsule, type SurfacePoint } from './painting/cage-texels.js';
export { LayerPainter, type PaintedLayers } from './painting/layer-painter.js';
export {
  createPainter,
  Painter,
  type PainterOptions,
  type StickerPlace,
  type StrokePoint,
  type Tool,
} from './painting/painter.js';
export type { Spot } from './painting/pick.js';
export {
  type Aim,
  type BrushStyle,
  type PointerPosition,
  PointerStroke,
  type PointerView,
} from './painting/pointer-stroke.js';
export type { StickerImage, StickerPicture, StickerText } from './painting/sticker.js';
export { type StickerFrame, StickerPainter } from './painting/sticker-painter.js';
export { type PlacedSticker, StickersSheet } from './painting/stickers-sheet.js';
export type { StickerPart } from './painting/stroke-layer.js';
