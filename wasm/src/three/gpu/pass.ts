import {
  BufferAttribute,
  BufferGeometry,
  DynamicDrawUsage,
  GLSL3,
  type IUniform,
  type Material,
  Mesh,
  NoBlending,
  OrthographicCamera,
  RawShaderMaterial,
  Scene,
  type ShaderMaterialParameters,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three';
import type { Rect } from './rect.js';

/** Rectangles that one pass can be run over. */
export const kMaxRects = 128;

const kVertexShader = /* glsl */ `
in vec3 position;
void main() { gl_Position = vec4(position, 1.0); }
`;

/** Runs a fragment shader over rectangles of a render target. */
export class Pass<Uniforms extends Record<string, IUniform>> {
  readonly #corners = new BufferAttribute(new Float32Array(6 * 3 * kMaxRects), 3).setUsage(DynamicDrawUsage);
  readonly #geometry = new BufferGeometry().setAttribute('position', this.#corners);
  readonly #material: RawShaderMaterial;
  readonly #draw: (renderer: WebGLRenderer) => void;

  /**
   * @param fragmentShader GLSL ES 3.0. It writes linear colour; the target's format encodes it.
   * @param blending       How its output is blended with the target; it replaces it by default.
   */
  constructor(
    fragmentShader: string,
    readonly uniforms: Uniforms,
    blending: ShaderMaterialParameters = { blending: NoBlending },
  ) {
    this.#material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kVertexShader,
      fragmentShader: `precision highp float;\nprecision highp int;\nprecision highp sampler2D;\n${fragmentShader}`,
      uniforms,
      depthTest: false,
      depthWrite: false,
      ...blending,
    });
    this.#draw = drawerOf(this.#geometry, this.#material);
  }

  /** @param rects In texels of the target, at most `kMaxRects`. */
  run(renderer: WebGLRenderer, target: WebGLRenderTarget, rects: readonly Rect[]): void {
    if (rects.length === 0) return;
    rects.forEach((rect, index) => this.#setCorners(index, rect, target));
    this.#corners.needsUpdate = true;
    this.#geometry.setDrawRange(0, 6 * rects.length);
    drawTo(renderer, target, () => this.#draw(renderer));
  }

  #setCorners(index: number, { left, top, right, bottom }: Rect, { width, height }: WebGLRenderTarget): void {
    const [l, r] = [(2 * left) / width - 1, (2 * right) / width - 1];
    const [t, b] = [(2 * top) / height - 1, (2 * bottom) / height - 1];
    this.#corners.array.set([l, t, 0, r, t, 0, r, b, 0, l, t, 0, r, b, 0, l, b, 0], 18 * index);
  }

  dispose(): void {
    this.#geometry.dispose();
    this.#material.dispose();
  }
}

/** Returns a function that draws a geometry, which its vertex shader places. */
export function drawerOf(geometry: BufferGeometry, material: Material): (renderer: WebGLRenderer) => void {
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  const scene = new Scene().add(mesh);
  // Not a plain `Camera`: a renderer with a reversed depth buffer updates its projection.
  const camera = new OrthographicCamera();
  return (renderer) => renderer.render(scene, camera);
}

/** Draws to a target, over its content, and restores the renderer. */
export function drawTo(renderer: WebGLRenderer, target: WebGLRenderTarget, draw: () => void): void {
  const { autoClear, xr } = renderer;
  const before = renderer.getRenderTarget();
  const [face, level, isInHeadset] = [renderer.getActiveCubeFace(), renderer.getActiveMipmapLevel(), xr.enabled];
  try {
    renderer.autoClear = false;
    // In a headset it would draw once for each eye.
    xr.enabled = false;
    renderer.setRenderTarget(target);
    draw();
  } finally {
    renderer.autoClear = autoClear;
    xr.enabled = isInHeadset;
    renderer.setRenderTarget(before, face, level);
  }
}
