import {
  LinearFilter,
  LinearMipmapLinearFilter,
  NoColorSpace,
  RepeatWrapping,
  SRGBColorSpace,
  type WebGLRenderer,
  WebGLRenderTarget,
} from 'three';
import { refreshMipmaps } from '../gpu/mipmaps.js';
import type { Rect } from '../gpu/rect.js';
import { type Kind, layersOf, maxAtOnce } from './kinds.js';
import type { Layer } from './layer.js';
import type { LayerPass } from './layer-pass.js';

/** A texture that shows something of layers, with mipmaps. */
export class Plane {
  readonly target: WebGLRenderTarget;
  /** The lower ones of many layers. */
  #other: WebGLRenderTarget | undefined;
  readonly #format;

  /** @param size Texels per side. */
  constructor(
    readonly kind: Kind,
    size: number,
  ) {
    const isData = kind === 'surface' || kind === 'normals';
    this.#format = { colorSpace: isData ? NoColorSpace : SRGBColorSpace, depthBuffer: false };
    this.target = new WebGLRenderTarget(size, size, {
      ...this.#format,
      generateMipmaps: true,
      minFilter: LinearMipmapLinearFilter,
      magFilter: LinearFilter,
      wrapS: RepeatWrapping,
      wrapT: RepeatWrapping,
      anisotropy: 8,
    });
    const { texture } = this.target;
    // `refreshMipmaps` updates the changed parts; the renderer would rebuild all levels for every stroke.
    texture.mipmapsAutoUpdate = false;
    texture.name = kind === 'color' ? 'cagecast layers' : `cagecast layers, ${kind}`;
  }

  /** Draws what it shows of layers anew. @param rects In texels. */
  draw(renderer: WebGLRenderer, pass: LayerPass, layers: readonly Layer[], rects: readonly Rect[]): void {
    const { kind, target } = this;
    const [seen, most] = [layersOf(kind, layers), maxAtOnce[kind]];
    const rounds = Math.max(1, Math.ceil(seen.length / most));
    if (rounds > 1) {
      this.#other ??= new WebGLRenderTarget(target.width, target.width, this.#format);
      this.#other.setSize(target.width, target.width);
    }
    for (let round = 0; round < rounds; ++round) {
      // By turns, so that the last one draws what is shown.
      const isLast = (rounds - round) % 2 === 1;
      const [to, other] = isLast ? [target, this.#other] : [this.#other!, target];
      const below = round > 0 ? other!.texture : undefined;
      pass.draw(renderer, to, { kind, layers: seen.slice(most * round, most * (round + 1)), below }, rects);
    }
    refreshMipmaps(renderer, target, rects);
  }

  /** Frees its GPU memory. */
  dispose(): void {
    this.target.dispose();
    this.#other?.dispose();
    this.#other = undefined;
  }
}
