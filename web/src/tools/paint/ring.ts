import type { Aim } from '#three';
import { element } from '../../platform/page';

// The range of the sliders for brushes.
const kLeast = 3; // pixels of the screen
const kMost = 300;

/** The diameter of a brush in pixels of the screen. @param place Of its slider, 0..100. */
export const brushPixels = (place: number): number => kLeast * (kMost / kLeast) ** (place / 100);

/** The outline of the brush at the pointer. */
export class Ring {
  readonly #ring = document.createElement('div');

  constructor() {
    this.#ring.className = 'brush-ring';
    this.#ring.hidden = true;
    element('stage', HTMLElement).append(this.#ring);
  }

  /** Shows it where the pointer can paint, and hides it otherwise: fingers cover it. @param diameter In pixels. */
  follow(aim: Aim | undefined, { clientX, clientY, pointerType }: PointerEvent, diameter: number): void {
    if (!aim?.surface || pointerType === 'touch') this.hide();
    else this.show(clientX, clientY, diameter);
  }

  /** @param x,y In client pixels. @param diameter In pixels. */
  show(x: number, y: number, diameter: number): void {
    const { left, top } = this.#ring.parentElement!.getBoundingClientRect();
    const { style } = this.#ring;
    style.width = style.height = `${diameter}px`;
    style.translate = `${x - left - diameter / 2}px ${y - top - diameter / 2}px`;
    this.#ring.hidden = false;
  }

  hide(): void {
    this.#ring.hidden = true;
  }
}
