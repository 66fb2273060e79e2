import { DataTexture, SRGBColorSpace, type Texture, Vector2, type WebGLRenderer, WebGLRenderTarget } from 'three';
import type { PaintingSize } from '../../gltf/look/saved-layers.js';
import { isEmpty, type Rect } from '../gpu/rect.js';
import type { Sheet } from './layer.js';

/** A render target to paint on: sRGB, premultiplied alpha, transparent at first. */
export function makePaintTarget(size: number): WebGLRenderTarget {
  return new WebGLRenderTarget(size, size, { colorSpace: SRGBColorSpace, depthBuffer: false });
}

/**
 * A sheet to paint on. Its texels are kept twice: on the GPU, where strokes are drawn, and as bytes, for undo steps and to
 * restore the texture after the graphics context was lost.
 * @internal
 */
export class PaintedSheet implements Sheet {
  readonly premultiplied = true;
  /** Strokes are drawn here; call `readBack` afterwards. */
  readonly target: WebGLRenderTarget;
  readonly #bytes: Uint8Array;
  readonly bytes: number;
  /** URL of a thumbnail, for lists. */
  picture?: string;

  /** @param size Texels per side. */
  constructor(readonly size: PaintingSize) {
    this.target = makePaintTarget(size);
    this.bytes = 4 * size * size;
    this.#bytes = new Uint8Array(this.bytes);
  }

  get texture(): Texture {
    return this.target.texture;
  }

  /** The texels of a part, row by row. @param rect In texels. */
  get(rect: Rect): Uint8Array {
    const part = new Uint8Array(4 * (rect.right - rect.left) * (rect.bottom - rect.top));
    eachRow(rect, this.size, (place, inPart, length) => part.set(this.#bytes.subarray(place, place + length), inPart));
    return part;
  }

  /** Copies a part of the target into the bytes and returns it. @param rect In texels. Waits for the GPU. */
  readBack(renderer: WebGLRenderer, rect: Rect): Uint8Array {
    // A lost context gives no texels: earlier ones stay.
    if (renderer.getContext().isContextLost()) return this.get(rect);
    const [width, height] = [rect.right - rect.left, rect.bottom - rect.top];
    const part = new Uint8Array(4 * width * height);
    renderer.readRenderTargetPixels(this.target, rect.left, rect.top, width, height, part);
    this.#keep(rect, part);
    return part;
  }

  /** Writes texels that `get` or `readBack` returned. */
  put(renderer: WebGLRenderer, rect: Rect, part: Uint8Array): void {
    this.#keep(rect, part);
    upload(renderer, this.target, rect, part);
  }

  /** Uploads the bytes again, after the graphics context was lost. */
  restore(renderer: WebGLRenderer): void {
    upload(renderer, this.target, { left: 0, top: 0, right: this.size, bottom: this.size }, this.#bytes);
  }

  /** Frees its GPU memory. */
  dispose(): void {
    this.target.dispose();
  }

  #keep(rect: Rect, part: Uint8Array): void {
    eachRow(rect, this.size, (place, inPart, length) => this.#bytes.set(part.subarray(inPart, inPart + length), place));
  }
}

/** @param size Texels per side of the sheet. @param visit Receives for each row its offset in the sheet and in the part, and its length; all in bytes. */
function eachRow(
  { left, top, right, bottom }: Rect,
  size: number,
  visit: (place: number, inPart: number, length: number) => void,
): void {
  const length = 4 * (right - left);
  for (let row = top; row < bottom; row++) visit(4 * (row * size + left), (row - top) * length, length);
}

function upload(renderer: WebGLRenderer, target: WebGLRenderTarget, rect: Rect, part: Uint8Array): void {
  if (isEmpty(rect)) return;
  renderer.initRenderTarget(target);
  const source = new DataTexture(part, rect.right - rect.left, rect.bottom - rect.top);
  renderer.copyTextureToTexture(source, target.texture, null, new Vector2(rect.left, rect.top));
}
