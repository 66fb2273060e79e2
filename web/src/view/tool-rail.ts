import { element } from '../platform/page';
import type { Tool } from './pointing';
import type { Viewer } from './viewer';

/** A tool that can be chosen on the rail beside the picture. */
export interface Offer {
  /** For people and screen readers, one word. */
  title: string;
  /** The one key that chooses it while the picture has the keyboard. */
  key: string;
  /** Path data of its icon, drawn with lines in a square of 24. */
  icon: string;
  tool: Tool;
  /** It was chosen (true), or another was: shows or hides its options. */
  onChoose(chosen: boolean): void;
}

/** The rail of tools: what a pointer on the model does. Turning it comes first, and is what the rail begins and ends with. */
export class Tools {
  readonly #rail = element('tools', HTMLElement);
  readonly #viewer: Viewer;
  readonly #offers: { offer: Offer | undefined; input: HTMLInputElement }[] = [];
  #chosen: Offer | undefined;

  constructor(viewer: Viewer, stage: HTMLElement) {
    this.#viewer = viewer;
    this.#add(undefined, 'Turn', 't', 'M20 12a8 8 0 1 1-2.6-5.9M20 3v4h-4');
    stage.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === 'Escape') return this.choose(undefined);
      const found = this.#offers.find(({ input }) => input.dataset.key === event.key.toLowerCase());
      if (found) this.choose(found.offer);
    });
  }

  /** The tool that is chosen; undefined while the pointer turns the model. */
  get chosen(): Offer | undefined {
    return this.#chosen;
  }

  /** Adds a tool at the rail's end. */
  add(offer: Offer): void {
    this.#add(offer, offer.title, offer.key, offer.icon);
    this.#rail.hidden = false;
  }

  /** Chooses a tool, or to turn the model. */
  choose(offer: Offer | undefined): void {
    for (const { offer: other, input } of this.#offers) input.checked = other === offer;
    if (offer === this.#chosen) return;
    this.#chosen?.onChoose(false);
    this.#chosen = offer;
    this.#viewer.setTool(offer?.tool);
    offer?.onChoose(true);
  }

  #add(offer: Offer | undefined, title: string, key: string, icon: string): void {
    const label = document.createElement('label');
    label.title = `${title} (${key.toUpperCase()})`;
    label.innerHTML =
      `<input type="radio" name="tool"><span><svg viewBox="0 0 24 24" aria-hidden="true" focusable="false"><path d="${icon}"/></svg>` +
      `<b></b></span>`;
    label.querySelector('b')!.textContent = title;
    const input = label.querySelector('input')!;
    input.dataset.key = key;
    input.checked = offer === undefined;
    input.addEventListener('change', () => this.choose(offer));
    this.#offers.push({ offer, input });
    this.#rail.append(label);
  }
}
