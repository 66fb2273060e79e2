import { element } from '../platform/page';
import type { Viewer } from '../view/viewer';
import type { BrushTool } from './brush-tool';
import type { StickerTool } from './sticker-tool';

/**
 * Lets the space bar press the tool in use on the middle of the picture. While it is held, the keys that turn the model
 * move the model under it.
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

  // On the stage, where it is heard after the viewer has turned the model.
  element('stage', HTMLElement).addEventListener('keydown', (keyEvent) => {
    if (keyEvent.target !== canvas || !tool || keyEvent.ctrlKey || keyEvent.metaKey || keyEvent.altKey) return;
    const { x, y } = viewer.middle;
    const at = { clientX: x, clientY: y };
    if (keyEvent.key === ' ') {
      keyEvent.preventDefault();
      if (!keyEvent.repeat && !pressed && tool.down(viewer.pick(x, y), at)) pressed = tool;
    } else {
      // The model has turned: on the screen the brush stayed where it was, on the model it moved.
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
