import { type Blend, blendModes, type Edits, type Layer, type LayerStack, maxLayers, type Style } from '#three';
import { pictureOf } from '../loading/samples';
import { announce, element } from '../platform/page';

// One transparent pixel.
const kNoPicture = 'data:image/gif;base64,R0lGODlhAQABAAAAACH5BAEKAAEALAAAAAABAAEAAAICTAEAOw==';

const kBlendTitles: Record<Blend, string> = { normal: 'Normal', multiply: 'Multiply', screen: 'Screen', add: 'Add' };

const kRow = `
  <button type="button" class="grip" name="move"><svg viewBox="0 0 24 24" aria-hidden="true" focusable="false"><path d="M9 6h.01M15 6h.01M9 12h.01M15 12h.01M9 18h.01M15 18h.01"/></svg></button>
  <button type="button" class="choose" name="choose"><img alt="" /><span class="name"></span></button>
  <label class="eye"><input type="checkbox" name="visible" /><svg viewBox="0 0 24 24" aria-hidden="true" focusable="false"><path d="M2 12s4-6 10-6 10 6 10 6-4 6-10 6S2 12 2 12z"/><circle cx="12" cy="12" r="3"/></svg></label>
  <button type="button" class="remove" name="remove"><svg viewBox="0 0 24 24" aria-hidden="true" focusable="false"><path d="M6 6l12 12M18 6 6 18"/></svg></button>
  <div class="style">
    <label class="field"><span>Opacity <output></output></span><input type="range" name="opacity" min="0" max="100" /></label>
    <label class="field"><span>Blending</span><select name="blend"></select></label>
    <label class="field"><span>Tint</span><input type="color" name="tint" /></label>
  </div>`;

/** One layer of the list, and its controls. */
interface Row {
  item: HTMLLIElement;
  show(layer: Layer, selected: boolean): void;
}

/** The list of layers, the uppermost first, with their styles; rows can be dragged to reorder. */
export class LayerList {
  readonly #stack: LayerStack;
  readonly #edits: Edits;
  readonly #list = element('layer-list', HTMLOListElement);
  readonly #rows = new Map<number, Row>();
  #dragged: Layer | undefined;
  /** The layer whose style is being changed. */
  #restyled: number | undefined;

  constructor(stack: LayerStack, edits: Edits) {
    this.#stack = stack;
    this.#edits = edits;
    for (const event of ['change', 'select', 'pictures'] as const) stack.on(event, () => this.#show());
    // On the list, not on the row: a row that moves would lose the pointer.
    this.#list.addEventListener('pointermove', (event) => this.#drag(event));
    for (const end of ['pointerup', 'pointercancel'] as const) this.#list.addEventListener(end, () => this.#drop());
    const texture = element('texture-input', HTMLInputElement);
    element('add-image', HTMLButtonElement).addEventListener('click', () => texture.click());
    this.#show();
  }

  #show(): void {
    const { layers, selected } = this.#stack;
    for (const [id, { item }] of this.#rows) {
      if (layers.some((layer) => layer.id === id)) continue;
      item.remove();
      this.#rows.delete(id);
      // Its controls are gone and cannot end the edit any more.
      if (this.#dragged?.id === id) this.#drop();
      if (this.#restyled === id) this.#endRestyle('style');
    }
    const focused = document.activeElement;
    const items = layers.toReversed().map((layer) => {
      const row = this.#rows.get(layer.id) ?? this.#makeRow(layer.id);
      row.show(layer, layer === selected);
      return row.item;
    });
    if (items.some((item, index) => this.#list.children[index] !== item)) {
      this.#list.replaceChildren(...items);
      // Moving an element in the document drops its focus.
      if (focused instanceof HTMLElement && this.#list.contains(focused)) focused.focus({ preventScroll: true });
    }
    this.#list.hidden = items.length === 0;
    element('layer-count', HTMLElement).textContent = `${layers.length} of ${maxLayers}`;
    for (const name of ['add-image', 'add-painting']) element(name, HTMLButtonElement).disabled = this.#stack.full;
  }

  /** Ends the undo step of a style change. */
  #endRestyle(what: string): void {
    const { name } = this.#stack.layers.find(({ id }) => id === this.#restyled) ?? { name: 'a layer' };
    this.#restyled = undefined;
    this.#edits.end(`changing the ${what} of ${name}`);
  }

  #layerOf(id: number): Layer {
    return this.#stack.layers.find((layer) => layer.id === id)!;
  }

  #makeRow(id: number): Row {
    const item = document.createElement('li');
    item.className = 'layer';
    item.innerHTML = kRow;
    const controls = controlsOf(item);
    for (const name of blendModes) controls.blend.add(new Option(kBlendTitles[name], name));
    controls.choose.addEventListener('click', () => this.#stack.select(this.#layerOf(id)));
    controls.remove.addEventListener('click', () => this.#remove(id));
    this.#connectStyle(id, controls);
    this.#connectGrip(id, item, controls.grip);
    const row: Row = { item, show: (layer, selected) => showLayer(item, controls, layer, selected) };
    this.#rows.set(id, row);
    return row;
  }

  #connectStyle(id: number, { visible, opacity, tint, blend }: Controls): void {
    // A drag sends many changes; the edit ends with it.
    const restyle = (style: Partial<Style>): void => {
      if (!this.#rows.has(id)) return;
      this.#restyled = id;
      this.#edits.begin();
      this.#stack.restyle(this.#layerOf(id), style);
    };
    visible.addEventListener('change', () => {
      restyle({ visible: visible.checked });
      this.#endRestyle('visibility');
      announce(`${this.#layerOf(id).name} ${visible.checked ? 'shown' : 'hidden'}.`);
    });
    opacity.addEventListener('input', () => restyle({ opacity: Number(opacity.value) / 100 }));
    tint.addEventListener('input', () => restyle({ tint: tint.value }));
    blend.addEventListener('input', () => restyle({ blend: blend.value as Blend }));
    for (const [control, what] of [
      [opacity, 'opacity'],
      [tint, 'tint'],
      [blend, 'blending'],
    ] as const) {
      // Browsers send no `change` if the control ends where it began.
      for (const end of ['change', 'pointerup', 'pointercancel', 'blur'] as const)
        control.addEventListener(end, () => this.#restyled === id && this.#endRestyle(what));
    }
  }

  #connectGrip(id: number, item: HTMLElement, grip: HTMLElement): void {
    grip.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      this.#dragged = this.#layerOf(id);
      this.#edits.begin();
      this.#list.setPointerCapture(event.pointerId);
      item.classList.add('dragged');
    });
    grip.addEventListener('keydown', (event) => {
      const steps: Record<string, number> = { ArrowUp: 1, ArrowDown: -1 };
      const step = steps[event.key];
      if (step === undefined) return;
      event.preventDefault();
      const layer = this.#layerOf(id);
      this.#edits.do(`moving ${layer.name}`, () => this.#move(layer, this.#stack.layers.indexOf(layer) + step));
    });
  }

  #remove(id: number): void {
    const layer = this.#layerOf(id);
    const place = this.#stack.layers.length - 1 - this.#stack.layers.indexOf(layer);
    this.#edits.do(`removing ${layer.name}`, () => this.#stack.remove(id));
    announce(`${layer.name} removed.`);
    // Focus the row that took its place.
    const next = this.#list.children[Math.min(place, this.#list.children.length - 1)] ?? this.#list.parentElement!;
    next.querySelector<HTMLElement>('[name=remove], button:enabled')?.focus();
  }

  #move(layer: Layer, place: number): void {
    const { layers } = this.#stack;
    if (place < 0 || place >= layers.length || layers[place]!.id === layer.id) return;
    this.#stack.move(layer, place);
    announce(`${layer.name} is now number ${layers.length - place} of ${layers.length} from the top.`);
  }

  /** Swaps with a neighbour once the pointer is past its middle. */
  #drag({ clientY }: PointerEvent): void {
    if (!this.#dragged) return;
    const { layers } = this.#stack;
    const place = layers.findIndex(({ id }) => id === this.#dragged!.id);
    const middleOf = (neighbour: Layer | undefined): number => {
      if (!neighbour) return NaN;
      const { top, bottom } = this.#rows.get(neighbour.id)!.item.getBoundingClientRect();
      return (top + bottom) / 2;
    };
    if (clientY < middleOf(layers[place + 1])) this.#move(this.#dragged, place + 1);
    else if (clientY > middleOf(layers[place - 1])) this.#move(this.#dragged, place - 1);
  }

  #drop(): void {
    if (!this.#dragged) return;
    this.#rows.get(this.#dragged.id)?.item.classList.remove('dragged');
    this.#edits.end(`moving ${this.#dragged.name}`);
    this.#dragged = undefined;
  }
}

function controlsOf(item: HTMLElement) {
  const control = <T extends HTMLElement>(name: string): T => item.querySelector<T>(`[name=${name}]`)!;
  return {
    grip: control<HTMLButtonElement>('move'),
    choose: control<HTMLButtonElement>('choose'),
    remove: control<HTMLButtonElement>('remove'),
    visible: control<HTMLInputElement>('visible'),
    opacity: control<HTMLInputElement>('opacity'),
    tint: control<HTMLInputElement>('tint'),
    blend: control<HTMLSelectElement>('blend'),
  };
}

type Controls = ReturnType<typeof controlsOf>;

function showLayer(item: HTMLElement, controls: Controls, layer: Layer, selected: boolean): void {
  const { grip, choose, remove, visible, opacity, tint, blend } = controls;
  const { name } = layer;
  item.classList.toggle('selected', selected);
  item.querySelector('img')!.src = layer.sheet.picture ? pictureOf(layer.sheet.picture) : kNoPicture;
  item.querySelector('.name')!.textContent = choose.title = name;
  choose.translate = !name.includes('.'); // the names of files are their owner's
  choose.setAttribute('aria-pressed', String(selected));
  grip.setAttribute('aria-label', `Reorder ${name} with the up and down keys`);
  remove.setAttribute('aria-label', `Remove ${name}`);
  visible.setAttribute('aria-label', `Show ${name}`);
  opacity.setAttribute('aria-label', `Opacity of ${name}`);
  tint.setAttribute('aria-label', `Tint of ${name}`);
  blend.setAttribute('aria-label', `Blending of ${name}`);
  visible.checked = layer.visible;
  opacity.value = String(Math.round(100 * layer.opacity));
  opacity.ariaValueText = item.querySelector('output')!.value = `${opacity.value} %`;
  tint.value = layer.tint;
  blend.value = layer.blend;
  item.querySelector<HTMLElement>('.style')!.hidden = !selected;
}
