import { make } from '../../platform/make';
import { element } from '../../platform/page';
import type { PaintOptions } from './paint-options';

const kMax = 8;
const kKey = 'cagecast-colors';
const kFirst = ['#d81b60', '#111111', '#ffffff', '#e53935', '#fb8c00', '#fdd835', '#43a047', '#1e88e5'];

/** Buttons for the colours that were painted with last. */
export class Swatches {
  readonly #box = element('swatches', HTMLElement);
  #colors: string[] = stored();

  constructor(private readonly options: PaintOptions) {
    this.#show();
  }

  /** Puts a colour first: it was painted with. */
  use(color: string): void {
    if (this.#colors[0] === color) return;
    this.#colors = [color, ...this.#colors.filter((other) => other !== color)].slice(0, kMax);
    try {
      localStorage.setItem(kKey, JSON.stringify(this.#colors));
    } catch {
      // Not allowed: they last as long as the page.
    }
    this.#show();
  }

  #show(): void {
    this.#box.replaceChildren(
      ...this.#colors.map((color) => {
        const button = make('button', { type: 'button', title: color, ariaLabel: color });
        button.style.setProperty('--color', color);
        button.addEventListener('click', () => this.options.setColor(color));
        return button;
      }),
    );
  }
}

function stored(): string[] {
  try {
    const colors: unknown = JSON.parse(localStorage.getItem(kKey) ?? 'null');
    if (Array.isArray(colors) && colors.every((color) => /^#[0-9a-f]{6}$/.test(color))) return colors.slice(0, kMax);
  } catch {
    // As if there were none.
  }
  return kFirst;
}
