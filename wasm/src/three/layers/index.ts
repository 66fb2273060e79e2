/**
 * Layers of paint for models that `cagecast/three` has painted: order, opacity, tint, blend modes and undo, drawn into one texture.
 * @module cagecast/three/layers
 */

export { readStraight } from '../gpu/index.js';
export { type ActiveStroke, Composite, maxCompositeSize } from './composite.js';
export { Edits } from './edits.js';
export { Emitter } from './emitter.js';
export { type Command, History } from './history.js';
export { type Blend, blendModes, freeName, type Layer, plainStyle, type Sheet, type Style } from './layer.js';
export { createLayers, Layers, type LayersOptions, type NewLayer } from './layers.js';
export { LayerStack, maxLayers, type StackEvents } from './stack.js';
