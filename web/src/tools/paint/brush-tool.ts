import { type PointerPosition, PointerStroke } from '#three';
import type { Spot } from '../../view/pick';
import type { Tool } from '../../view/pointing';
import type { PaintOptions } from './paint-options';
import type { Painter } from './painter';
import type { Ring } from './ring';

/** Paints or erases along the pointer. Where nothing may be painted a drag turns the model, as with every tool. */
export class BrushTool implements Tool {
  readonly #stroke: PointerStroke;

  constructor(
    private readonly painter: Painter,
    private readonly options: PaintOptions,
    private readonly ring: Ring,
    private readonly erases: boolean,
  ) {
    this.#stroke = new PointerStroke(painter, painter);
  }

  down(spot: Spot | undefined, position: PointerPosition): boolean {
    const { color, opacity, hardness, mirror, size } = this.options;
    const style = { color, opacity, hardness, mirror, size, erases: this.erases };
    const aim = this.painter.aimOf(spot);
    return this.painter.telling(() => this.#stroke.begin(aim, position, style));
  }

  move(spot: Spot | undefined, event: PointerEvent): void {
    this.#stroke.move(this.painter.aimOf(spot), event);
    this.hover(spot, event);
  }

  /** Extends the stroke in a straight line. */
  go(spot: Spot | undefined, position: PointerPosition): void {
    this.#stroke.to(this.painter.aimOf(spot), position);
  }

  up(): void {
    this.#stroke.end();
  }

  cancel(): void {
    this.#stroke.cancel();
  }

  hover(spot: Spot | undefined, event: PointerEvent): void {
    this.ring.follow(this.painter.aimOf(spot), event, this.painter.lengthOf(this.options.size));
  }
}
