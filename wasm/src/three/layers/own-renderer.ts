import type { WebGLRenderer } from 'three';
import { type Canvas, makeCanvas } from '../canvas.js';
import { kPaint, wrong } from '../errors.js';

/** A `WebGPURenderer` of three.js, as far as it is used here. */
export interface OtherRenderer {
  readonly isWebGPURenderer: true;
  readonly domElement: HTMLCanvasElement;
}

let make: ((canvas: Canvas) => WebGLRenderer) | undefined;

/** For `cagecast/three/paint/webgpu`: pages without it need no `WebGLRenderer`, which `three/webgpu` does not have. @internal */
export function setOwnRenderer(maker: (canvas: Canvas) => WebGLRenderer): void {
  make = maker;
}

/** One for all layers that models of other renderers show, as browsers keep few graphics contexts. */
let own: WebGLRenderer | undefined;
let users = 0;

/**
 * Lends a renderer that draws layers without a model. Give it back by `giveBack`.
 * @throws {CagecastError} `badArgument` without that entry, `unsupported` without WebGL 2.
 */
export function lendRenderer(): WebGLRenderer {
  if (!make)
    throw wrong(
      'options.renderer is a WebGPURenderer, for which the page has to import cagecast/three/paint/webgpu',
      kPaint,
    );
  try {
    own ??= make(makeCanvas(1, 1));
  } catch {
    throw wrong('layers need WebGL 2, also beside a WebGPURenderer', kPaint, 'unsupported');
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
