import type { Vector3 } from 'three';
import type { PaintingSize } from '../../gltf/look/saved-layers.js';
import { kMaxRects } from '../gpu/pass.js';
import { disjoint, type Rect, toShares, toTexels } from '../gpu/rect.js';
import { freeName, type Layer, plainStyle } from '../layers/layer.js';
import type { SurfacePoint } from './cage-texels.js';
import type { LayerPainter, PaintedLayers } from './layer-painter.js';
import { type StickerPicture, StickerSheet } from './sticker.js';
import { type PlacedSticker, StickersSheet } from './stickers-sheet.js';
import type { LaidSticker, StrokeLayer } from './stroke-layer.js';

/** Where a sticker lies on the current cage: its middle, and half its sides. @internal */
export interface StickerFrame {
  center: SurfacePoint;
  right: Vector3;
  up: Vector3;
}

const kMargin = 0.9; // of what a sticker is on, that it takes at first
const kLeast = 0.1; // of its size, that is left of it
const kMaxPictures = 24; // that are kept on the GPU while nothing shows them

/** Places stickers on a layer of their own, and changes them. @internal */
export class StickerPainter {
  readonly #layers: PaintedLayers;
  readonly #painter: LayerPainter;
  /** By picture. */
  readonly #pictures = new Map<StickerPicture, StickerSheet>();
  /** What is shown of a sheet, while it differs from its stickers. */
  #shown: { sheet: StickersSheet; stickers: readonly PlacedSticker[] } | undefined;
  /** A sheet for the next layer, which shows the first sticker before it is placed. */
  #spare: StickersSheet | undefined;
  #lastId = 0;

  /** @param size Texels per side of new layers. */
  constructor(
    layers: PaintedLayers,
    painter: LayerPainter,
    readonly size: PaintingSize,
  ) {
    this.#layers = layers;
    this.#painter = painter;
  }

  /** The sheet that new stickers are laid on: the selected one, else the uppermost, else a new one. */
  get sheet(): StickersSheet {
    const { selected, layers } = this.#layers.stack;
    const fits = (layer: Layer | undefined): boolean => layer?.sheet instanceof StickersSheet && !layer.sheet.fixed;
    const layer = fits(selected) ? selected : [...layers].reverse().find(fits);
    return (layer?.sheet as StickersSheet | undefined) ?? (this.#spare ??= new StickersSheet(this.size));
  }

  /** A new sticker. */
  make(sticker: Omit<PlacedSticker, 'id'>): PlacedSticker {
    return { ...sticker, id: ++this.#lastId };
  }

  /** A sticker that is no larger than what it is on. */
  fit(sticker: PlacedSticker): PlacedSticker {
    const surface = this.#painter.surfaceOf(this.size);
    const laid = this.#laid(sticker, surface);
    const share = laid ? surface!.cageTexels.room(laid.center, laid.sticker) : 1;
    return share < 1 ? { ...sticker, size: sticker.size * Math.max(kLeast, kMargin * share) } : sticker;
  }

  /** The uppermost sticker at a point of the cage. */
  at({ point }: SurfacePoint): { sheet: StickersSheet; sticker: PlacedSticker } | undefined {
    for (const { sheet, visible } of [...this.#layers.stack.layers].reverse()) {
      if (!visible || !(sheet instanceof StickersSheet) || sheet.fixed) continue;
      const sticker = [...sheet.stickers].reverse().find((one) => {
        const frame = this.frameOf(one);
        if (!frame) return false;
        const from = point.clone().sub(frame.center.point);
        const depth = Math.abs(from.dot(frame.center.normal));
        return (
          Math.abs(from.dot(frame.right)) <= frame.right.lengthSq() &&
          Math.abs(from.dot(frame.up)) <= frame.up.lengthSq() &&
          depth <= Math.max(frame.right.length(), frame.up.length())
        );
      });
      if (sticker) return { sheet, sticker };
    }
    return undefined;
  }

  /** Where a sticker lies on the current cage; undefined where that has no surface. */
  frameOf(sticker: PlacedSticker): StickerFrame | undefined {
    const laid = this.#laid(sticker);
    if (!laid) return undefined;
    const { right, up, width, height } = laid.sticker;
    return {
      center: laid.center,
      right: right.clone().multiplyScalar(width / 2),
      up: up.clone().multiplyScalar(height / 2),
    };
  }

  /** Shows other stickers on a sheet than those that it has, until the next call. It is no undo step. */
  show(sheet: StickersSheet, stickers: readonly PlacedSticker[]): void {
    if (this.#shown && this.#shown.sheet !== sheet) this.showPlaced();
    const before = this.#shown?.stickers ?? sheet.stickers;
    const rects = this.#draw(sheet, [before], stickers);
    if (!rects) return;
    const { composite, stack } = this.#layers;
    if (!stack.layers.some((layer) => layer.sheet === sheet) && !this.#shown && !stack.full)
      composite.set([...stack.layers, { ...plainStyle, id: 0, name: '', sheet }]);
    this.#shown = { sheet, stickers };
    this.#touch(sheet, rects);
  }

  /** Shows the stickers that are placed. */
  showPlaced(): void {
    if (!this.#shown) return;
    const { sheet, stickers } = this.#shown;
    this.#shown = undefined;
    const rects = this.#draw(sheet, [stickers], sheet.stickers) ?? [];
    const { composite, stack } = this.#layers;
    if (!stack.layers.some((layer) => layer.sheet === sheet)) composite.set(stack.layers);
    this.#touch(sheet, rects);
  }

  /**
   * Makes a sheet have other stickers, as an undo step, on a new layer if it has none.
   * @param name  Of the undo step.
   * @throws {CagecastError} if there is no room for a layer.
   */
  place(sheet: StickersSheet, stickers: readonly PlacedSticker[], name: string): void {
    const { edits, stack } = this.#layers;
    const before = sheet.stickers;
    if (before === stickers || (this.#shown && this.#shown.sheet !== sheet)) this.showPlaced();
    if (before === stickers) return;
    edits.begin();
    try {
      const layer = stack.layers.find((one) => one.sheet === sheet);
      if (!layer) {
        this.#painter.keep(sheet);
        stack.add(freeName('Stickers', stack.layers), sheet);
        if (this.#spare === sheet) this.#spare = undefined;
      } else {
        stack.select(layer);
        if (!layer.visible) stack.restyle(layer, { visible: true });
      }
    } catch (error) {
      edits.cancel();
      this.showPlaced();
      throw error;
    }
    this.#set(sheet, stickers);
    const undo = (): void => this.#set(sheet, before);
    edits.end(name, { bytes: 0, undo, redo: () => this.#set(sheet, stickers) });
  }

  /** Makes a sheet a painting, as an undo step: its stickers can be painted over and erased, and no more be moved. */
  fix(sheet: StickersSheet): void {
    const { edits, stack } = this.#layers;
    this.showPlaced();
    const set = (fixed: boolean): void => {
      sheet.fixed = fixed;
      stack.pictured();
    };
    edits.begin();
    set(true);
    edits.end('fixing stickers', { bytes: 0, undo: () => set(false), redo: () => set(true) });
  }

  /** Draws the pictures again, after the graphics context was lost. */
  restore(): void {
    for (const picture of this.#pictures.values()) picture.dispose();
    this.#pictures.clear();
    this.#shown = undefined;
  }

  #set(sheet: StickersSheet, stickers: readonly PlacedSticker[]): void {
    const before = this.#shown?.sheet === sheet ? this.#shown.stickers : sheet.stickers;
    const placed = sheet.stickers;
    this.#shown = undefined;
    sheet.stickers = stickers;
    const rects = this.#draw(sheet, [before, placed], stickers) ?? [];
    for (const rect of rects) sheet.readBack(this.#layers.renderer, rect);
    this.#touch(sheet, rects);
    this.#painter.emitPainted(sheet);
  }

  /** Draws some stickers where they differ from any of some lists. @returns The parts that changed, in texels; undefined without a cage. */
  #draw(
    sheet: StickersSheet,
    before: readonly (readonly PlacedSticker[])[],
    stickers: readonly PlacedSticker[],
  ): readonly Rect[] | undefined {
    const surface = this.#painter.surfaceOf(sheet.size);
    if (!surface) return undefined;
    const changed = before.flatMap((others) => [
      ...others.filter((one) => !stickers.includes(one)),
      ...stickers.filter((one) => !others.includes(one)),
    ]);
    const rects = disjoint(
      changed.flatMap((one) => {
        const laid = this.#laid(one, surface);
        return laid ? surface.reach(laid.center, laid.sticker).map((rect) => toTexels(rect, sheet.size)) : [];
      }),
      kMaxRects,
    );
    const { renderer } = this.#layers;
    const [oldest] = this.#pictures;
    if (oldest && this.#pictures.size > kMaxPictures) {
      oldest[1].dispose();
      this.#pictures.delete(oldest[0]);
    }
    surface.lay(
      renderer,
      sheet,
      rects,
      stickers.flatMap((one) => this.#laid(one, surface) ?? []),
    );
    return rects;
  }

  #laid(
    { picture, at, up, size, angle, opacity, mirrored }: PlacedSticker,
    surface: StrokeLayer | undefined = this.#painter.surfaceOf(this.size),
  ): LaidSticker | undefined {
    const center = surface?.cageTexels.at(at.x, at.y);
    if (!surface || !center) return undefined;
    let drawn = this.#pictures.get(picture);
    this.#pictures.delete(picture);
    if (!drawn) {
      drawn = new StickerSheet();
      drawn.draw(picture);
    }
    // The one used last is the last of the map.
    this.#pictures.set(picture, drawn);
    const style = { size: size * surface.cageTexels.diagonal, angle, mirrored };
    return {
      center,
      sticker: drawn.at(this.#layers.renderer, center, up, style),
      opacity,
      part: this.#painter.partAt(at),
    };
  }

  #touch({ size }: StickersSheet, rects: readonly Rect[]): void {
    this.#painter.touch(rects.map((rect) => toShares(rect, size)));
  }
}
