import { element } from '../platform/page';
import type { Viewer } from '../view/viewer';
import type { BrushTool } from './brush-tool';
import type { StickerTool } from './sticker-tool';

/**
 * Applies the chosen tool at the centre of the view while the space bar is held. The keys that turn the model then move it
 * under the tool.
 */
export function paintByKeys(viewer: Viewer): { use(tool: BrushTool | StickerTool | undefined): void } {
  const canvas = element('view', HTMLCanvasElement);
  const cross = document.createElement('div');
  cross.className = 'cross';
  cross.hidden = true;
  canvas.after(cross);
  let tool: BrushTool | StickerTool | undefined;
  let pressed: typeof tool;

  const release = (): void => {
    pressed?.up();
    pressed = undefined;
  };

  // On the stage, so that it runs after the viewer has turned the model.
  element('stage', HTMLElement).addEventListener('keydown', (keyEvent) => {
    if (keyEvent.target !== canvas || !tool || keyEvent.ctrlKey || keyEvent.metaKey || keyEvent.altKey) return;
    const { x, y } = viewer.center;
    const at = { clientX: x, clientY: y };
    if (keyEvent.key === ' ') {
      keyEvent.preventDefault();
      if (!keyEvent.repeat && !pressed && tool.down(viewer.pick(x, y), at)) pressed = tool;
    } else {
      // The model turned under the centre: extend the stroke to the new spot.
      pressed?.go(viewer.pick(x, y), at);
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
