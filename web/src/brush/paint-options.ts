import { type PaintingSize, paintingSizes } from 'cagecast/three/paint';
import { element } from '../platform/page';

/** The painting tools; each shows its own options. */
export type Kind = 'brush' | 'eraser' | 'sticker';

// The range of the size slider, as shares of the diagonal of the cage.
const kLeastSize = 0.004;
const kMostSize = 0.4;

/** The tool options below the list of layers. */
export class PaintOptions {
  readonly #slot = element('tool-options', HTMLElement);
  readonly #color = element('brush-color', HTMLInputElement);
  readonly #size = element('brush-size', HTMLInputElement);
  readonly #hardness = element('brush-hardness', HTMLInputElement);
  readonly #opacity = element('brush-opacity', HTMLInputElement);
  readonly #mirror = element('brush-mirror', HTMLInputElement);
  readonly #fine = element('painting-fine', HTMLInputElement);
  readonly #text = element('sticker-text', HTMLInputElement);
  readonly #turn = element('sticker-turn', HTMLInputElement);

  constructor() {
    for (const input of this.#slot.querySelectorAll('input')) input.addEventListener('input', () => this.#label());
    this.#label();
  }

  /** #rrggbb */
  get color(): string {
    return this.#color.value;
  }

  /** The brush's diameter, or the longer side of a sticker, as a share of the diagonal of the cage. */
  get size(): number {
    // The slider is logarithmic.
    return kLeastSize * (kMostSize / kLeastSize) ** (Number(this.#size.value) / 100);
  }

  /** 0..1 */
  get hardness(): number {
    return Number(this.#hardness.value) / 100;
  }

  /** 0..1 */
  get opacity(): number {
    return Number(this.#opacity.value) / 100;
  }

  get mirror(): boolean {
    return this.#mirror.checked;
  }

  /** Texture size of the painting, in texels per side. */
  get texels(): PaintingSize {
    return paintingSizes[this.#fine.checked ? 1 : 0];
  }

  set texels(texels: PaintingSize) {
    this.#fine.checked = texels === paintingSizes[1];
  }

  get text(): string {
    return this.#text.value;
  }

  set text(text: string) {
    this.#text.value = text;
  }

  /** Radians, clockwise. */
  get angle(): number {
    return (Number(this.#turn.value) * Math.PI) / 180;
  }

  /** Shows the options of one tool, or of none. */
  show(kind: Kind | undefined): void {
    this.#slot.hidden = kind === undefined;
    for (const part of this.#slot.querySelectorAll<HTMLElement>('[data-for]'))
      part.hidden = !part.dataset.for!.split(' ').includes(kind ?? '');
  }

  #label(): void {
    const say = (input: HTMLInputElement, text: string): void => {
      input.ariaValueText = input.closest('label')!.querySelector('output')!.value = text;
    };
    say(this.#size, `${(100 * this.size).toFixed(1)} %`);
    say(this.#hardness, `${this.#hardness.value} %`);
    say(this.#opacity, `${this.#opacity.value} %`);
    say(this.#turn, `${this.#turn.value}°`);
  }
}
