import type { Aim } from '#three';
import { element } from '../../platform/page';

/** The outline of the brush at the pointer. */
export class Ring {
  readonly #ring = document.createElement('div');

  constructor() {
    this.#ring.className = 'brush-ring';
    this.#ring.hidden = true;
    element('stage', HTMLElement).append(this.#ring);
  }

  /** Shows a length of the cage where the pointer can paint, and hides otherwise: fingers cover it. */
  follow(aim: Aim | undefined, { clientX, clientY, pointerType }: PointerEvent, length: number): void {
    if (!aim?.surface || pointerType === 'touch') this.hide();
    else this.show(clientX, clientY, length * aim.scale);
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
