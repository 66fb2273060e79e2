import { Vector3 } from 'three';
import {
  type CageTexels,
  type StickerFrame as Frame,
  type PlacedSticker,
  paintingSizes,
  StickerPainter,
  type StickerPicture,
  type StickersSheet,
  type SurfacePoint,
} from '#three';
import { announce } from '../../platform/page';
import type { Spot } from '../../view/pick';
import type { Viewer } from '../../view/viewer';
import type { PaintTool } from './keys';
import type { PaintOptions } from './paint-options';
import type { Layers, Painter } from './painter';
import { StickerFrame } from './sticker-frame';

/** One of the stickers of a sheet. */
interface Chosen {
  sheet: StickersSheet;
  sticker: PlacedSticker;
}

/** What is done with a sticker until it is placed. */
interface Change extends Chosen {
  /** The stickers of the sheet before. */
  before: readonly PlacedSticker[];
  /** From the point that the pointer took to the sticker's middle, in the cage's space. */
  grip: SurfacePoint['point'] | undefined;
  name: string;
}

/**
 * Places texts and images, and changes them: a sticker is seen at the pointer before it is placed, and the one that was placed or
 * clicked last can be moved, turned, scaled and mirrored.
 */
export class StickerTool implements PaintTool {
  readonly #painter: Painter;
  readonly #viewer: Viewer;
  readonly #options: PaintOptions;
  readonly #edits: Layers['edits'];
  readonly #stickers: StickerPainter;
  readonly #frame: StickerFrame;
  #image: ImageBitmap | undefined;
  /** What the next sticker shows; one object while it stays the same. */
  #picture: { key: unknown; picture: StickerPicture } | undefined;
  #chosen: Chosen | undefined;
  #change: Change | undefined;

  constructor(painter: Painter, viewer: Viewer, options: PaintOptions, layers: Layers) {
    this.#painter = painter;
    this.#viewer = viewer;
    this.#options = options;
    this.#edits = layers.edits;
    this.#stickers = new StickerPainter({ renderer: viewer.renderer, ...layers }, painter, paintingSizes[1]);
    this.#frame = new StickerFrame(viewer, {
      begin: () => this.#begin('turning a sticker'),
      turn: (angle, scale) => {
        const { sticker } = this.#change ?? {};
        if (sticker) this.#alter({ angle: sticker.angle + angle, size: clampSize(sticker.size * scale) });
        this.#write();
      },
      end: () => this.#end(),
      mirror: () => this.#do('mirroring a sticker', ({ mirrored }) => ({ mirrored: !mirrored })),
      duplicate: () =>
        this.#copy('duplicating a sticker', ({ center, right }) => ({
          point: center.point.clone().addScaledVector(right, kBeside),
          normal: center.normal,
        })),
      // Not mirrored itself: letters stay readable.
      across: () =>
        this.#copy(
          'a sticker on the other side',
          ({ center }, texels) => texels.mirrored(center),
          ({ up, angle }) => ({ up: new Vector3(-up.x, up.y, up.z), angle: -angle }),
        ),
      remove: () => this.remove(),
      done: () => this.#choose(undefined),
    });
    options.on('sticker', ({ field, ended }) => this.#restyle(field, ended));
    // It may have been undone, or its layer removed.
    const check = (): void => {
      const { sheet, sticker } = this.#chosen ?? {};
      if (!sheet || !sticker || this.#change) return;
      const found = sheet.stickers.find(({ id }) => id === sticker.id);
      const isShown = layers.stack.layers.some((layer) => layer.sheet === sheet && layer.visible) && !sheet.fixed;
      this.#choose(found && isShown ? { sheet, sticker: found } : undefined);
    };
    for (const event of ['change', 'pictures'] as const) layers.stack.on(event, check);
    painter.on('painted', check);
    // What is only previewed is not to be saved by a key.
    addEventListener('keydown', () => this.#change || this.#stickers.showPlaced(), { capture: true });
  }

  /** Removes the preview of what is not placed yet. */
  showPlaced(): void {
    this.#stickers.showPlaced();
  }

  /** Uses an image instead of the text, until a text is entered. */
  setImage(image: ImageBitmap): void {
    this.#image = image;
    this.#options.text = '';
    this.#restyle('picture', true);
  }

  down(spot: Spot | undefined): boolean {
    const surface = this.#painter.aimOf(spot)?.surface;
    if (!surface?.uv) return false;
    const found = this.#stickers.at(surface);
    if (found) {
      this.#choose(found);
      this.#begin('moving a sticker');
      const middle = this.#stickers.frameOf(found.sticker)?.center.point;
      this.#change!.grip = middle?.clone().sub(surface.point);
      return true;
    }
    const picture = this.#nextPicture();
    if (!picture) return false;
    const { sheet } = this.#stickers;
    const sticker = this.#make(picture, surface);
    this.#change = { sheet, sticker, before: sheet.stickers, grip: undefined, name: 'sticker' };
    this.#show();
    return true;
  }

  move(spot: Spot | undefined): void {
    this.go(spot);
  }

  /** Moves it. */
  go(spot: Spot | undefined): void {
    const surface = this.#painter.aimOf(spot)?.surface;
    if (!surface || !this.#change) return;
    const { grip } = this.#change;
    const at = grip
      ? this.#painter
          .surfaceOf(this.#change.sheet.size)
          ?.cageTexels.nearest(surface.point.clone().add(grip), surface.normal)
      : surface;
    if (at?.uv) this.#alter({ at: at.uv, up: this.#viewer.screen.up });
  }

  up(): void {
    this.#end();
  }

  cancel(): void {
    this.#change = undefined;
    this.#stickers.showPlaced();
  }

  hover(spot: Spot | undefined): void {
    if (this.#change) return;
    const surface = this.#painter.aimOf(spot)?.surface;
    const picture = this.#nextPicture();
    if (!surface?.uv || !picture || this.#stickers.at(surface)) {
      this.#stickers.showPlaced();
      return;
    }
    const { sheet } = this.#stickers;
    this.#stickers.show(sheet, [...sheet.stickers, this.#make(picture, surface)]);
  }

  /** Removes the chosen sticker. */
  remove(): void {
    if (!this.#chosen) return;
    const { sheet, sticker } = this.#chosen;
    this.#stickers.place(
      sheet,
      sheet.stickers.filter(({ id }) => id !== sticker.id),
      'removing a sticker',
    );
    this.#choose(undefined);
  }

  /** Ends what is done with stickers, as another tool is chosen. */
  leave(): void {
    this.cancel();
    this.#choose(undefined);
  }

  restore(): void {
    this.#stickers.restore();
  }

  /** Makes the stickers of the selected layer paint that can be erased. */
  fix(sheet: StickersSheet): void {
    this.#choose(undefined);
    this.#stickers.fix(sheet);
    announce('The stickers of this layer are paint now, and cannot be moved any more. Undo makes them stickers again.');
  }

  #make(picture: StickerPicture, { uv }: SurfacePoint): PlacedSticker {
    const { size, angle, opacity, mirrored } = this.#options;
    const { up } = this.#viewer.screen;
    return this.#stickers.fit(this.#stickers.make({ picture, at: uv!, up, size, angle, opacity, mirrored }));
  }

  #nextPicture(): StickerPicture | undefined {
    const { text, color, outline } = this.#options;
    const line = text.trim();
    const key = line === '' ? this.#image : JSON.stringify([line, color, outline]);
    if (key !== this.#picture?.key || !this.#picture) {
      const picture = line === '' ? this.#image && { image: this.#image } : { text: line, color, outline };
      this.#picture = picture && { key, picture };
    }
    return this.#picture?.picture;
  }

  #choose(chosen: Chosen | undefined): void {
    this.#chosen = chosen;
    if (chosen) this.#write();
    this.#frame.show(chosen && (() => this.#stickers.frameOf((this.#change ?? chosen).sticker)));
  }

  /** Shows the chosen sticker in the options. */
  #write(): void {
    const { size, angle, opacity, mirrored, picture } = (this.#change ?? this.#chosen)!.sticker;
    if ('image' in picture) this.#image = picture.image as ImageBitmap;
    const text = 'text' in picture ? picture : undefined;
    this.#options.write({
      size,
      angle,
      opacity,
      mirrored,
      text: text?.text ?? '',
      ...(text && { color: text.color, outlined: text.outline !== undefined }),
    });
  }

  #begin(name: string): void {
    if (!this.#chosen) return;
    const { sheet, sticker } = this.#chosen;
    this.#change = { sheet, sticker, before: sheet.stickers, grip: undefined, name };
  }

  /** Changes the sticker until `#end`. */
  #alter(change: Partial<PlacedSticker>): void {
    if (!this.#change) return;
    this.#change.sticker = { ...this.#change.sticker, ...change };
    this.#show();
  }

  #list(): PlacedSticker[] {
    const { before, sticker } = this.#change!;
    const isNew = !before.some(({ id }) => id === sticker.id);
    return isNew ? [...before, sticker] : before.map((one) => (one.id === sticker.id ? sticker : one));
  }

  #show(): void {
    this.#stickers.show(this.#change!.sheet, this.#list());
    this.#viewer.redraw();
  }

  /** Places it, as an undo step. */
  #end(): void {
    if (!this.#change) return;
    const { sheet, sticker, before, name } = this.#change;
    // A click that only chose it.
    const stayed = before.includes(sticker);
    const list = stayed ? before : this.#list();
    const isPlaced = this.#painter.telling(() => {
      if (before.length === 0) {
        this.#edits.begin(); // one step with the placing
        this.#painter.hideChecker();
      }
      this.#stickers.place(sheet, list, name);
      return true;
    });
    this.#change = undefined;
    this.#choose(isPlaced ? { sheet, sticker } : undefined);
  }

  #do(name: string, change: (sticker: PlacedSticker) => Partial<PlacedSticker>): void {
    if (!this.#chosen) return;
    this.#begin(name);
    this.#alter(change(this.#chosen.sticker));
    this.#end();
  }

  /**
   * Places another one like the chosen sticker, as an undo step.
   * @param place   Where, near the surface of the cage.
   * @param change  What is different.
   */
  #copy(
    name: string,
    place: (frame: Frame, texels: CageTexels) => SurfacePoint,
    change: (sticker: PlacedSticker) => Partial<PlacedSticker> = () => ({}),
  ): void {
    const { sheet, sticker } = this.#chosen ?? {};
    const texels = sheet && this.#painter.surfaceOf(sheet.size)?.cageTexels;
    const frame = sticker && this.#stickers.frameOf(sticker);
    if (!texels || !frame) return;
    const { point, normal } = place(frame, texels);
    const at = texels.nearest(point, normal)?.uv;
    if (!at) return;
    const copy = this.#stickers.make({ ...sticker, at, ...change(sticker) });
    this.#stickers.place(sheet, [...sheet.stickers, copy], name);
    this.#choose({ sheet, sticker: copy });
  }

  /** Makes the chosen sticker what an option says. @param ended  Whether the user has let go of it. */
  #restyle(field: 'size' | 'angle' | 'opacity' | 'mirrored' | 'picture' | undefined, ended: boolean): void {
    if (!this.#chosen) return;
    const value = field === 'picture' ? this.#nextPicture() : field && this.#options[field];
    const now = field && (this.#change ?? this.#chosen).sticker[field];
    if (field && value !== undefined && keyOf(value) !== keyOf(now)) {
      if (!this.#change) this.#begin('changing a sticker');
      this.#alter({ [field]: value });
    }
    if (ended) this.#end();
  }
}

/** The same for equal texts, which are other objects each time they are written. */
const keyOf = (value: unknown): unknown =>
  typeof value !== 'object' || value === null ? value : 'image' in value ? value.image : JSON.stringify(value);

const kBeside = 2.2; // halves of its width, from a sticker to its duplicate

const clampSize = (size: number): number => Math.min(1, Math.max(0.004, size));
