import type { Spot } from '../view/pick';
import type { Tool } from '../view/pointing';
import type { Viewer } from '../view/viewer';
import type { PaintOptions } from './paint-options';
import type { Painter } from './painter';
import type { Ring } from './ring';
import { Stroke } from './stroke';

// Distance between two picks along the pointer's path: a share of the brush's radius, and a minimum in pixels.
const kStep = 0.5;
const kLeastStep = 4;
// Picks between two pointer samples are limited: a pick visits every triangle. The rest of the path is interpolated on the cage.
const kTrianglesVisited = 120_000;
const kMostPicks = 24;

/** Paints or erases along the pointer. Where nothing may be painted a drag turns the model, as with every tool. */
export class BrushTool implements Tool {
  #stroke: Stroke | undefined;
  #radius = 0;
  /** Screen pixels per unit of length. */
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
    const point = this.painter.surfacePointOf(spot);
    const { color, opacity, hardness, mirror } = this.options;
    const { cageTexels: texels } = this.painter;
    if (!point || !texels) return false;
    if (!this.painter.begin(this.erases ? 'erasing' : 'stroke', { color, opacity, hardness, erases: this.erases }))
      return false;
    this.#radius = (this.options.size / 2) * texels.diagonal;
    this.#stroke = new Stroke(texels, { radius: this.#radius, mirror });
    this.#at = { x, y };
    this.#scale = this.viewer.pixelsAt(spot!.seen);
    this.painter.stroke(this.#stroke.to(point));
    return true;
  }

  move(spot: Spot | undefined, event: PointerEvent): void {
    // Browsers send one event per frame; coalesced events hold the points in between.
    const way = event.getCoalescedEvents?.().slice(0, -1) ?? [];
    for (const { clientX, clientY } of way) this.go(this.viewer.pick(clientX, clientY), { clientX, clientY });
    this.go(spot, event);
    this.hover(spot, event);
  }

  /** Extends the stroke in a straight line. */
  go(spot: Spot | undefined, { clientX: x, clientY: y }: Pick<PointerEvent, 'clientX' | 'clientY'>): void {
    if (!this.#stroke) return;
    const from = this.#at;
    this.#at = { x, y };
    // Off the model the brush keeps the screen size it had on it.
    if (spot) this.#scale = this.viewer.pixelsAt(spot.seen);
    const step = Math.max(kLeastStep, kStep * this.#radius * this.#scale);
    const length = Math.hypot(x - from.x, y - from.y);
    const picks = Math.min(
      kMostPicks,
      Math.floor(kTrianglesVisited / this.painter.triangles),
      Math.ceil(length / step) - 1,
    );
    const between = length / (Math.max(0, picks) + 1) / this.#scale;
    for (let i = 1; i <= picks; i++) {
      const share = i / (picks + 1);
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
    const { cageTexels: texels } = this.painter;
    if (!texels || !this.painter.surfacePointOf(spot) || pointerType === 'touch') this.ring.hide();
    else this.ring.show(clientX, clientY, this.options.size * texels.diagonal * this.viewer.pixelsAt(spot!.seen));
  }

  #paint(spot: Spot | undefined, step: number): void {
    this.painter.stroke(this.#stroke!.to(this.painter.surfacePointOf(spot), step));
  }
}
