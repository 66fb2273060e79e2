import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GLSL3,
  NoBlending,
  RawShaderMaterial,
  Sphere,
  type Texture,
  Vector2,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three';
import { drawerOf, drawTo } from '../gpu/pass.js';
import { type Rect, toTexels } from '../gpu/rect.js';
import { fillShader } from './stroke-shaders.js';

// `position` is a UV.
const kVertexShader = /* glsl */ `
in vec2 position;
uniform vec2 offset;
void main() { gl_Position = vec4(2.0 * (position + offset) - 1.0, 0.0, 1.0); }
`;

// How far triangles are drawn beyond their edges, in texels: everywhere, so that no texel of the edge is left out, and in gutters,
// which smaller levels of the texture mix with what lies beside them.
const kAround = [1];
const kInGutters = [2, 3.5];

/** Fills triangles of the texture with a colour. */
export class FillPass {
  readonly #geometry = new BufferGeometry();
  readonly #material: RawShaderMaterial;
  readonly #draw: (renderer: WebGLRenderer) => void;
  readonly #size: number;

  /** @param size Texels per side. */
  constructor(size: number, owners: Texture, patches: Texture) {
    this.#size = size;
    this.#material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: `precision highp float;\n${kVertexShader}`,
      fragmentShader: `precision highp float;\nprecision highp int;\n${fillShader(size)}`,
      uniforms: {
        owners: { value: owners },
        patches: { value: patches },
        offset: { value: new Vector2() },
        paint: { value: new Color() },
        guttersOnly: { value: false },
      },
      depthTest: false,
      depthWrite: false,
      side: DoubleSide,
      blending: NoBlending,
    });
    // Else the renderer would compute it, of coordinates that have no z.
    this.#geometry.boundingSphere = new Sphere();
    this.#draw = drawerOf(this.#geometry, this.#material);
  }

  /**
   * @param uvs   6 numbers per triangle; the texture is repeated outside 0..1.
   * @returns the part that it may have changed, in texels.
   */
  run(renderer: WebGLRenderer, target: WebGLRenderTarget, uvs: ArrayLike<number>, color: string): Rect[] {
    const inside = repeated(uvs);
    if (inside.length === 0) return [];
    this.#geometry.setAttribute('position', new BufferAttribute(new Float32Array(inside), 2));
    const { uniforms } = this.#material;
    uniforms.paint!.value.set(color);
    drawTo(renderer, target, () => {
      const draw = (x: number, y: number, guttersOnly: boolean): void => {
        uniforms.offset!.value.set(x / this.#size, y / this.#size);
        uniforms.guttersOnly!.value = guttersOnly;
        this.#material.uniformsNeedUpdate = true;
        this.#draw(renderer);
      };
      draw(0, 0, false);
      for (const reach of [...kAround, ...kInGutters])
        for (let step = 0; step < 8; step++) {
          const angle = (step / 8) * 2 * Math.PI;
          draw(reach * Math.cos(angle), reach * Math.sin(angle), kInGutters.includes(reach));
        }
    });
    // The buffer is new each time.
    this.#geometry.dispose();
    return [boundsOf(inside, this.#size)];
  }

  dispose(): void {
    this.#geometry.dispose();
    this.#material.dispose();
  }
}

/** Triangles moved to 0..1, as often as they reach beyond its right or upper edge. */
function repeated(uvs: ArrayLike<number>): number[] {
  const found: number[] = [];
  for (let at = 0; at + 5 < uvs.length; at += 6) {
    const us = [uvs[at]!, uvs[at + 2]!, uvs[at + 4]!];
    const vs = [uvs[at + 1]!, uvs[at + 3]!, uvs[at + 5]!];
    if (![...us, ...vs].every(Number.isFinite)) continue;
    const [left, top] = [Math.floor(Math.min(...us)), Math.floor(Math.min(...vs))];
    // One that ends at 1 does not reach beyond it.
    const [right, bottom] = [Math.max(...us) - left > 1 ? 1 : 0, Math.max(...vs) - top > 1 ? 1 : 0];
    for (let y = 0; y <= bottom; y++)
      for (let x = 0; x <= right; x++)
        for (let corner = 0; corner < 3; corner++) found.push(us[corner]! - left - x, vs[corner]! - top - y);
  }
  return found;
}

function boundsOf(uvs: readonly number[], size: number): Rect {
  const bounds = { left: 1, top: 1, right: 0, bottom: 0 };
  for (let at = 0; at < uvs.length; at += 2) {
    bounds.left = Math.min(bounds.left, uvs[at]!);
    bounds.right = Math.max(bounds.right, uvs[at]!);
    bounds.top = Math.min(bounds.top, uvs[at + 1]!);
    bounds.bottom = Math.max(bounds.bottom, uvs[at + 1]!);
  }
  return toTexels(bounds, size, Math.ceil(Math.max(...kInGutters)) + 1);
}
