import type { Spot } from '../view/pick';
import type { Tool } from '../view/pointing';
import type { Viewer } from '../view/viewer';
import type { PaintOptions } from './options';
import type { Painter } from './painter';
import type { Ring } from './ring';
import { Stroke } from './stroke';

// How far a pointer goes before its way is looked at again: as a share of the brush's radius, and in pixels at least.
const kStep = 0.5;
const kLeastStep = 4;
// Looks between two samples of a pointer: as many as this many triangles can be looked through, and some at most. What is
// left of the way is painted straight on over the cage.
const kTrianglesLooked = 120_000;
const kMostLooks = 24;

/** Paints, or erases, where a pointer goes. Off the paint it turns the model, as every tool does. */
export class BrushTool implements Tool {
  #stroke: Stroke | undefined;
  #radius = 0;
  /** Pixels of the screen for a length of 1. */
  #scale = 1;
  #at = { x: 0, y: 0 };

  constructor(
    private readonly painter: Painter,
    private readonly viewer: Viewer,
    private readonly options: PaintOptions,
    private readonly ring: Ring,
    private readonly erases: boolean,
  ) {}

  down(spot: Spot | undefined, { clientX: x, clientY: y }: Pick<PointerEvent, 'clientX' | 'clientY'>): boolean {
    const place = this.painter.placeOf(spot);
    const { color, opacity, hardness, mirror } = this.options;
    const { atlas } = this.painter;
    if (!place || !atlas) return false;
    if (!this.painter.begin(this.erases ? 'erasing' : 'stroke', { color, opacity, hardness, erases: this.erases }))
      return false;
    this.#radius = (this.options.size / 2) * atlas.diagonal;
    this.#stroke = new Stroke(atlas, { radius: this.#radius, mirror });
    this.#at = { x, y };
    this.#scale = this.viewer.pixelsAt(spot!.seen);
    this.painter.stroke(this.#stroke.to(place));
    return true;
  }

  move(spot: Spot | undefined, event: PointerEvent): void {
    // A browser gives one event a frame; the hand's way has more places.
    const way = event.getCoalescedEvents?.().slice(0, -1) ?? [];
    for (const { clientX, clientY } of way) this.go(this.viewer.pick(clientX, clientY), { clientX, clientY });
    this.go(spot, event);
    this.hover(spot, event);
  }

  /** Goes on in a straight line. */
  go(spot: Spot | undefined, { clientX: x, clientY: y }: Pick<PointerEvent, 'clientX' | 'clientY'>): void {
    if (!this.#stroke) return;
    const from = this.#at;
    this.#at = { x, y };
    // Beside the model nothing tells how large the brush is on the screen: as large as it was on it.
    if (spot) this.#scale = this.viewer.pixelsAt(spot.seen);
    const step = Math.max(kLeastStep, kStep * this.#radius * this.#scale);
    const length = Math.hypot(x - from.x, y - from.y);
    const looks = Math.min(
      kMostLooks,
      Math.floor(kTrianglesLooked / this.painter.triangles),
      Math.ceil(length / step) - 1,
    );
    const between = length / (Math.max(0, looks) + 1) / this.#scale;
    for (let i = 1; i <= looks; i++) {
      const share = i / (looks + 1);
      this.#paint(this.viewer.pick(from.x + share * (x - from.x), from.y + share * (y - from.y)), between);
    }
    this.#paint(spot, between);
  }

  up(): void {
    this.#stroke = undefined;
    this.painter.end();
  }

  cancel(): void {
    this.#stroke = undefined;
    this.painter.cancel();
  }

  hover(spot: Spot | undefined, { clientX, clientY, pointerType }: PointerEvent): void {
    const { atlas } = this.painter;
    if (!atlas || !this.painter.placeOf(spot) || pointerType === 'touch') return this.ring.hide();
    this.ring.show(clientX, clientY, this.options.size * atlas.diagonal * this.viewer.pixelsAt(spot!.seen));
  }

  #paint(spot: Spot | undefined, step: number): void {
    this.painter.stroke(this.#stroke!.to(this.painter.placeOf(spot), step));
  }
}
