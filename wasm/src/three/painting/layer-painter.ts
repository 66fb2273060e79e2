import type { Vector2, Vector3, WebGLRenderer } from 'three';
import { type PaintingSize, paintingSizes } from '../../gltf/look/saved-layers.js';
import { isMoved } from '../../gltf/look/style.js';
import { check, wrong } from '../errors.js';
import { kWhole, type Rect, toShares } from '../gpu/rect.js';
import type { Composite } from '../layers/composite.js';
import type { Edits } from '../layers/edits.js';
import { Emitter } from '../layers/emitter.js';
import { freeName, type Layer } from '../layers/layer.js';
import { PaintedSheet } from '../layers/painted-sheet.js';
import type { LayerStack } from '../layers/stack.js';
import { type CageMesh, CageTexels, type Capsule, type SurfacePoint } from './cage-texels.js';
import type { StickerSheet, StickerStyle } from './sticker.js';
import { StickersSheet } from './stickers-sheet.js';
import { type StickerPart, StrokeLayer, type StrokeStyle } from './stroke-layer.js';

/** The layers that are painted on, their composite, and the undo steps, as `Layers` has them. @internal */
export interface PaintedLayers {
  renderer: WebGLRenderer;
  stack: LayerStack;
  composite: Composite;
  edits: Edits;
}

export interface LayerPainterEvents {
  /** The composite is to be drawn again. */
  change: undefined;
  /** A painting was changed by a whole stroke or sticker, by undo or by redo. */
  painted: PaintedSheet;
}

/**
 * Paints in the space of a cage: holds the stroke in progress, and commits it to a layer as an undo step. It knows nothing of
 * models and pointers; `Painter` does.
 * @internal
 */
export class LayerPainter extends Emitter<LayerPainterEvents> {
  readonly #layers: PaintedLayers;
  /** For the current cage, by texture size. */
  readonly #surfaces = new Map<PaintingSize, StrokeLayer>();
  /** The one in use, or used last. */
  #stroke: StrokeLayer | undefined;
  #cage: CageMesh | undefined;
  #size: PaintingSize = paintingSizes[0];
  /** The layer under the stroke in progress, and the name of its undo step. */
  #layer: Layer | undefined;
  #name = '';
  /** All sheets that may be shown again: in the stack, or removed and kept by the undo history. */
  readonly #sheets: WeakRef<PaintedSheet>[] = [];

  constructor(layers: PaintedLayers) {
    super();
    this.#layers = layers;
  }

  /** Texels per side of the paintings that are added and painted on. Default: 1024. */
  get size(): PaintingSize {
    return this.#size;
  }

  set size(size: PaintingSize) {
    check(paintingSizes.includes(size), 'size', size, `one of ${paintingSizes.join(', ')}`);
    this.#size = size;
  }

  /** Paints on another cage from now on; a stroke in progress is discarded. */
  setCage(cage: CageMesh | undefined): void {
    this.cancel();
    if (cage === this.#cage) return;
    for (const surface of this.#surfaces.values()) surface.dispose();
    this.#surfaces.clear();
    this.#stroke = undefined;
    this.#cage = cage;
  }

  /** The texel map of the cage. Cost: tens of milliseconds the first time for each cage and size. */
  get cageTexels(): CageTexels | undefined {
    return this.#surface()?.cageTexels;
  }

  /** Whether there is a painting of the current size. */
  get hasPainting(): boolean {
    return this.#paintedLayer() !== undefined;
  }

  /** Whether it has sheets to upload again after the graphics context was lost, also those that undo or redo may bring back. */
  get hasSheets(): boolean {
    return this.#sheets.length > 0;
  }

  /**
   * Begins a stroke or a sticker, on a new layer if there is none to paint on.
   * @param name  Of the undo step.
   * @throws {CagecastError} `badArgument` if there is nothing to erase, or no room for a layer.
   */
  begin(name: string, style: StrokeStyle): void {
    const { stack, edits } = this.#layers;
    this.cancel();
    const stroke = this.#surface();
    const painted = this.#paintedLayer();
    if (!stroke) throw wrong('There is no cage to paint on yet.', '');
    if (!painted && style.erases) throw wrong('There is no painting to erase yet.', '');
    edits.begin();
    try {
      const layer = painted ?? this.addLayer();
      stack.select(layer);
      if (!layer.visible) stack.restyle(layer, { visible: true });
      stroke.begin(layer.sheet as PaintedSheet, style);
      this.#layer = layer;
    } catch (error) {
      edits.cancel(); // or the step would stay open
      throw error;
    }
    this.#name = name;
    this.#stroke = stroke;
  }

  /** Extends the stroke. */
  extend(capsules: readonly Capsule[]): void {
    if (capsules.length > 0 && this.#layer) this.touch(this.#stroke!.stroke(this.#layers.renderer, capsules));
  }

  /** Fills triangles of the texture with the stroke's colour. @param uvs 6 numbers per triangle. */
  fill(uvs: ArrayLike<number>): void {
    if (this.#layer) this.touch(this.#stroke!.fill(this.#layers.renderer, uvs));
  }

  /** Places a sticker; it moves from where it was placed since `begin`. @param up In the cage's space. */
  stick(place: SurfacePoint, sheet: StickerSheet, style: StickerStyle, up: Vector3): void {
    const { renderer } = this.#layers;
    if (this.#layer) this.touch(this.#stroke!.stick(renderer, place, sheet.at(renderer, place, up, style)));
  }

  /** Commits the stroke to its layer, as an undo step. Waits for the GPU. */
  end(): void {
    const layer = this.#layer;
    if (!layer) return;
    this.#layer = undefined;
    const { renderer, edits } = this.#layers;
    const sheet = layer.sheet as PaintedSheet;
    let parts: ReturnType<StrokeLayer['commit']> = [];
    try {
      parts = this.#stroke!.commit(renderer);
    } finally {
      if (parts.length === 0) edits.cancel();
    }
    if (parts.length === 0) return;
    const rects = parts.map(({ rect }) => rect);
    const put = (which: 'before' | 'after'): void => {
      for (const part of parts) sheet.put(renderer, part.rect, part[which]);
      this.#changed(sheet, rects);
    };
    edits.end(this.#name, {
      bytes: parts.reduce((sum, { before, after }) => sum + before.length + after.length, 0),
      undo: () => put('before'),
      redo: () => put('after'),
    });
    this.#changed(sheet, rects);
  }

  /** Discards the stroke. */
  cancel(): void {
    if (!this.#layer) return;
    this.#layer = undefined;
    this.touch(this.#stroke!.end(this.#layers.renderer));
    this.#layers.edits.cancel();
  }

  /** Adds an empty layer to paint on. @throws {CagecastError} if there are too many. */
  addLayer(): Layer {
    const { stack } = this.#layers;
    const sheet = new PaintedSheet(this.size);
    this.keep(sheet);
    return stack.add(freeName('Painting', stack.layers), sheet);
  }

  /** Uploads a sheet too, after the graphics context was lost. */
  keep(sheet: PaintedSheet): void {
    this.#sheets.push(new WeakRef(sheet));
  }

  /** Uploads all paintings again, after the graphics context was lost. */
  restore(): void {
    const { renderer, composite, stack } = this.#layers;
    for (const sheet of this.#sheets) sheet.deref()?.restore(renderer);
    composite.set(stack.layers);
    this.emit('change', undefined);
  }

  /** Frees its GPU memory, but for the paintings, which belong to their layers. */
  dispose(): void {
    this.setCage(undefined);
  }

  /** Draws parts of the composite again. @param rects In shares. */
  touch(rects: readonly Rect[]): void {
    this.#layers.composite.touch(rects, this.#stroke?.active);
    this.emit('change', undefined);
  }

  /** Tells that a painting was changed. */
  emitPainted(sheet: PaintedSheet): void {
    this.emit('painted', sheet);
  }

  /** What a sticker at a UV keeps to; undefined for the whole cage. */
  partAt(_uv: Vector2): StickerPart | undefined {
    return undefined;
  }

  /** What strokes on the current cage are drawn with. Cost: as `cageTexels`. */
  surfaceOf(size: PaintingSize): StrokeLayer | undefined {
    if (!this.#cage) return undefined;
    const surface = this.#surfaces.get(size) ?? new StrokeLayer(new CageTexels(this.#cage, size));
    this.#surfaces.set(size, surface);
    return surface;
  }

  #changed(sheet: PaintedSheet, rects: readonly Rect[]): void {
    const isElsewhere = this.#layers.stack.layers.some((layer) => layer.sheet === sheet && isMoved(layer));
    this.touch(isElsewhere ? [kWhole] : rects.map((rect) => toShares(rect, sheet.size)));
    this.emit('painted', sheet);
  }

  /** The layer to paint on: the selected one if it is a painting of the chosen size in its own place, else the uppermost such painting. */
  #paintedLayer(): Layer | undefined {
    const { selected, layers } = this.#layers.stack;
    const fits = ({ sheet, ...style }: Layer): boolean =>
      !isMoved(style) &&
      sheet instanceof PaintedSheet &&
      sheet.size === this.size &&
      !(sheet instanceof StickersSheet && !sheet.fixed);
    return selected && fits(selected) ? selected : [...layers].reverse().find(fits);
  }

  #surface(): StrokeLayer | undefined {
    return this.surfaceOf(this.size);
  }
}
