import { MathUtils, type Vector3 } from 'three';
import { type CageTexels, type Capsule, PaintedSheet, type PaintingSize, StickersSheet } from '#three';
import { clearError, showError } from '../../platform/page';
import type { Spot } from '../../view/pick';
import type { BrushTool } from './brush-tool';
import type { PaintTool } from './keys';
import type { PaintOptions } from './paint-options';
import type { Layers, Painter } from './painter';

type Position = Parameters<BrushTool['down']>[1];
type Layer = Layers['stack']['layers'][number];

/** Erases on the layer whose paint the pointer touches first: the selected one if it has paint there, else the uppermost. */
export class EraserTool implements PaintTool {
  /** Where the pointer was last, while it has touched no paint. */
  #waiting: { spot: Spot | undefined; position: Position } | undefined;
  /** The size of paintings that the user chose, while it is that of the layer. */
  #chosen: PaintingSize | undefined;
  #hasTold = false;

  /**
   * @param brush A brush that erases.
   * @param fix   Makes the stickers of a sheet paint.
   */
  constructor(
    private readonly brush: BrushTool,
    private readonly painter: Painter,
    private readonly options: PaintOptions,
    private readonly stack: Layers['stack'],
    private readonly fix: (sheet: StickersSheet) => void,
  ) {}

  down(spot: Spot | undefined, position: Position): boolean {
    if (this.#hasTold) clearError();
    this.#hasTold = false;
    if (!this.painter.aimOf(spot)?.surface) return false;
    // The brush says that there is nothing to erase yet.
    if (!this.stack.layers.some(({ sheet }) => sheet instanceof PaintedSheet)) return this.brush.down(spot, position);
    this.#waiting = { spot, position };
    this.#look(spot, position);
    return true;
  }

  move(spot: Spot | undefined, event: PointerEvent): void {
    this.#look(spot, event);
    if (this.#waiting) this.hover(spot, event);
    else this.brush.move(spot, event);
  }

  go(spot: Spot | undefined, position: Position): void {
    this.#look(spot, position);
    if (!this.#waiting) this.brush.go(spot, position);
  }

  up(): void {
    this.#hasTold = this.#waiting !== undefined;
    if (this.#waiting) showError('Nothing to erase here: the eraser takes away what was painted, not images.');
    else this.brush.up();
    this.#leave();
  }

  cancel(): void {
    this.brush.cancel();
    this.#leave();
  }

  hover(spot: Spot | undefined, event: PointerEvent): void {
    this.brush.hover(spot, event);
  }

  /** Begins to erase where the pointer was last, if it touches paint on its way to a spot. */
  #look(spot: Spot | undefined, position: Position): void {
    if (!this.#waiting) return;
    const layer = this.#layerOnWay(this.#waiting.spot, spot);
    if (layer) this.#begin(layer, this.painter.aimOf(this.#waiting.spot)?.surface ? this.#waiting : { spot, position });
    else this.#waiting = { spot, position };
  }

  #begin(layer: Layer, { spot, position }: { spot: Spot | undefined; position: Position }): void {
    const sheet = layer.sheet as PaintedSheet;
    this.#waiting = undefined;
    this.#chosen = this.options.texels;
    if (sheet instanceof StickersSheet && !sheet.fixed) this.fix(sheet);
    this.stack.select(layer);
    this.options.texels = sheet.size;
    this.brush.down(spot, position);
  }

  #leave(): void {
    this.#waiting = undefined;
    if (this.#chosen) this.options.texels = this.#chosen;
    this.#chosen = undefined;
  }

  /** The layer with paint that the brush touches between two spots, or at the second if the first is none of the surface. */
  #layerOnWay(start: Spot | undefined, end: Spot | undefined): Layer | undefined {
    const aim = this.painter.aimOf(end);
    const to = aim?.surface;
    if (!to) return undefined;
    const from = this.painter.aimOf(start)?.surface ?? to;
    const radius = this.options.size / 2 / aim!.scale;
    const { selected, layers } = this.stack;
    const touches = ({ sheet, visible }: Layer): boolean => {
      if (!visible || !(sheet instanceof PaintedSheet)) return false;
      const texels = this.painter.surfaceOf(sheet.size)?.cageTexels;
      if (!texels) return false;
      const ways: Capsule[] = [{ from, to, radius }];
      if (this.options.mirror) ways.push({ from: texels.mirrored(from), to: texels.mirrored(to), radius });
      return ways.some((way) => hasPaint(sheet, texels, way));
    };
    return selected && touches(selected) ? selected : layers.findLast(touches);
  }
}

/** Whether a sheet has paint within a capsule. */
function hasPaint(sheet: PaintedSheet, texels: CageTexels, capsule: Capsule): boolean {
  const { size } = sheet;
  return texels.touched(capsule, new Set()).some((part) => {
    const [left, top] = [Math.floor(part.left * size), Math.floor(part.top * size)];
    const [right, bottom] = [Math.ceil(part.right * size), Math.ceil(part.bottom * size)];
    const bytes = sheet.get({ left, top, right, bottom });
    for (let at = 3; at < bytes.length; at += 4) {
      if (bytes[at] === 0) continue;
      const texel = (at - 3) / 4;
      const [column, row] = [left + (texel % (right - left)), top + Math.floor(texel / (right - left))];
      const { point } = texels.at((column + 0.5) / size, (row + 0.5) / size) ?? {};
      if (point && distance(point, capsule) < capsule.radius) return true;
    }
    return false;
  });
}

/** The distance of a point from the line between the ends of a capsule. */
function distance(point: Vector3, { from, to }: Capsule): number {
  const way = to.point.clone().sub(from.point);
  const along = point.clone().sub(from.point).dot(way) / (way.lengthSq() || 1);
  return way
    .multiplyScalar(MathUtils.clamp(along, 0, 1))
    .add(from.point)
    .distanceTo(point);
}
