import type { Vector2, Vector3 } from 'three';
import { PaintedSheet } from '../layers/painted-sheet.js';
import type { StickerPicture } from './sticker.js';

/** A sticker that can still be changed. @internal */
export interface PlacedSticker {
  readonly id: number;
  readonly picture: StickerPicture;
  /** The UV of its middle. */
  readonly at: Vector2;
  /** The direction of its upper edge, in the cage's space. */
  readonly up: Vector3;
  /** Its longer side, as a share of the diagonal of the cage. */
  readonly size: number;
  /** Radians, clockwise as seen. */
  readonly angle: number;
  /** 0 to 1. */
  readonly opacity: number;
  /** Whether it is seen as in a mirror. */
  readonly mirrored: boolean;
}

/** A sheet of stickers that can still be changed, until brush or eraser paint on it: then it is a painting like others. @internal */
export class StickersSheet extends PaintedSheet {
  /** From the lowest to the uppermost. */
  stickers: readonly PlacedSticker[] = [];
  /** Whether it is a painting now. */
  fixed = false;
}
