'use client'; // for frameworks that also render on a server

/**
 * Cagecast for react-three-fiber: hooks and a component that paint loaded models, and take the paint off when they leave.
 * @module cagecast/react
 */
export { Cagecast, type CagecastProps } from './component.js';
export { type CagecastOptions, type Painted, useCagecast } from './use-cagecast.js';
export { type LayerItem, type UseLayersOptions, useLayers } from './use-layers.js';
export { type UsePainterOptions, usePainter } from './use-painter.js';
