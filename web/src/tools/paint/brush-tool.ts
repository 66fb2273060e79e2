import {
  type Aim,
  type LayerPainter,
  type PointerPosition,
  PointerStroke,
  type PointerView,
  paintingSizes,
} from '#three';
import type { Spot } from '../../view/pick';
import type { Tool } from '../../view/pointing';
import type { PaintOptions } from './paint-options';
import type { Ring } from './ring';

/** A brush with a diameter below this share of the diagonal of the cage is a few texels wide on a painting of the lesser size. */
const kThin = 0.012;

/** What it paints on. */
interface Canvas extends PointerView, Pick<LayerPainter, 'begin' | 'extend' | 'end' | 'cancel' | 'cageTexels'> {
  aimOf(spot: Spot | undefined): Aim | undefined;
  telling(begin: () => boolean): boolean;
}

/**
 * Paints or erases along the pointer. The brush has one size on the screen, so that strokes are finer the nearer the model is; a stroke keeps
 * the size on the model that it began with. Where nothing may be painted a drag turns the model, as with every tool.
 */
export class BrushTool implements Tool {
  readonly #stroke: PointerStroke;
  /** The diameter on the model while the brush is down. */
  #length: number | undefined;

  constructor(
    private readonly painter: Canvas,
    private readonly options: Pick<PaintOptions, 'color' | 'opacity' | 'hardness' | 'mirror' | 'size' | 'texels'>,
    private readonly ring: Pick<Ring, 'follow'>,
    private readonly erases: boolean,
  ) {
    this.#stroke = new PointerStroke(painter, painter);
  }

  down(spot: Spot | undefined, position: PointerPosition): boolean {
    const { color, opacity, hardness, mirror } = this.options;
    const aim = this.painter.aimOf(spot);
    const { diagonal } = this.painter.cageTexels ?? {};
    if (!aim?.surface || !diagonal) return false;
    const length = this.options.size / aim.scale;
    const size = length / diagonal;
    if (size < kThin && !this.erases) this.options.texels = paintingSizes[1];
    const style = { color, opacity, hardness, mirror, size, erases: this.erases };
    const begins = this.painter.telling(() => this.#stroke.begin(aim, position, style));
    if (begins) this.#length = length;
    return begins;
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
    this.#length = undefined;
    this.#stroke.end();
  }

  cancel(): void {
    this.#length = undefined;
    this.#stroke.cancel();
  }

  hover(spot: Spot | undefined, event: PointerEvent): void {
    const aim: Aim | undefined = this.painter.aimOf(spot);
    this.ring.follow(aim, event, this.#length && aim ? this.#length * aim.scale : this.options.size);
  }
}
