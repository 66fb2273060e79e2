import type { Vector3 } from 'three';
import type { Composite } from '../layers/composite';
import type { Edits } from '../layers/edits';
import type { Layer } from '../layers/layer';
import { type Rect, toShares } from '../layers/rect';
import { kFull, type LayerStack } from '../layers/stack';
import { readStraight } from '../layers/straight';
import { showError } from '../platform/page';
import type { Session, Shown } from '../scene/session';
import type { Spot } from '../view/pick';
import type { Viewer } from '../view/viewer';
import { CageTexels, type Capsule, type SurfacePoint } from './cage-texels';
import type { PaintOptions } from './paint-options';
import { PaintedSheet, type PaintedSize } from './painted-sheet';
import type { StickerSheet, StickerStyle } from './sticker';
import { StrokeLayer, type StrokeStyle } from './stroke-layer';

const kPicture = 96; // pixels per side of a layer's thumbnail
const kPictureDelay = 300; // milliseconds

/** The layers that are painted on, their composite, and the undo steps. */
export interface Layers {
  stack: LayerStack;
  composite: Composite;
  edits: Edits;
}

/**
 * Paints on the cage: maps spots of the target to points of the cage, holds the stroke in progress, and commits it to a layer.
 */
export class Painter {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #stack: LayerStack;
  readonly #composite: Composite;
  readonly #edits: Edits;
  readonly #options: PaintOptions;
  /** For the current cage, by texture size. */
  readonly #surfaces = new Map<PaintedSize, StrokeLayer>();
  /** The one in use, or used last. */
  #stroke: StrokeLayer | undefined;
  #cage: Shown['cage'] | undefined;
  /** The layer under the stroke in progress, and the name of its undo step. */
  #layer: Layer | undefined;
  #name = '';
  #picturing: ReturnType<typeof setTimeout> | undefined;
  /** All sheets that may be shown again: in the stack, or removed and kept by the undo history. */
  readonly #sheets: WeakRef<PaintedSheet>[] = [];

  constructor(session: Session, viewer: Viewer, { stack, composite, edits }: Layers, options: PaintOptions) {
    this.#session = session;
    this.#viewer = viewer;
    this.#stack = stack;
    this.#composite = composite;
    this.#edits = edits;
    this.#options = options;
    session.on('transfer', () => this.cancel());
    stack.on('select', (layer) => {
      if (layer?.sheet instanceof PaintedSheet) options.texels = layer.sheet.size;
    });
  }

  /** The texel map of the current cage. Cost: tens of milliseconds the first time for each cage and size. */
  get cageTexels(): CageTexels | undefined {
    return this.#surface()?.cageTexels;
  }

  /** Number of triangles of the target. */
  get triangles(): number {
    return (this.#session.shown?.target.mesh.indices.length ?? 0) / 3;
  }

  /** The point of the cage that a spot of the target takes its paint from; undefined where nothing may be painted. */
  surfacePointOf(spot: Spot | undefined): SurfacePoint | undefined {
    const { shown, classification } = this.#session;
    if (!spot || !shown || !classification?.cosmeticTriangles[spot.triangle]) return undefined;
    return this.cageTexels?.at(...uvOf(spot, shown));
  }

  /** Begins a stroke. @returns False, after telling why, if there is no layer to paint on. */
  begin(name: string, style: StrokeStyle): boolean {
    const stroke = this.#surface();
    const painted = this.#paintedLayer();
    if (!stroke) return false;
    if (!painted && (style.erases || this.#stack.full)) {
      showError(style.erases ? 'There is no painting to erase yet.' : kFull);
      return false;
    }
    this.#edits.begin();
    try {
      const layer = painted ?? this.addLayer();
      this.#stack.select(layer);
      if (!layer.visible) this.#stack.restyle(layer, { visible: true });
      stroke.begin(layer.sheet as PaintedSheet, style);
      this.#layer = layer;
    } catch (error) {
      this.#edits.cancel(); // or the step would stay open
      throw error;
    }
    this.#name = name;
    this.#stroke = stroke;
    return true;
  }

  /** Extends the stroke. */
  stroke(capsules: readonly Capsule[]): void {
    if (capsules.length > 0 && this.#layer) this.#show(this.#stroke!.stroke(this.#viewer.renderer, capsules));
  }

  /** Places a sticker; it moves from where it was placed since `begin`. */
  stick(place: SurfacePoint, sheet: StickerSheet, style: StickerStyle, up: Vector3): void {
    const { renderer } = this.#viewer;
    if (this.#layer) this.#show(this.#stroke!.stick(renderer, place, sheet.at(renderer, place, up, style)));
  }

  /** Commits the stroke to its layer, as an undo step. */
  end(): void {
    const layer = this.#layer;
    if (!layer) return;
    this.#layer = undefined;
    const { renderer } = this.#viewer;
    const sheet = layer.sheet as PaintedSheet;
    let parts: ReturnType<StrokeLayer['commit']> = [];
    try {
      parts = this.#stroke!.commit(renderer);
    } finally {
      if (parts.length === 0) this.#edits.cancel();
    }
    if (parts.length === 0) return;
    const put = (which: 'before' | 'after'): void => {
      for (const part of parts) sheet.put(renderer, part.rect, part[which]);
      this.#changed(
        sheet,
        parts.map(({ rect }) => rect),
      );
    };
    this.#edits.end(this.#name, {
      bytes: parts.reduce((sum, { before, after }) => sum + before.length + after.length, 0),
      undo: () => put('before'),
      redo: () => put('after'),
    });
    this.#changed(
      sheet,
      parts.map(({ rect }) => rect),
    );
  }

  /** Discards the stroke. */
  cancel(): void {
    if (!this.#layer) return;
    this.#layer = undefined;
    this.#show(this.#stroke!.end(this.#viewer.renderer));
    this.#edits.cancel();
  }

  /** Adds an empty layer to paint on. @throws Error if there are too many. */
  addLayer(): Layer {
    const sheet = new PaintedSheet(this.#options.texels);
    this.#sheets.push(new WeakRef(sheet));
    let number = 1;
    while (this.#stack.layers.some(({ name }) => name === `Painting ${number}`)) number++;
    return this.#stack.add(`Painting ${number}`, sheet);
  }

  /** Uploads all paintings again, after the graphics context was lost. */
  restore(): void {
    for (const sheet of this.#sheets) sheet.deref()?.restore(this.#viewer.renderer);
    this.#composite.set(this.#stack.layers);
    this.#viewer.redraw();
  }

  #show(rects: readonly Rect[]): void {
    this.#composite.touch(rects, this.#stroke?.active);
    this.#viewer.redraw();
  }

  #changed(sheet: PaintedSheet, rects: readonly Rect[]): void {
    this.#show(rects.map((rect) => toShares(rect, sheet.size)));
    // The thumbnail in the list is updated once the strokes pause.
    clearTimeout(this.#picturing);
    this.#picturing = setTimeout(() => {
      sheet.picture = addressOf(readStraight(this.#viewer.renderer, sheet.texture, kPicture));
      this.#stack.pictured();
    }, kPictureDelay);
  }

  /** The layer to paint on: the selected one if it is a painting of the chosen size, else the uppermost such painting. */
  #paintedLayer(): Layer | undefined {
    const { selected, layers } = this.#stack;
    const fits = ({ sheet }: Layer): boolean => sheet instanceof PaintedSheet && sheet.size === this.#options.texels;
    return selected && fits(selected) ? selected : layers.findLast(fits);
  }

  #surface(): StrokeLayer | undefined {
    const cage = this.#session.shown?.cage;
    if (cage !== this.#cage) {
      for (const surface of this.#surfaces.values()) surface.dispose();
      this.#surfaces.clear();
      this.#cage = cage;
    }
    const { positions, indices, uvs } = cage?.mesh ?? {};
    if (!positions || !indices || !uvs) return undefined;
    const { texels } = this.#options;
    const surface = this.#surfaces.get(texels) ?? new StrokeLayer(new CageTexels({ positions, indices, uvs }, texels));
    this.#surfaces.set(texels, surface);
    return surface;
  }
}

/** The UVs of a spot. */
function uvOf(
  { triangle, weights }: Spot,
  { target: { mesh }, projection: { uvs, cornerUvs } }: Shown,
): [number, number] {
  let [u, v] = [0, 0];
  weights.forEach((weight, index) => {
    const corner = 3 * triangle + index;
    const [of, at] = cornerUvs.length > 0 ? [cornerUvs, corner] : [uvs, mesh.indices[corner]!];
    u += weight * of[2 * at]!;
    v += weight * of[2 * at + 1]!;
  });
  return [u, v];
}

function addressOf(image: ImageData): string {
  const canvas = document.createElement('canvas');
  canvas.width = image.width;
  canvas.height = image.height;
  canvas.getContext('2d')!.putImageData(image, 0, 0);
  return canvas.toDataURL();
}
