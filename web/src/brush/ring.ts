import { element } from '../platform/page';

/** The outline of the brush at the pointer. */
export class Ring {
  readonly #ring = document.createElement('div');

  constructor() {
    this.#ring.className = 'brush-ring';
    this.#ring.hidden = true;
    element('stage', HTMLElement).append(this.#ring);
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
