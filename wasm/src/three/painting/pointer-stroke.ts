import type { SurfacePoint } from './cage-texels.js';
import type { LayerPainter } from './layer-painter.js';
import { Stroke } from './stroke.js';
import type { StrokeStyle } from './stroke-layer.js';

/** A stroke's style, and the size of its brush. */
export interface BrushStyle extends StrokeStyle {
  /** The brush's diameter, as a share of the diagonal of the cage: above 0, up to 2. */
  size: number;
  /** Whether it paints on both sides of the cage's plane of symmetry, x = the middle of its box. */
  mirror: boolean;
}

/** What lies under a pointer. @internal */
export interface Aim {
  /** Where the surface takes its paint from; undefined where nothing may be painted. */
  surface: SurfacePoint | undefined;
  /** Pixels of the screen per unit of length of the cage. */
  scale: number;
}

/** Where a pointer paints. @internal */
export interface PointerView {
  /** @returns what lies at a position of the screen, in pixels. */
  aimAt(x: number, y: number): Aim | undefined;
  /** Triangles that `aimAt` visits. */
  readonly triangles: number;
}

/** The position of a pointer on the screen. @internal */
export interface PointerPosition {
  clientX: number;
  clientY: number;
  pointerType?: string;
  pressure?: number;
}

// Distance between two picks along the pointer's path: a share of the brush's radius, and a minimum in pixels.
const kStep = 0.5;
const kMinStep = 4;
// Picks are limited, as a pick visits every triangle: the rest of the path is interpolated on the cage.
const kTrianglesVisited = 120_000;
const kMaxPicks = 24;

/** Pens report how hard they are pressed; what others report says nothing. */
const pressureOf = ({ pointerType, pressure }: PointerPosition): number =>
  pointerType === 'pen' ? (pressure ?? 1) : 1;

/** Paints or erases along the path of a pointer. The pressure of a pen makes the brush smaller. @internal */
export class PointerStroke {
  #stroke: Stroke | undefined;
  #radius = 0;
  #scale = 1;
  #pressure = 1;
  #at = { x: 0, y: 0 };

  constructor(
    private readonly painter: Pick<LayerPainter, 'begin' | 'extend' | 'end' | 'cancel' | 'cageTexels'>,
    private readonly view: PointerView,
  ) {}

  /**
   * Begins a stroke.
   * @param aim  What lies under the pointer.
   * @returns whether it began: not where nothing may be painted.
   * @throws {CagecastError} as `LayerPainter.begin`.
   */
  begin(aim: Aim | undefined, position: PointerPosition, style: BrushStyle): boolean {
    const { cageTexels: texels } = this.painter;
    if (!aim?.surface || !texels) return false;
    this.painter.begin(style.erases ? 'erasing' : 'stroke', style);
    this.#radius = (style.size / 2) * texels.diagonal;
    this.#stroke = new Stroke(texels, { radius: this.#radius, mirror: style.mirror });
    this.#at = { x: position.clientX, y: position.clientY };
    this.#scale = aim.scale;
    this.#pressure = pressureOf(position);
    this.painter.extend(this.#stroke.to(aim.surface, 0, this.#pressure));
    return true;
  }

  /** Extends the stroke along what a pointer event tells. @param aim What lies under the pointer. */
  move(aim: Aim | undefined, event: PointerEvent): void {
    // Browsers send one event per frame; coalesced events hold the points in between.
    const points = event.getCoalescedEvents?.().slice(0, -1) ?? [];
    const every = Math.ceil(points.length / this.#most);
    for (const [i, point] of points.entries())
      if ((i + 1) % every === 0) this.to(this.view.aimAt(point.clientX, point.clientY), point);
    this.to(aim, event);
  }

  /** Picks for an event, and between two of its points. */
  get #most(): number {
    return Math.min(kMaxPicks, Math.ceil(kTrianglesVisited / this.view.triangles));
  }

  /** Extends the stroke in a straight line. @param aim What lies under the pointer. */
  to(aim: Aim | undefined, position: PointerPosition): void {
    if (!this.#stroke) return;
    const { clientX: x, clientY: y } = position;
    const [from, pressed, pressure] = [this.#at, this.#pressure, pressureOf(position)];
    this.#at = { x, y };
    this.#pressure = pressure;
    // Off the model the brush keeps the screen size it had on it.
    if (aim) this.#scale = aim.scale;
    const step = Math.max(kMinStep, kStep * this.#radius * this.#scale);
    const length = Math.hypot(x - from.x, y - from.y);
    const picks = Math.min(this.#most, Math.ceil(length / step) - 1);
    const between = length / (Math.max(0, picks) + 1) / this.#scale;
    const paint = (at: Aim | undefined, pressed: number): void =>
      this.painter.extend(this.#stroke!.to(at?.surface, between, pressed));
    for (let i = 1; i <= picks; i++) {
      const share = i / (picks + 1);
      const at = this.view.aimAt(from.x + share * (x - from.x), from.y + share * (y - from.y));
      paint(at, pressed + share * (pressure - pressed));
    }
    paint(aim, pressure);
  }

  /** Commits the stroke, as an undo step. */
  end(): void {
    this.#stroke = undefined;
    this.painter.end();
  }

  /** Discards the stroke. */
  cancel(): void {
    this.#stroke = undefined;
    this.painter.cancel();
  }
}
