import { CanvasTexture, SRGBColorSpace, Vector3, type WebGLRenderer } from 'three';
import { Composite } from '../layers/composite';
import { kPlain } from '../layers/layer';
import type { SurfacePoint } from './cage-texels';
import type { Sticker } from './stroke-layer';

/** What a sticker shows. */
export type StickerPicture = { text: string; color: string } | { image: ImageBitmap };

/** Size and rotation of a sticker. */
export interface StickerStyle {
  /** Its longer side, in the cage's space. */
  size: number;
  /** Radians, clockwise as seen. */
  angle: number;
}

const kSide = 512; // pixels of the longer side
const kMargin = 4; // transparent pixels around it, so that filtering does not wrap around the repeating texture

/** The texture of a sticker. */
export class StickerSheet {
  // A composite of one layer brings mipmaps and premultiplied alpha, so that edges keep their colour.
  readonly #composite = new Composite();
  #canvas = document.createElement('canvas');
  #texture: CanvasTexture | undefined;

  /** Shows another picture. */
  draw(picture: StickerPicture): void {
    this.#canvas = 'text' in picture ? drawText(picture) : drawImage(picture.image);
    this.#texture?.dispose();
    this.#texture = new CanvasTexture(this.#canvas);
    this.#texture.colorSpace = SRGBColorSpace;
    this.#texture.flipY = false;
    this.#texture.generateMipmaps = false;
    this.#composite.set([{ ...kPlain, id: 0, name: '', sheet: { texture: this.#texture, picture: '' } }]);
  }

  /** The sticker at a point of the cage, upright with respect to `up`. */
  at(renderer: WebGLRenderer, { normal }: SurfacePoint, up: Vector3, { size, angle }: StickerStyle): Sticker {
    this.#composite.update(renderer);
    const { width, height } = this.#canvas;
    const scale = size / Math.max(width, height);
    const upright = new Vector3().copy(up).addScaledVector(normal, -up.dot(normal));
    // Seen along `up`: any direction is upright.
    if (upright.lengthSq() < 1e-6)
      upright.set(normal.y, normal.z, normal.x).addScaledVector(normal, -normal.dot(upright));
    upright.normalize().applyAxisAngle(normal, -angle);
    const right = new Vector3().crossVectors(upright, normal);
    return { texture: this.#composite.texture, width: width * scale, height: height * scale, right, up: upright };
  }
}

function drawText({ text, color }: { text: string; color: string }): HTMLCanvasElement {
  const font = (pixels: number): string => `700 ${pixels}px system-ui, sans-serif`;
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d')!;
  context.font = font(100);
  const measured = context.measureText(text);
  const wide = Math.max(1, measured.actualBoundingBoxLeft + measured.actualBoundingBoxRight);
  const high = Math.max(1, measured.actualBoundingBoxAscent + measured.actualBoundingBoxDescent);
  const scale = (kSide - 2 * kMargin) / Math.max(wide, high);
  canvas.width = Math.ceil(wide * scale) + 2 * kMargin;
  canvas.height = Math.ceil(high * scale) + 2 * kMargin;
  context.font = font(100 * scale);
  context.fillStyle = color;
  context.fillText(
    text,
    kMargin + measured.actualBoundingBoxLeft * scale,
    kMargin + measured.actualBoundingBoxAscent * scale,
  );
  return canvas;
}

function drawImage(image: ImageBitmap): HTMLCanvasElement {
  const scale = (kSide - 2 * kMargin) / Math.max(image.width, image.height);
  const [width, height] = [Math.max(1, Math.round(image.width * scale)), Math.max(1, Math.round(image.height * scale))];
  const canvas = document.createElement('canvas');
  canvas.width = width + 2 * kMargin;
  canvas.height = height + 2 * kMargin;
  const context = canvas.getContext('2d')!;
  context.imageSmoothingQuality = 'high';
  context.drawImage(image, kMargin, kMargin, width, height);
  return canvas;
}
