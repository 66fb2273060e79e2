import { type Face, onFace } from '../platform/face';
import { element } from '../platform/page';
import type { Tool } from './pointing';
import type { Viewer } from './viewer';

/** A tool on the rail beside the view. */
export interface RailTool {
  /** One word. */
  title: string;
  /** The key that chooses it while the view has the focus. */
  key: string;
  /** SVG path data of its icon: lines in a 24 × 24 box. */
  icon: string;
  tool: Tool;
  /** The only face of the page that has it; by default both do. */
  face?: Face;
  /** Called when it is chosen (true) or another one is; shows or hides its options. */
  onChoose(chosen: boolean): void;
}

/** The rail of tools for the pointer on the model. Turning the model is the first entry and the default. */
export class Tools {
  readonly #rail = element('tools', HTMLElement);
  readonly #viewer: Viewer;
  readonly #railTools: { offer: RailTool | undefined; input: HTMLInputElement }[] = [];
  #chosen: RailTool | undefined;

  constructor(viewer: Viewer, stage: HTMLElement) {
    this.#viewer = viewer;
    onFace((face) => {
      if (this.#chosen?.face && this.#chosen.face !== face) this.choose(undefined);
    });
    this.#add(undefined, 'Turn', 't', 'M20 12a8 8 0 1 1-2.6-5.9M20 3v4h-4');
    stage.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === 'Escape') return this.choose(undefined);
      const found = this.#railTools.find(({ input }) => input.dataset.key === event.key.toLowerCase());
      if (found && found.input.closest('label')!.checkVisibility()) this.choose(found.offer);
    });
  }

  /** The chosen tool; undefined while the pointer turns the model. */
  get chosen(): RailTool | undefined {
    return this.#chosen;
  }

  /** Appends a tool. */
  add(offer: RailTool): void {
    this.#add(offer, offer.title, offer.key, offer.icon);
    this.#rail.hidden = false;
  }

  /** Offers a tool or not. */
  offer(offer: RailTool, on: boolean): void {
    const found = this.#railTools.find((other) => other.offer === offer);
    if (!found && on) this.add(offer);
    else if (found) found.input.closest('label')!.hidden = !on;
    if (!on && this.#chosen === offer) this.choose(undefined);
  }

  /** Chooses a tool; undefined turns the model. */
  choose(offer: RailTool | undefined): void {
    for (const { offer: other, input } of this.#railTools) input.checked = other === offer;
    if (offer === this.#chosen) return;
    this.#chosen?.onChoose(false);
    this.#chosen = offer;
    this.#viewer.pointing.tool = offer?.tool;
    if (offer) this.#viewer.controls.sway(false);
    offer?.onChoose(true);
  }

  #add(offer: RailTool | undefined, title: string, key: string, icon: string): void {
    const label = document.createElement('label');
    if (offer?.face) label.dataset.in = offer.face;
    label.title = `${title} (${key.toUpperCase()})`;
    label.innerHTML =
      `<input type="radio" name="tool"><span><svg viewBox="0 0 24 24" aria-hidden="true" focusable="false"><path d="${icon}"/></svg>` +
      `<b></b></span>`;
    label.querySelector('b')!.textContent = title;
    const input = label.querySelector('input')!;
    input.dataset.key = key;
    input.checked = offer === undefined;
    input.addEventListener('change', () => this.choose(offer));
    this.#railTools.push({ offer, input });
    this.#rail.append(label);
  }
}
