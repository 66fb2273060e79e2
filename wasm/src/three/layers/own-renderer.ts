import type { WebGLRenderer } from 'three';
import { type Canvas, makeCanvas } from '../canvas.js';
import { wrong } from '../errors.js';

/** A `WebGPURenderer` of three.js, as far as it is used here. */
export interface OtherRenderer {
  readonly isWebGPURenderer: true;
  readonly domElement: HTMLCanvasElement;
}

let make: ((canvas: Canvas) => WebGLRenderer) | undefined;

/** For `enableLayers`: pages that do not call it need no `WebGLRenderer`, which `three/webgpu` does not have. */
export function setOwnRenderer(maker: (canvas: Canvas) => WebGLRenderer): void {
  make = maker;
}

/** One for all layers that models of other renderers show, as browsers keep few graphics contexts. */
let own: WebGLRenderer | undefined;
let users = 0;

/**
 * Lends a renderer that draws layers without a model. Give it back by `giveBack`.
 * @throws {CagecastError} `badArgument` without `enableLayers`, `unsupported` without WebGL 2.
 */
export function lendRenderer(): WebGLRenderer {
  if (!make) throw wrong('options.renderer is a WebGPURenderer: call enableLayers() of cagecast/three/webgpu once');
  try {
    own ??= make(makeCanvas(1, 1));
  } catch {
    throw wrong('layers need WebGL 2, also beside a WebGPURenderer', undefined, 'unsupported');
  }
  ++users;
  return own;
}

/** Frees the renderer with its last user. */
export function giveBack(): void {
  if (--users > 0 || !own) return;
  own.dispose();
  own.forceContextLoss();
  own = undefined;
}
