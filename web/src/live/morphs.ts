import type { Mesh } from 'three';
import { element } from '../platform/page';
import type { ExtractedMesh } from '../scene/extract';

/** How far morphs are carried out, by name; those that are not in it are not. Meshes that have one of that name follow it together. */
export type Weights = ReadonlyMap<string, number>;

/** What a mesh's morphs are called, in their order; one without a name of its own by its number. */
export function morphNames({ morphTargetDictionary, morphTargetInfluences = [] }: Mesh): string[] {
  const names = new Map(Object.entries(morphTargetDictionary ?? {}).map(([name, place]) => [place, name]));
  // The loader calls those by their number, from 0, that the file says nothing of.
  return morphTargetInfluences.map((_, place) =>
    /^\d*$/.test(names.get(place) ?? '') ? `Morph ${place + 1}` : names.get(place)!,
  );
}

/** Lets a model's morphs be moved: a slider for each name. */
export class Morphs {
  readonly #box = element('morphs', HTMLElement);
  readonly #list = element('morph-list', HTMLElement);
  readonly #reset = element('morphs-reset', HTMLButtonElement);
  readonly #onMove: () => void;
  /** Where the file has them. */
  #stored: Weights = new Map();
  #weights = new Map<string, number>();

  /** @param onMove Is called when the visitor moved one. */
  constructor(onMove: () => void) {
    this.#onMove = onMove;
    this.#reset.addEventListener('click', () => {
      this.reset();
      // Nothing is left for the button to do, but the keyboard is to stay with the morphs.
      this.#list.querySelector('input')?.focus({ preventScroll: true });
      onMove();
    });
  }

  /** Offers those of a model, which is as its file has it. */
  offer({ parts }: ExtractedMesh): void {
    const stored = new Map<string, number>();
    for (const { mesh } of parts) {
      morphNames(mesh).forEach((name, place) => {
        if (!stored.get(name)) stored.set(name, mesh.morphTargetInfluences![place]!);
      });
    }
    this.#stored = stored;
    this.#weights = new Map(stored);
    this.#list.replaceChildren(...[...stored].map(([name, weight]) => this.#slider(name, weight)));
    this.#box.hidden = stored.size === 0;
    element('morph-count', HTMLElement).textContent = String(stored.size);
    this.#reset.disabled = true;
  }

  /** Where the visitor has them; undefined while that is where the file has them. */
  get weights(): Weights | undefined {
    return this.moved.size > 0 ? new Map(this.#weights) : undefined;
  }

  /** Those that are not where the file has them. */
  get moved(): Weights {
    return new Map([...this.#weights].filter(([name, weight]) => this.#stored.get(name) !== weight));
  }

  /** Puts them where the file has them. */
  reset(): void {
    this.move(this.#stored);
  }

  /** Moves those that are named, as far as they go. */
  move(weights: Weights): void {
    for (const input of this.#list.querySelectorAll('input')) {
      const weight = weights.get(input.name);
      if (weight === undefined) continue;
      input.valueAsNumber = weight;
      this.#take(input);
    }
  }

  #slider(name: string, weight: number): HTMLElement {
    const label = document.createElement('label');
    const [title, input, output] = [
      document.createElement('span'),
      document.createElement('input'),
      document.createElement('output'),
    ];
    title.textContent = title.title = name;
    Object.assign(input, {
      type: 'range',
      name,
      min: String(Math.min(0, weight)),
      max: String(Math.max(1, weight)),
      step: 'any',
    });
    input.valueAsNumber = weight;
    output.value = weight.toFixed(2);
    label.append(title, input, output);
    input.addEventListener('input', () => {
      this.#take(input);
      this.#onMove();
    });
    return label;
  }

  #take(input: HTMLInputElement): void {
    this.#weights.set(input.name, input.valueAsNumber);
    (input.nextElementSibling as HTMLOutputElement).value = input.valueAsNumber.toFixed(2);
    this.#reset.disabled = !this.weights;
  }
}
