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
import { CageAtlas, type Capsule, type Place } from './atlas';
import type { PaintOptions } from './options';
import { PaintedSheet, type PaintedSize } from './painted-sheet';
import type { StickerSheet, StickerStyle } from './sticker';
import { type StrokeStyle, WetPaint } from './stroke-layer';

const kPicture = 96; // pixels a side of a layer's picture
const kPictureDelay = 300; // milliseconds

/** What is painted on, what shows it, and where it is noted. */
export interface Layers {
  stack: LayerStack;
  composite: Composite;
  edits: Edits;
}

/**
 * Paints on the cage of what is on show: finds the place that is meant by a spot of the target, keeps what is wet, and makes
 * it part of a layer.
 */
export class Painter {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #stack: LayerStack;
  readonly #composite: Composite;
  readonly #edits: Edits;
  readonly #options: PaintOptions;
  /** For the cage of what is on show, by the texels a side. */
  readonly #surfaces = new Map<PaintedSize, WetPaint>();
  /** The one that is painted on, or was last. */
  #wet: WetPaint | undefined;
  #cage: Shown['cage'] | undefined;
  /** The layer that something wet lies on, and what undoing that is called. */
  #layer: Layer | undefined;
  #name = '';
  #picturing: ReturnType<typeof setTimeout> | undefined;
  /** All that may come back: on show, or removed and kept to be undone. */
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

  /** The cage of what is on show, unrolled. Cost: tens of milliseconds the first time for each cage and number of texels. */
  get atlas(): CageAtlas | undefined {
    return this.#surface()?.atlas;
  }

  /** How many triangles the target has. */
  get triangles(): number {
    return (this.#session.shown?.target.mesh.indices.length ?? 0) / 3;
  }

  /** The place of the cage that a spot of the target takes its paint from; none where it takes none. */
  placeOf(spot: Spot | undefined): Place | undefined {
    const { shown, classification } = this.#session;
    if (!spot || !shown || !classification?.cosmeticTriangles[spot.triangle]) return undefined;
    return this.atlas?.at(...uvOf(spot, shown));
  }

  /** Begins to paint. @returns Whether there is a layer to do it on; the page says so if there is none. */
  begin(name: string, style: StrokeStyle): boolean {
    const wet = this.#surface();
    const painted = this.#paintedLayer();
    if (!wet) return false;
    if (!painted && (style.erases || this.#stack.full)) {
      showError(style.erases ? 'Nothing was painted yet that could be erased.' : kFull);
      return false;
    }
    this.#edits.begin();
    try {
      const layer = painted ?? this.addLayer();
      this.#stack.select(layer);
      if (!layer.visible) this.#stack.restyle(layer, { visible: true });
      wet.begin(layer.sheet as PaintedSheet, style);
      this.#layer = layer;
    } catch (error) {
      this.#edits.cancel(); // or it would be under way for ever
      throw error;
    }
    this.#name = name;
    this.#wet = wet;
    return true;
  }

  /** Goes on with a stroke. */
  stroke(capsules: readonly Capsule[]): void {
    if (capsules.length > 0 && this.#layer) this.#show(this.#wet!.stroke(this.#viewer.renderer, capsules));
  }

  /** Sticks a picture on, in place of where it was stuck before in the same go. */
  stick(place: Place, sheet: StickerSheet, style: StickerStyle, up: Vector3): void {
    const { renderer } = this.#viewer;
    if (this.#layer) this.#show(this.#wet!.stick(renderer, place, sheet.at(renderer, place, up, style)));
  }

  /** Makes what was painted part of its layer. */
  end(): void {
    const layer = this.#layer;
    if (!layer) return;
    this.#layer = undefined;
    const { renderer } = this.#viewer;
    const sheet = layer.sheet as PaintedSheet;
    let parts: ReturnType<WetPaint['settle']> = [];
    try {
      parts = this.#wet!.settle(renderer);
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

  /** Takes back what is wet. */
  cancel(): void {
    if (!this.#layer) return;
    this.#layer = undefined;
    this.#show(this.#wet!.end(this.#viewer.renderer));
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

  /** Makes all that was painted again, after the graphics context was lost. */
  restore(): void {
    for (const sheet of this.#sheets) sheet.deref()?.restore(this.#viewer.renderer);
    this.#composite.set(this.#stack.layers);
    this.#viewer.redraw();
  }

  #show(rects: readonly Rect[]): void {
    this.#composite.touch(rects, this.#wet?.wet);
    this.#viewer.redraw();
  }

  #changed(sheet: PaintedSheet, rects: readonly Rect[]): void {
    this.#show(rects.map((rect) => toShares(rect, sheet.size)));
    // Its picture in the list can wait until the hand rests.
    clearTimeout(this.#picturing);
    this.#picturing = setTimeout(() => {
      sheet.picture = addressOf(readStraight(this.#viewer.renderer, sheet.texture, kPicture));
      this.#stack.pictured();
    }, kPictureDelay);
  }

  /** The layer that is painted on: the one worked on, or the uppermost painting, of those with the texels that are wanted. */
  #paintedLayer(): Layer | undefined {
    const { selected, layers } = this.#stack;
    const fits = ({ sheet }: Layer): boolean => sheet instanceof PaintedSheet && sheet.size === this.#options.texels;
    return selected && fits(selected) ? selected : layers.findLast(fits);
  }

  #surface(): WetPaint | undefined {
    const cage = this.#session.shown?.cage;
    if (cage !== this.#cage) {
      for (const surface of this.#surfaces.values()) surface.dispose();
      this.#surfaces.clear();
      this.#cage = cage;
    }
    const { positions, indices, uvs } = cage?.mesh ?? {};
    if (!positions || !indices || !uvs) return undefined;
    const { texels } = this.#options;
    const surface = this.#surfaces.get(texels) ?? new WetPaint(new CageAtlas({ positions, indices, uvs }, texels));
    this.#surfaces.set(texels, surface);
    return surface;
  }
}

/** Where a spot lies in the paint. */
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
