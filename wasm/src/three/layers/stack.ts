import type { CagecastError } from '../../api/index.js';
import { maxLayers } from '../../gltf/look/saved-layers.js';
import { notA, wrong } from '../errors.js';
import { Emitter } from './emitter.js';
import { checkTexture, difference, type Layer, plainStyle, readStyle, type Sheet, type Style } from './layer.js';

/** @returns the error for a layer too many. */
const full = (): CagecastError => wrong(`There are already ${maxLayers} layers, the maximum. Remove one first.`, '');

export interface StackEvents {
  /** Layers were added, removed, moved or restyled. */
  change: readonly Layer[];
  /** Only thumbnails changed. */
  pictures: readonly Layer[];
  /** Another layer was selected, or none. */
  select: Layer | undefined;
}

/** Up to `maxLayers` layers of paint, from the lowest to the uppermost. It is kept when the model changes. @internal */
export class LayerStack extends Emitter<StackEvents> {
  #layers: readonly Layer[] = [];
  #selected: number | undefined;
  /** The ids of all base layers so far, also of those that were removed: undo may bring them back. */
  readonly #bases: number[] = [];
  #lastId = 0;

  get layers(): readonly Layer[] {
    return this.#layers;
  }

  /** The selected layer. */
  get selected(): Layer | undefined {
    return this.#layers.find(({ id }) => id === this.#selected);
  }

  get full(): boolean {
    return this.#layers.length >= maxLayers;
  }

  /** Sets the base layer, in place of the previous one. */
  setBase(name: string, sheet: Sheet): void {
    const { base } = this;
    if (base) {
      this.#replace({ ...base, name, sheet, visible: true });
      return;
    }
    if (this.full) throw full();
    const layer = this.#make(name, sheet, {}, 0);
    this.#bases.push(layer.id);
    this.select(layer);
  }

  /** The layer with the model's own paint, unless it was removed; the newest one if there are several. */
  get base(): Layer | undefined {
    return this.#bases.flatMap((base) => this.#layers.filter(({ id }) => id === base)).at(-1);
  }

  /** Adds a layer on top and selects it. @throws {CagecastError} if there are `maxLayers` already, or the style is wrong. */
  add(name: string, sheet: Sheet, style: Partial<Style> = {}): Layer {
    if (this.full) throw full();
    const layer = this.#make(name, sheet, style, this.#layers.length);
    this.select(layer);
    return layer;
  }

  /** Removes a layer. */
  remove(id: number): void {
    const index = this.#indexOf({ id });
    this.#set(this.#layers.filter((_, i) => i !== index));
    if (this.#selected === id) this.select(this.#layers[Math.min(index, this.#layers.length - 1)]);
  }

  /**
   * Applies the difference between two states of the stack to the current one, and selects the first layer it concerns.
   * Whatever is equal in both states stays as it is now.
   * @throws {CagecastError} if there would be more than `maxLayers`.
   */
  change(from: readonly Layer[], to: readonly Layer[]): void {
    const find = (layers: readonly Layer[], { id }: Layer): Layer | undefined =>
      layers.find((layer) => layer.id === id);
    let concerned: Layer | undefined;
    const layers = to.flatMap((layer) => {
      const [before, now] = [find(from, layer), find(this.#layers, layer)];
      if (before && !now) return []; // removed since: stays removed
      const change = before ? difference(before, layer) : {};
      if (!before || Object.keys(change).length > 0) concerned ??= layer;
      return [{ ...(now ?? layer), ...change }];
    });
    // Layers added since stay.
    this.#layers.forEach((layer, place) => {
      if (!find(from, layer) && !find(to, layer)) layers.splice(place, 0, layer);
    });
    if (layers.length > maxLayers) throw full();
    const place = this.#layers.findIndex(({ id }) => id === this.#selected);
    this.#set(layers);
    this.select(concerned ?? this.selected ?? layers[Math.min(place, layers.length - 1)]);
  }

  /** Moves a layer. @param place From 0, the lowest; what is out of range is clamped. */
  move(layer: Pick<Layer, 'id'>, place: number): void {
    const from = this.#indexOf(layer);
    if (!Number.isInteger(place)) throw notA('an integer', 'the place of a layer', place);
    const to = Math.max(0, Math.min(this.#layers.length - 1, place));
    if (from === to) return;
    const layers = [...this.#layers];
    layers.splice(to, 0, ...layers.splice(from, 1));
    this.#set(layers);
  }

  /** Changes a layer's style. */
  restyle(layer: Pick<Layer, 'id'>, style: Partial<Style>): void {
    const change = readStyle(style);
    this.#replace({ ...this.#layers[this.#indexOf(layer)]!, ...change });
  }

  select(layer: Layer | undefined): void {
    if (layer?.id === this.#selected) return;
    this.#selected = layer?.id;
    this.emit('select', this.selected);
  }

  /** Announces new thumbnails. */
  pictured(): void {
    this.emit('pictures', this.#layers);
  }

  #make(name: string, sheet: Sheet, style: Partial<Style>, place: number): Layer {
    checkTexture(sheet?.texture, `the texture of "${name}"`);
    const layer = { id: ++this.#lastId, name, sheet, ...plainStyle, ...readStyle(style) };
    this.#set([...this.#layers.slice(0, place), layer, ...this.#layers.slice(place)]);
    return layer;
  }

  #indexOf({ id }: Pick<Layer, 'id'>): number {
    const index = this.#layers.findIndex((layer) => layer.id === id);
    if (index < 0) throw wrong('That layer was removed.', '');
    return index;
  }

  #replace(layer: Layer): void {
    const index = this.#indexOf(layer);
    this.#set(this.#layers.map((one, i) => (i === index ? layer : one)));
  }

  #set(layers: readonly Layer[]): void {
    this.#layers = layers;
    this.emit('change', layers);
  }
}
