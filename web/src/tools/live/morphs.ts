import { make } from '../../platform/make';
import { element } from '../../platform/page';
import type { ExtractedMesh } from '../../state/model';
import { titleOfMorph } from './expression-names';
import type { Expression } from './expressions';
import { morphNames, type Weights } from './morph-names';

/** A slider for each morph of a model. */
export class Morphs {
  readonly #box = element('morphs', HTMLElement);
  readonly #list = element('morph-list', HTMLElement);
  readonly #presets = element('expressions', HTMLElement);
  readonly #reset = element('morphs-reset', HTMLButtonElement);
  readonly #onMove: () => void;
  /** The weights in the file. */
  #stored: Weights = new Map();
  #weights = new Map<string, number>();

  /** @param onMove Called when the user moved a slider. */
  constructor(onMove: () => void) {
    this.#onMove = onMove;
    this.#reset.addEventListener('click', () => {
      this.reset();
      // The button is disabled now: keep the focus within the morphs.
      this.#list.querySelector('input')?.focus({ preventScroll: true });
      onMove();
    });
  }

  /** Lists the morphs of a model at rest, and the expressions of its file. */
  offer({ primitives }: ExtractedMesh, expressions: readonly Expression[]): void {
    const stored = new Map<string, number>();
    for (const { mesh } of primitives) {
      morphNames(mesh).forEach((name, place) => {
        if (!stored.get(name)) stored.set(name, mesh.morphTargetInfluences![place]!);
      });
    }
    this.#stored = stored;
    this.#weights = new Map(stored);
    this.#list.replaceChildren(...[...stored].map(([name, weight]) => this.#slider(name, weight)));
    this.#offerPresets(expressions);
    this.#box.hidden = stored.size === 0;
    element('morph-count', HTMLElement).textContent = String(stored.size);
    this.#reset.disabled = true;
  }

  /** The current weights; undefined while they equal the file's. */
  get weights(): Weights | undefined {
    return this.moved.size > 0 ? new Map(this.#weights) : undefined;
  }

  /** The weights that differ from the file's. */
  get moved(): Weights {
    return new Map([...this.#weights].filter(([name, weight]) => this.#stored.get(name) !== weight));
  }

  /** Restores the file's weights. */
  reset(): void {
    this.move(this.#stored);
  }

  /** Sets the named weights, clamped to the range of their sliders. */
  move(weights: Weights): void {
    for (const input of this.#list.querySelectorAll('input')) {
      const weight = weights.get(input.name);
      if (weight === undefined) continue;
      input.valueAsNumber = weight;
      this.#read(input);
    }
  }

  /** A button for each expression, which shows it instead of any other. */
  #offerPresets(expressions: readonly Expression[]): void {
    this.#presets.hidden = expressions.length === 0;
    this.#presets.replaceChildren(
      ...expressions.map(({ title, weights }) => {
        const button = make('button', { type: 'button', ariaPressed: 'false' }, title);
        button.addEventListener('click', () => {
          const on = button.ariaPressed !== 'true';
          const rest = expressions.flatMap((other) => [...other.weights.keys()].map((name) => [name, 0] as const));
          this.move(new Map([...rest, ...(on ? weights : [])]));
          button.ariaPressed = String(on);
          this.#onMove();
        });
        return button;
      }),
    );
  }

  #slider(name: string, weight: number): HTMLElement {
    const [min, max] = [String(Math.min(0, weight)), String(Math.max(1, weight))];
    const input = make('input', { type: 'range', name, min, max, step: 'any' });
    input.valueAsNumber = weight;
    const title = make('span', { title: name }, titleOfMorph(name));
    const label = make('label', {}, title, input, make('output', { value: weight.toFixed(2) }));
    input.addEventListener('input', () => {
      this.#read(input);
      this.#onMove();
    });
    return label;
  }

  #read(input: HTMLInputElement): void {
    for (const button of this.#presets.children) button.ariaPressed = 'false';
    this.#weights.set(input.name, input.valueAsNumber);
    (input.nextElementSibling as HTMLOutputElement).value = input.valueAsNumber.toFixed(2);
    this.#reset.disabled = !this.weights;
  }
}
