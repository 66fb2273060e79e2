import type { Spot } from '../view/pick';
import type { Tool } from '../view/pointing';
import type { Viewer } from '../view/viewer';
import type { PaintOptions } from './paint-options';
import type { Painter } from './painter';
import type { Ring } from './ring';
import { type StickerPicture, StickerSheet } from './sticker';

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
    if (!picture || !this.painter.surfacePointOf(spot)) return false;
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

  /** Moves it. */
  go(spot: Spot | undefined): void {
    const point = this.painter.surfacePointOf(spot);
    const { cageTexels: texels } = this.painter;
    if (!point || !texels) return;
    this.painter.stick(
      point,
      this.#sheet,
      { size: this.options.size * texels.diagonal, angle: this.options.angle },
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
    const { cageTexels: texels } = this.painter;
    if (!texels || !this.painter.surfacePointOf(spot) || pointerType === 'touch') this.ring.hide();
    else this.ring.show(clientX, clientY, this.options.size * texels.diagonal * this.viewer.pixelsAt(spot!.seen));
  }

  #picture(): StickerPicture | undefined {
    const { text, color } = this.options;
    if (text.trim() !== '') return { text: text.trim(), color };
    return this.#image && { image: this.#image };
  }
}
