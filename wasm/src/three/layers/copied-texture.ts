import {
  DataTexture,
  LinearFilter,
  LinearMipmapLinearFilter,
  RepeatWrapping,
  SRGBColorSpace,
  type WebGLRenderer,
} from 'three';
import type { Composite } from './composite.js';

/** A copy of a composite that any renderer can show: its texels, as they are. */
export class CopiedTexture {
  #texels = new Uint8Array(4);
  readonly texture = new DataTexture(this.#texels, 1, 1);

  constructor() {
    const { texture } = this;
    texture.name = 'cagecast layers';
    texture.colorSpace = SRGBColorSpace;
    texture.wrapS = texture.wrapT = RepeatWrapping;
    texture.magFilter = LinearFilter;
    texture.minFilter = LinearMipmapLinearFilter;
    texture.generateMipmaps = true;
    texture.anisotropy = 8;
    // Renderers must not multiply the texels once more; this tells `cagecast/three` that they are.
    texture.userData = { cagecastPremultiplied: true };
    texture.needsUpdate = true;
  }

  /** Copies a composite, which has just been drawn. Waits for the GPU of its renderer. */
  copy(composite: Composite, renderer: WebGLRenderer): void {
    if (renderer.getContext().isContextLost()) return;
    const { texture } = this;
    const { size } = composite;
    if (texture.image.width !== size) {
      texture.dispose();
      this.#texels = new Uint8Array(4 * size * size);
      texture.image = { data: this.#texels, width: size, height: size };
    }
    composite.read(renderer, this.#texels);
    texture.needsUpdate = true;
  }
}
