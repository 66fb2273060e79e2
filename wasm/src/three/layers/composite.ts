import type { Texture, WebGLRenderer, WebGLRenderTarget } from 'three';
import { maxCompositeSize } from '../../gltf/look/saved-images.js';
import type { Regions } from '../../gltf/look/saved-layers.js';
import { kMaxRects } from '../gpu/pass.js';
import { disjoint, kWhole, type Rect, toTexels } from '../gpu/rect.js';
import { type Channel, channels, layersOf } from './kinds.js';
import type { Layer } from './layer.js';
import { type ActiveStroke, isSquare, LayerPass, sidesOf } from './layer-pass.js';
import { Plane } from './plane.js';

const kMinSize = 1024; // texels per side

/**
 * The layers blended into one texture, with mipmaps and premultiplied alpha, and into one more for each channel that some of them
 * have. `update` redraws them after a change, and only the parts that changed.
 * @internal
 */
export class Composite {
  readonly #color = new Plane('color', kMinSize);
  /** Those that the layers have, as of the last update. */
  readonly #channels = new Map<Channel, Plane>();
  readonly #pass: LayerPass;
  readonly #size: number | undefined;
  #layers: readonly Layer[] = [];
  /** Versions of the textures that were drawn, by layer: of its sheet, and of its normal map. */
  readonly #drawn: number[] = [];
  /** The parts that changed since the last update, in shares. */
  #stale: Rect[] = [kWhole];

  /**
   * @param size     Texels per side, a power of two. Default: 1024 or 2048, as the largest layer needs.
   * @param regions  Of the cage. Default: none.
   */
  constructor(size?: number, regions: Regions = {}) {
    this.#size = size;
    this.#pass = new LayerPass(regions);
    // The renderer does not upload it; this tells `cagecast/three` how its texels are stored.
    this.texture.premultiplyAlpha = true;
  }

  /** Always the same object. sRGB, premultiplied alpha, first row at v = 0. */
  get texture(): Texture {
    return this.#color.target.texture;
  }

  /** The textures of the channels that the layers have, as of the last update; of the size of `texture`. */
  get channels(): ReadonlyMap<Channel, Plane> {
    return this.#channels;
  }

  /** By what the colours of the glow have to be multiplied. */
  get glow(): number {
    return this.#pass.glow;
  }

  /** Texels per side: as many as the largest layer needs. */
  get size(): number {
    return this.#color.target.width;
  }

  /** @param layers From the lowest to the uppermost, at most `maxLayers`. */
  set(layers: readonly Layer[]): void {
    this.#layers = layers.filter(({ visible, opacity }) => visible && opacity > 0);
    this.#stale = [kWhole];
  }

  /** Marks parts of a sheet as changed. @param rects In shares. @param stroke The stroke in progress, if any. */
  touch(rects: readonly Rect[], stroke?: ActiveStroke): void {
    this.#pass.stroke = stroke;
    this.#stale.push(...rects);
  }

  /** Redraws what changed, including textures with `needsUpdate`. @returns Whether anything did. */
  update(renderer: WebGLRenderer): boolean {
    // In each frame, so nothing is allocated here.
    for (let i = 0; i < this.#layers.length; ++i) {
      const { sheet, normal } = this.#layers[i]!;
      const [ofSheet, ofNormal] = [sheet.texture.version, normal ? normal.version : -1];
      if (ofSheet !== this.#drawn[2 * i] || ofNormal !== this.#drawn[2 * i + 1]) this.#stale = [kWhole];
      this.#drawn[2 * i] = ofSheet;
      this.#drawn[2 * i + 1] = ofNormal;
    }
    if (this.#stale.length === 0) return false;
    const textures = this.#layers.flatMap(({ sheet, normal }) => (normal ? [sheet.texture, normal] : sheet.texture));
    const isLarge = textures.some((texture) => Math.max(...sidesOf(texture)) > kMinSize);
    const size = this.#size ?? (isLarge ? maxCompositeSize : kMinSize);
    const whole = size !== this.size || this.#stale.includes(kWhole);
    // In texels: upsampling a smaller sheet spreads each of its texels over the neighbours.
    const margin = this.#layers.every(({ sheet }) => isSquare(sheet.texture, size)) ? 0 : 2;
    const rects = whole
      ? [toTexels(kWhole, size)]
      : disjoint(
          this.#stale.map((rect) => toTexels(rect, size, margin)),
          kMaxRects,
        );
    this.#pass.begin(this.#layers);
    // Layers with other channels make all of it stale, so a new texture is drawn as a whole.
    this.#makeChannels(size);
    for (const plane of [this.#color, ...this.#channels.values()]) {
      plane.target.setSize(size, size);
      plane.draw(renderer, this.#pass, this.#layers, rects);
    }
    this.#stale = [];
    return true;
  }

  /** What `texture` is drawn to. */
  get target(): WebGLRenderTarget {
    return this.#color.target;
  }

  /** The texels: premultiplied, in sRGB, row by row from v = 0. Waits for the GPU. */
  read(renderer: WebGLRenderer, texels = new Uint8Array(4 * this.size * this.size)): Uint8Array {
    renderer.readRenderTargetPixels(this.#color.target, 0, 0, this.size, this.size, texels);
    return texels;
  }

  /** Frees its GPU memory. */
  dispose(): void {
    for (const plane of [this.#color, ...this.#channels.values()]) plane.dispose();
    this.#channels.clear();
    this.#pass.dispose();
    this.#stale = [kWhole];
  }

  /** Makes the textures that the layers need, and frees the others. */
  #makeChannels(size: number): void {
    for (const channel of channels) {
      const plane = this.#channels.get(channel);
      const isNeeded = layersOf(channel, this.#layers).length > 0;
      if (isNeeded && !plane) this.#channels.set(channel, new Plane(channel, size));
      if (isNeeded || !plane) continue;
      plane.dispose();
      this.#channels.delete(channel);
    }
  }
}
