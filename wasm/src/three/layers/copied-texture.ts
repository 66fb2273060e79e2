import {
  DataTexture,
  LinearFilter,
  LinearMipmapLinearFilter,
  RepeatWrapping,
  type Texture,
  type WebGLRenderer,
  type WebGLRenderTarget,
} from 'three';

/** A copy of what layers were drawn to that any renderer can show: its texels, as they are. */
export class CopiedTexture {
  #texels = new Uint8Array(4);
  readonly texture = new DataTexture(this.#texels, 1, 1);

  /** @param source  The texture of the target that is copied later. */
  constructor({ name, colorSpace }: Texture) {
    const { texture } = this;
    texture.name = name;
    texture.colorSpace = colorSpace;
    texture.wrapS = texture.wrapT = RepeatWrapping;
    texture.magFilter = LinearFilter;
    texture.minFilter = LinearMipmapLinearFilter;
    texture.generateMipmaps = true;
    texture.anisotropy = 8;
    // Renderers must not multiply the texels once more; this tells `cagecast/three` that they are.
    texture.userData = { cagecastPremultiplied: true };
    texture.needsUpdate = true;
  }

  /** Copies a target, which has just been drawn to. Waits for the GPU of its renderer. */
  copy(target: WebGLRenderTarget, renderer: WebGLRenderer): void {
    if (renderer.getContext().isContextLost()) return;
    const { texture } = this;
    const { width: size } = target;
    if (texture.image.width !== size) {
      texture.dispose();
      this.#texels = new Uint8Array(4 * size * size);
      texture.image = { data: this.#texels, width: size, height: size };
    }
    renderer.readRenderTargetPixels(target, 0, 0, size, size, this.#texels);
    texture.needsUpdate = true;
  }
}
