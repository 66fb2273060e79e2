import type { PointerPosition } from '#three';
import { element } from '../../platform/page';
import type { Spot } from '../../view/pick';
import type { Tool } from '../../view/pointing';
import type { ScreenSpace } from '../../view/screen-space';

/** A tool that keys can apply too. */
export interface PaintTool extends Pick<Tool, 'move' | 'cancel' | 'hover'> {
  down?(spot: Spot | undefined, at: PointerPosition & { altKey?: boolean }): boolean;
  /** Goes on in a straight line. */
  go?(spot: Spot | undefined, at: PointerPosition): void;
  up?(): void;
  tap?(spot: Spot | undefined): void;
}

/**
 * Applies the chosen tool at the centre of the view while the space bar is held. The keys that turn the model then move it
 * under the tool.
 */
export function paintByKeys(screen: ScreenSpace): { use(tool: PaintTool | undefined): void } {
  const canvas = element('view', HTMLCanvasElement);
  const cross = document.createElement('div');
  cross.className = 'cross';
  cross.hidden = true;
  canvas.after(cross);
  let tool: PaintTool | undefined;
  let pressed: typeof tool;

  const release = (): void => {
    pressed?.up?.();
    pressed = undefined;
  };

  // On the stage, so that it runs after the viewer has turned the model.
  element('stage', HTMLElement).addEventListener('keydown', (keyEvent) => {
    if (keyEvent.target !== canvas || !tool || keyEvent.ctrlKey || keyEvent.metaKey || keyEvent.altKey) return;
    const { x, y } = screen.center;
    const at = { clientX: x, clientY: y };
    if (keyEvent.key === ' ') {
      keyEvent.preventDefault();
      if (keyEvent.repeat || pressed) return;
      const spot = screen.pick(x, y);
      if (tool.down?.(spot, at)) pressed = tool;
      else tool.tap?.(spot);
    } else {
      // The model turned under the centre: extend the stroke to the new spot.
      pressed?.go?.(screen.pick(x, y), at);
    }
  });
  canvas.addEventListener('keyup', ({ key }) => key === ' ' && release());
  canvas.addEventListener('blur', release);
  return {
    use(other) {
      release();
      tool = other;
      cross.hidden = !other;
    },
  };
}
