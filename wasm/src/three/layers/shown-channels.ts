import { Color, type Texture, type WebGLRenderer } from 'three';
import { kWhite } from '../../gltf/look/saved-layers.js';
import { type Channels, noChannels, setChannels } from '../materials/channels.js';
import type { Composite } from './composite.js';
import { CopiedTexture } from './copied-texture.js';
import type { Channel } from './kinds.js';
import type { Plane } from './plane.js';

/** Tells the materials that show the texture of layers of what else the layers have. */
export class ShownChannels {
  /** Where another renderer shows the layers. */
  readonly #copies = new Map<Channel, CopiedTexture>();
  #tint: string = kWhite;
  #color: Color | undefined;

  /**
   * @param texture   The one that materials show.
   * @param isCopied  Whether another renderer than that of the layers draws them.
   */
  constructor(
    readonly texture: Texture,
    readonly isCopied: boolean,
  ) {
    setChannels(texture, noChannels);
  }

  /** Has the base tinted. @returns whether it was tinted otherwise. */
  tint(tint: string): boolean {
    if (tint === this.#tint) return false;
    this.#tint = tint;
    this.#color = tint.toLowerCase() === kWhite ? undefined : new Color(tint);
    return true;
  }

  /** Shows a composite, which has just been drawn. */
  show(composite: Composite, renderer: WebGLRenderer): void {
    const { channels, glow } = composite;
    for (const [channel, { texture }] of this.#copies)
      if (!channels.has(channel)) {
        texture.dispose();
        this.#copies.delete(channel);
      }
    const shown: Channels = { ...noChannels, tint: this.#color };
    for (const [channel, plane] of channels) shown[channel] = this.#textureOf(channel, plane, renderer);
    if (shown.glow) shown.strength = glow;
    setChannels(this.texture, shown);
  }

  /** Frees the GPU memory of copies; materials show none of it any more. */
  dispose(): void {
    for (const { texture } of this.#copies.values()) texture.dispose();
    this.#copies.clear();
    setChannels(this.texture, noChannels);
  }

  #textureOf(channel: Channel, plane: Plane, renderer: WebGLRenderer): Texture {
    if (!this.isCopied) return plane.target.texture;
    let copy = this.#copies.get(channel);
    if (!copy) this.#copies.set(channel, (copy = new CopiedTexture(plane.target.texture)));
    copy.copy(plane.target, renderer);
    return copy.texture;
  }
}
