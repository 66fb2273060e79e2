import { Emitter, type PaintingSize, paintingSizes } from '#three';
import { element } from '../../platform/page';
import { brushPixels } from './ring';

/** The painting tools; each shows its own options. */
export type Kind = 'brush' | 'eraser' | 'sticker' | 'fill';

// The range of the slider for stickers, in shares of the diagonal of the cage.
const kMinSize = 0.004;
const kMaxSize = 0.4;
const kSizeStep = 4; // of the slider, for a key

/** The options of a sticker. */
interface StickerOptions {
  text: string;
  color: string;
  outlined: boolean;
  size: number;
  angle: number;
  opacity: number;
  mirrored: boolean;
}

/** What an option changes of a sticker. */
type StickerField = 'size' | 'angle' | 'opacity' | 'mirrored' | 'picture';

/** The tool options below the list of layers. */
export class PaintOptions extends Emitter<{
  /** The user changed an option of stickers, and has let go of it if `ended`. */
  sticker: { field: StickerField | undefined; ended: boolean };
}> {
  readonly #slot = element('tool-options', HTMLElement);
  readonly #color = element('brush-color', HTMLInputElement);
  readonly #size = element('brush-size', HTMLInputElement);
  readonly #hardness = element('brush-hardness', HTMLInputElement);
  readonly #opacity = element('brush-opacity', HTMLInputElement);
  readonly #mirror = element('brush-mirror', HTMLInputElement);
  readonly #text = element('sticker-text', HTMLInputElement);
  readonly #turn = element('sticker-turn', HTMLInputElement);
  readonly #outline = element('sticker-outline', HTMLInputElement);
  readonly #flip = element('sticker-flip', HTMLInputElement);
  /** Texture size of the painting, in texels per side. */
  texels: PaintingSize = paintingSizes[0];
  #kind: Kind | undefined;
  /** The size of what is not chosen: a legible sticker is far larger than a brush. */
  #otherSize = '85';
  /** Whether fields change that the user did not touch. */
  #writing = false;

  constructor() {
    super();
    for (const input of this.#slot.querySelectorAll('input')) input.addEventListener('input', () => this.#label());
    const fields = new Map<EventTarget | null, StickerField>([
      [this.#size, 'size'],
      [this.#turn, 'angle'],
      [this.#opacity, 'opacity'],
      [this.#flip, 'mirrored'],
      ...[this.#color, this.#text, this.#outline].map((input) => [input, 'picture'] as const),
    ]);
    const report = (target: EventTarget | null, ended: boolean): void => {
      if (this.#kind === 'sticker' && !this.#writing) this.emit('sticker', { field: fields.get(target), ended });
    };
    // The controls beside the rail pass on what is typed, but not that it ended.
    for (const box of [this.#slot, element('quick-paint', HTMLElement)]) {
      box.addEventListener('input', ({ target }) => report(target, false));
      box.addEventListener('change', ({ target }) => report(target, true));
    }
    this.#label();
  }

  /** #rrggbb */
  get color(): string {
    return this.#color.value;
  }

  /** The brush's diameter in pixels of the screen; the longer side of a sticker as a share of the diagonal of the cage. */
  get size(): number {
    const place = this.#size.valueAsNumber;
    return this.#kind === 'sticker' ? kMinSize * (kMaxSize / kMinSize) ** (place / 100) : brushPixels(place);
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

  get text(): string {
    return this.#text.value;
  }

  set text(text: string) {
    this.#text.value = text;
  }

  /** The colour around the letters of a sticker, which stands out from theirs. */
  get outline(): string | undefined {
    if (!this.#outline.checked) return undefined;
    const [red, green, blue] = [1, 3, 5].map((at) => Number.parseInt(this.color.slice(at, at + 2), 16) / 255);
    return 0.3 * red! + 0.6 * green! + 0.1 * blue! > 0.55 ? '#1b1b1b' : '#ffffff';
  }

  /** Radians, clockwise. */
  get angle(): number {
    return (Number(this.#turn.value) * Math.PI) / 180;
  }

  /** Whether a sticker is seen as in a mirror. */
  get mirrored(): boolean {
    return this.#flip.checked;
  }

  /** Sets the colour, as if the user did. */
  setColor(color: string): void {
    this.#color.value = color;
    for (const type of ['input', 'change']) this.#color.dispatchEvent(new Event(type, { bubbles: true }));
  }

  /** Makes the size a step larger or smaller, as if the user did. */
  stepSize(steps: 1 | -1): void {
    this.#size.valueAsNumber += steps * kSizeStep;
    for (const type of ['input', 'change']) this.#size.dispatchEvent(new Event(type, { bubbles: true }));
  }

  /** Shows a sticker that was chosen. */
  write({ text, color, outlined, size, angle, opacity, mirrored }: Partial<StickerOptions>): void {
    this.#writing = true;
    if (text !== undefined) this.#text.value = text;
    if (color !== undefined) this.#color.value = color;
    if (outlined !== undefined) this.#outline.checked = outlined;
    if (mirrored !== undefined) this.#flip.checked = mirrored;
    if (size !== undefined)
      this.#size.valueAsNumber = (100 * Math.log(size / kMinSize)) / Math.log(kMaxSize / kMinSize);
    if (opacity !== undefined) this.#opacity.valueAsNumber = 100 * opacity;
    if (angle !== undefined) this.#turn.valueAsNumber = (((180 * angle) / Math.PI + 540 + 3600) % 360) - 180;
    for (const input of [this.#color, this.#size]) input.dispatchEvent(new Event('input', { bubbles: true }));
    this.#label();
    this.#writing = false;
  }

  /** Shows the options of one tool, or of none. */
  show(kind: Kind | undefined): void {
    this.#slot.hidden = kind === undefined;
    for (const part of this.#slot.querySelectorAll<HTMLElement>('[data-for]'))
      part.hidden = !part.dataset.for!.split(' ').includes(kind ?? '');
    const before = this.#kind;
    this.#kind = kind;
    if ((kind === 'sticker') === (before === 'sticker')) return;
    [this.#size.value, this.#otherSize] = [this.#otherSize, this.#size.value];
    this.#writing = true;
    this.#size.dispatchEvent(new Event('input', { bubbles: true }));
    this.#writing = false;
  }

  #label(): void {
    const say = (input: HTMLInputElement, text: string): void => {
      input.ariaValueText = input.closest('label')!.querySelector('output')!.value = text;
    };
    say(this.#size, this.#kind === 'sticker' ? `${(100 * this.size).toFixed(1)} %` : `${Math.round(this.size)} px`);
    say(this.#hardness, `${this.#hardness.value} %`);
    say(this.#opacity, `${this.#opacity.value} %`);
    say(this.#turn, `${this.#turn.value}°`);
  }
}
