import { type StickerPicture, StickerSheet } from 'cagecast/three/paint';
import type { Spot } from '../view/pick';
import type { Tool } from '../view/pointing';
import type { Viewer } from '../view/viewer';
import type { PaintOptions } from './paint-options';
import type { Painter } from './painter';
import type { Ring } from './ring';

/** Places a text or an image where the pointer is pressed; it follows the pointer until release. */
export class StickerTool implements Tool {
  readonly #sheet = new StickerSheet();
  #image: ImageBitmap | undefined;
  #drawn = '';

  constructor(
    private readonly painter: Painter,
    private readonly viewer: Viewer,
    private readonly options: PaintOptions,
    private readonly ring: Ring,
  ) {}

  /** Uses an image instead of the text, until a text is entered. */
  setImage(image: ImageBitmap): void {
    this.#image = image;
    this.options.text = '';
    this.#drawn = '';
  }

  down(spot: Spot | undefined): boolean {
    const picture = this.#picture();
    if (!picture || !this.painter.aimOf(spot)?.surface) return false;
    const key = 'text' in picture ? `${picture.text} ${picture.color}` : 'image';
    if (key !== this.#drawn) this.#sheet.draw(picture);
    this.#drawn = key;
    const { color, opacity } = this.options;
    return this.painter.telling(() => {
      this.painter.begin('sticker', { color, opacity, hardness: 1, erases: false });
      this.go(spot);
      return true;
    });
  }

  move(spot: Spot | undefined, event: PointerEvent): void {
    this.go(spot);
    this.hover(spot, event);
  }

  /** Moves it. */
  go(spot: Spot | undefined): void {
    const point = this.painter.aimOf(spot)?.surface;
    if (!point) return;
    const { size, angle } = this.options;
    this.painter.stick(point, this.#sheet, { size: this.painter.lengthOf(size), angle }, this.viewer.up);
  }

  up(): void {
    this.painter.end();
  }

  cancel(): void {
    this.painter.cancel();
  }

  hover(spot: Spot | undefined, event: PointerEvent): void {
    this.ring.follow(this.painter.aimOf(spot), event, this.painter.lengthOf(this.options.size));
  }

  #picture(): StickerPicture | undefined {
    const { text, color } = this.options;
    if (text.trim() !== '') return { text: text.trim(), color };
    return this.#image && { image: this.#image };
  }
}
