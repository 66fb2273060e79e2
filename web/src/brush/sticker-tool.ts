import type { Spot } from '../view/pick';
import type { Tool } from '../view/pointing';
import type { Viewer } from '../view/viewer';
import type { PaintOptions } from './options';
import type { Painter } from './painter';
import type { Ring } from './ring';
import { type StickerPicture, StickerSheet } from './sticker';

/** Sticks a text or an image on where a pointer is pressed; it follows the pointer until that is released. */
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

  /** Takes an image in place of the text, until there is a text again. */
  setImage(image: ImageBitmap): void {
    this.#image = image;
    this.options.text = '';
    this.#drawn = '';
  }

  down(spot: Spot | undefined): boolean {
    const picture = this.#picture();
    if (!picture || !this.painter.placeOf(spot)) return false;
    const key = 'text' in picture ? `${picture.text} ${picture.color}` : 'image';
    if (key !== this.#drawn) this.#sheet.draw(picture);
    this.#drawn = key;
    const { color, opacity } = this.options;
    if (!this.painter.begin('sticker', { color, opacity, hardness: 1, erases: false })) return false;
    this.go(spot);
    return true;
  }

  move(spot: Spot | undefined, event: PointerEvent): void {
    this.go(spot);
    this.hover(spot, event);
  }

  /** Sticks it on there instead. */
  go(spot: Spot | undefined): void {
    const place = this.painter.placeOf(spot);
    const { atlas } = this.painter;
    if (!place || !atlas) return;
    this.painter.stick(
      place,
      this.#sheet,
      { size: this.options.size * atlas.diagonal, angle: this.options.angle },
      this.viewer.up,
    );
  }

  up(): void {
    this.painter.end();
  }

  cancel(): void {
    this.painter.cancel();
  }

  hover(spot: Spot | undefined, { clientX, clientY, pointerType }: PointerEvent): void {
    const { atlas } = this.painter;
    if (!atlas || !this.painter.placeOf(spot) || pointerType === 'touch') return this.ring.hide();
    this.ring.show(clientX, clientY, this.options.size * atlas.diagonal * this.viewer.pixelsAt(spot!.seen));
  }

  #picture(): StickerPicture | undefined {
    const { text, color } = this.options;
    if (text.trim() !== '') return { text: text.trim(), color };
    return this.#image && { image: this.#image };
  }
}
