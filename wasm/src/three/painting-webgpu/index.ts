/**
 * Layers and painting of `cagecast/three/paint` with the `WebGPURenderer` of three.js r178 or newer, and what `cagecast/three/webgpu` has:
 * import it once, and nothing else changes. A `WebGLRenderer` draws the layers.
 *
 * @example
 * import 'cagecast/three/paint/webgpu';
 * import { createPainter } from 'cagecast/three/paint';
 *
 * const painter = createPainter({ renderer: webgpuRenderer, texture, applied, cage });
 * @module cagecast/three/paint/webgpu
 */
import { WebGLRenderer } from 'three';
import { setOwnRenderer } from '../painting/index.js';
import '../webgpu/index.js';

setOwnRenderer((canvas) => new WebGLRenderer({ canvas, antialias: false, depth: false }));
