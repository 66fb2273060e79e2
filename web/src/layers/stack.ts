import { Emitter } from '../platform/events';
import { kMostLayers } from './composite';
import { apart, kPlain, type Layer, type Sheet, type Style } from './layer';

/** What there is to be said when there is no room for another one. */
export const kFull = `There are ${kMostLayers} layers, as many as there can be: remove one first.`;

export interface StackEvents {
  /** Layers came, went, moved, or are laid in another way. */
  change: readonly Layer[];
  /** Pictures of layers are others now, and nothing else. */
  pictures: readonly Layer[];
  /** Another layer is worked on, or none. */
  select: Layer | undefined;
}

/** Up to eight paints over one another, from the lowest to the uppermost. It stays as it is when the model changes. */
export class LayerStack extends Emitter<StackEvents> {
  #layers: readonly Layer[] = [];
  #selected: number | undefined;
  #base: number | undefined;
  #lastId = 0;

  get layers(): readonly Layer[] {
    return this.#layers;
  }

  /** The layer that is worked on. */
  get selected(): Layer | undefined {
    return this.#layers.find(({ id }) => id === this.#selected);
  }

  get full(): boolean {
    return this.#layers.length >= kMostLayers;
  }

  /** Puts a paint under everything, in place of the one that was put there before. */
  setBase(name: string, sheet: Sheet): void {
    const { base } = this;
    if (base) return this.#replace({ ...base, name, sheet, visible: true });
    if (this.full) throw new Error(kFull);
    const layer = this.#make(name, sheet, {}, 0);
    this.#base = layer.id;
    this.select(layer);
  }

  /** The layer that a model's own paint is put in, unless it was removed. */
  get base(): Layer | undefined {
    return this.#layers.find(({ id }) => id === this.#base);
  }

  /** Lays a paint over the others, and works on it. @throws Error if there are eight. */
  add(name: string, sheet: Sheet, style: Partial<Style> = {}): Layer {
    if (this.full) throw new Error(kFull);
    const layer = this.#make(name, sheet, style, this.#layers.length);
    this.select(layer);
    return layer;
  }

  /** Takes a layer away. */
  remove(id: number): void {
    const place = this.#placeOf({ id });
    this.#set(this.#layers.toSpliced(place, 1));
    if (this.#selected === id) this.select(this.#layers[Math.min(place, this.#layers.length - 1)]);
  }

  /**
   * Does again what led from one state of the stack to another, and works on what that concerns: layers come, go, take their
   * places, and hold what they hold and are laid as in the other. Whatever is the same in both stays as it is by now.
   * @throws Error if there would be more than eight.
   */
  change(from: readonly Layer[], to: readonly Layer[]): void {
    const find = (layers: readonly Layer[], { id }: Layer): Layer | undefined =>
      layers.find((layer) => layer.id === id);
    let concerned: Layer | undefined;
    const layers = to.flatMap((layer) => {
      const [before, now] = [find(from, layer), find(this.#layers, layer)];
      if (before && !now) return []; // what went since stays away
      const change = before ? apart(before, layer) : {};
      if (!before || Object.keys(change).length > 0) concerned ??= layer;
      return [{ ...(now ?? layer), ...change }];
    });
    // What came since stays.
    this.#layers.forEach((layer, place) => {
      if (!find(from, layer) && !find(to, layer)) layers.splice(place, 0, layer);
    });
    if (layers.length > kMostLayers) throw new Error(kFull);
    const place = this.#layers.findIndex(({ id }) => id === this.#selected);
    this.#set(layers);
    this.select(concerned ?? this.selected ?? layers[Math.min(place, layers.length - 1)]);
  }

  /** Moves a layer. @param place From 0, the lowest. */
  move(layer: Layer, place: number): void {
    const from = this.#placeOf(layer);
    const to = Math.max(0, Math.min(this.#layers.length - 1, place));
    if (from !== to) this.#set(this.#layers.toSpliced(from, 1).toSpliced(to, 0, this.#layers[from]!));
  }

  /** Lays a layer in another way. */
  restyle(layer: Layer, style: Partial<Style>): void {
    this.#replace({ ...this.#layers[this.#placeOf(layer)]!, ...style });
  }

  select(layer: Layer | undefined): void {
    if (layer?.id === this.#selected) return;
    this.#selected = layer?.id;
    this.emit('select', this.selected);
  }

  /** Tells that sheets have other pictures now. */
  pictured(): void {
    this.emit('pictures', this.#layers);
  }

  #make(name: string, sheet: Sheet, style: Partial<Style>, place: number): Layer {
    const layer = { id: ++this.#lastId, name, sheet, ...kPlain, ...style };
    this.#set(this.#layers.toSpliced(place, 0, layer));
    return layer;
  }

  #placeOf({ id }: Pick<Layer, 'id'>): number {
    const place = this.#layers.findIndex((layer) => layer.id === id);
    if (place < 0) throw new Error('That layer was removed.');
    return place;
  }

  #replace(layer: Layer): void {
    this.#set(this.#layers.with(this.#placeOf(layer), layer));
  }

  #set(layers: readonly Layer[]): void {
    this.#layers = layers;
    this.emit('change', layers);
  }
}
