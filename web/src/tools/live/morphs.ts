import { make } from '../../platform/make';
import { element } from '../../platform/page';
import type { ExtractedMesh } from '../../state/model';
import { ExpressionButtons } from './expression-buttons';
import { titleOfMorph } from './expression-names';
import type { Expression } from './expressions';
import { morphNames, type Weights } from './morph-names';

/** Buttons for the expressions of a model, and a slider for each of its morphs. */
export class Morphs {
  readonly #box = element('morphs', HTMLElement);
  readonly #fold = element('morph-fold', HTMLDetailsElement);
  readonly #list = element('morph-list', HTMLElement);
  readonly #buttons: ExpressionButtons;
  readonly #reset = element('morphs-reset', HTMLButtonElement);
  readonly #onMove: () => void;
  /** The weights in the file. */
  #stored: Weights = new Map();
  #weights = new Map<string, number>();

  /** @param onMove Called when the user moved a slider, and for each step of an expression. */
  constructor(onMove: () => void) {
    this.#onMove = onMove;
    this.#buttons = new ExpressionButtons((weights) => {
      this.#set(weights);
      onMove();
    });
    this.#reset.addEventListener('click', () => {
      this.reset();
      // The button is disabled now: keep the focus within the morphs.
      this.#fold.querySelector('summary')!.focus({ preventScroll: true });
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
    this.#buttons.offer(expressions, stored);
    this.#fold.open = expressions.length === 0;
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
    this.#set(weights);
    this.#buttons.release(this.moved);
  }

  #set(weights: Weights): void {
    for (const input of this.#list.querySelectorAll('input')) {
      const weight = weights.get(input.name);
      if (weight === undefined) continue;
      input.valueAsNumber = weight;
      this.#read(input);
    }
  }

  #slider(name: string, weight: number): HTMLElement {
    const [min, max] = [String(Math.min(0, weight)), String(Math.max(1, weight))];
    const input = make('input', { type: 'range', name, min, max, step: 'any' });
    input.valueAsNumber = weight;
    const title = make('span', { title: name }, titleOfMorph(name));
    const label = make('label', {}, title, input, make('output', { value: weight.toFixed(2) }));
    input.addEventListener('input', () => {
      this.#buttons.release();
      this.#read(input);
      this.#onMove();
    });
    return label;
  }

  #read(input: HTMLInputElement): void {
    this.#weights.set(input.name, input.valueAsNumber);
    (input.nextElementSibling as HTMLOutputElement).value = input.valueAsNumber.toFixed(2);
    this.#reset.disabled = !this.weights;
  }
}
