import type { Spot } from '../../view/pick';
import type { PaintTool } from './keys';
import type { PaintOptions } from './paint-options';
import type { Painter } from './painter';

/** Fills the part that is clicked: all of it that may be painted. A drag turns the model. */
export class FillTool implements PaintTool {
  constructor(
    private readonly painter: Painter,
    private readonly options: PaintOptions,
  ) {}

  tap(spot: Spot | undefined): void {
    const uvs = spot && this.painter.uvsOfPart(spot);
    if (!uvs || uvs.length === 0) return;
    const { color, opacity } = this.options;
    this.painter.telling(() => {
      this.painter.begin('fill', { color, opacity, hardness: 1, erases: false });
      this.painter.fill(uvs);
      this.painter.end();
      return true;
    });
  }
}
