import { CanvasTexture, SRGBColorSpace, Vector3, type WebGLRenderer } from 'three';
import { type Canvas, type Context, makeCanvas } from '../canvas.js';
import { notA, wrong } from '../errors.js';
import { Composite } from '../layers/composite.js';
import { plainStyle } from '../layers/layer.js';
import type { SurfacePoint } from './cage-texels.js';
import type { Sticker } from './stroke-layer.js';

/** An image that a canvas can draw, with its size. */
export type StickerImage = ImageBitmap | HTMLImageElement | HTMLCanvasElement | OffscreenCanvas;

/** A line of text. */
export interface StickerText {
  text: string;
  /** A colour of CSS. */
  color: string;
  /** A font family of CSS. Default: `system-ui, sans-serif`. */
  font?: string | undefined;
  /** A colour of CSS for a line around the letters. Default: no line. */
  outline?: string | undefined;
}

/** What a sticker shows: a line of text, or an image. */
export type StickerPicture = StickerText | { image: StickerImage };

/** Size and rotation of a sticker. */
export interface StickerStyle {
  /** Its longer side, in the cage's space. */
  size: number;
  /** Radians, clockwise as seen. */
  angle: number;
  /** Whether it is seen as in a mirror. */
  mirrored?: boolean | undefined;
}

// Pixels of the longer side: more than it ever has texels, so that text is not enlarged.
const kSide = 1024;
const kOutline = 0.14; // width of the line around letters, as a share of the size of the font
const kMargin = 4; // transparent pixels around it, so that filtering does not wrap around the repeating texture

/** The texture of a sticker. */
export class StickerSheet {
  // A composite of one layer brings mipmaps and premultiplied alpha, so that edges keep their colour.
  readonly #composite = new Composite();
  #texture: CanvasTexture<Canvas> | undefined;

  /** Shows another picture. @throws {CagecastError} `badArgument` for what is none, and for an image that is not loaded yet. */
  draw(picture: StickerPicture): void {
    checkPicture(picture);
    const texture = new CanvasTexture('text' in picture ? drawText(picture) : drawImage(picture.image));
    this.#texture?.dispose();
    texture.colorSpace = SRGBColorSpace;
    texture.flipY = false;
    texture.generateMipmaps = false;
    this.#texture = texture;
    this.#composite.set([{ ...plainStyle, id: 0, name: '', sheet: { texture } }]);
  }

  /** The sticker that was drawn, at a point of the cage, upright with respect to `up`. */
  at(
    renderer: WebGLRenderer,
    { normal }: SurfacePoint,
    up: Vector3,
    { size, angle, mirrored = false }: StickerStyle,
  ): Sticker {
    this.#composite.update(renderer);
    const { width, height } = this.#texture!.image;
    const scale = size / Math.max(width, height);
    const upright = new Vector3().copy(up).addScaledVector(normal, -up.dot(normal));
    // Seen along `up`: any direction is upright.
    if (upright.lengthSq() < 1e-6)
      upright.set(normal.y, normal.z, normal.x).addScaledVector(normal, -normal.dot(upright));
    upright.normalize().applyAxisAngle(normal, -angle);
    const right = new Vector3().crossVectors(upright, normal);
    const { texture } = this.#composite;
    return { texture, width: width * scale, height: height * scale, right, up: upright, mirrored };
  }

  /** Frees its GPU memory. */
  dispose(): void {
    this.#composite.dispose();
    this.#texture?.dispose();
  }
}

/** @throws {CagecastError} `badArgument` */
export function checkPicture(picture: StickerPicture): void {
  const given = Object(picture);
  if (!('text' in given || given.image)) throw notA('a text or an image', 'the picture', picture);
}

function drawText({ text, color, outline, font: family = 'system-ui, sans-serif' }: StickerText): Canvas {
  const font = (pixels: number): string => `700 ${pixels}px ${family}`;
  const canvas = makeCanvas(1, 1);
  const context = canvas.getContext('2d') as Context;
  context.font = font(100);
  const measured = context.measureText(text);
  const line = outline === undefined ? 0 : 100 * kOutline;
  const wide = Math.max(1, measured.actualBoundingBoxLeft + measured.actualBoundingBoxRight + line);
  const high = Math.max(1, measured.actualBoundingBoxAscent + measured.actualBoundingBoxDescent + line);
  const scale = (kSide - 2 * kMargin) / Math.max(wide, high);
  canvas.width = Math.ceil(wide * scale) + 2 * kMargin;
  canvas.height = Math.ceil(high * scale) + 2 * kMargin;
  context.font = font(100 * scale);
  const [x, y] = [measured.actualBoundingBoxLeft, measured.actualBoundingBoxAscent].map(
    (from) => kMargin + (from + line / 2) * scale,
  ) as [number, number];
  if (outline !== undefined) {
    Object.assign(context, { strokeStyle: outline, lineWidth: line * scale, lineJoin: 'round' });
    context.strokeText(text, x, y);
  }
  context.fillStyle = color;
  context.fillText(text, x, y);
  return canvas;
}

function drawImage(image: StickerImage): Canvas {
  // The width of an element is that of its place on the page.
  const { naturalWidth: wide = image.width, naturalHeight: high = image.height } = image as HTMLImageElement;
  if (!(wide * high > 0)) throw wrong('the image is not loaded yet');
  const scale = (kSide - 2 * kMargin) / Math.max(wide, high);
  const [width, height] = [wide, high].map((side) => Math.max(1, Math.round(side * scale))) as [number, number];
  const canvas = makeCanvas(width + 2 * kMargin, height + 2 * kMargin);
  const context = canvas.getContext('2d') as Context;
  context.imageSmoothingQuality = 'high';
  context.drawImage(image, kMargin, kMargin, width, height);
  return canvas;
}
