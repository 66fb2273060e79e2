import { element, showError } from '../platform/page';
import { readImage } from '../scene/paint';
import type { Session } from '../scene/session';
import type { RailTool, Tools } from '../view/tool-rail';
import type { Viewer } from '../view/viewer';
import { BrushTool } from './brush-tool';
import { paintByKeys } from './keys';
import { type Kind, PaintOptions } from './paint-options';
import { type Layers, Painter } from './painter';
import { Ring } from './ring';
import { StickerTool } from './sticker-tool';

/** Title, key and icon of each tool. */
const kRailTools: Record<Kind, Pick<RailTool, 'title' | 'key' | 'icon'>> = {
  brush: {
    title: 'Brush',
    key: 'b',
    icon: 'M14 10 20.500 3.500M10.500 10.500 3.500 20.500l10-7a2.500 2.500 0 0 0-3-3z',
  },
  eraser: { title: 'Erase', key: 'e', icon: 'M9 19h11M4.500 14.500 14 5l5 5-9 9H8zM9.500 9.500l5 5' },
  sticker: { title: 'Sticker', key: 's', icon: 'M5 4h14v9l-6 7H5zM13 20v-7h6' },
};

/** Adds brush, eraser and stickers to the tool rail, with their options below the layers. */
export function setUpPainting(session: Session, viewer: Viewer, tools: Tools, layers: Layers): void {
  const options = new PaintOptions();
  const painter = new Painter(session, viewer, layers, options);
  const ring = new Ring();
  const sticker = new StickerTool(painter, viewer, options, ring);
  const chosen = {
    brush: new BrushTool(painter, options, ring, false),
    eraser: new BrushTool(painter, options, ring, true),
    sticker,
  };
  const keys = paintByKeys(viewer);
  for (const kind of ['brush', 'eraser', 'sticker'] as const) {
    tools.add({
      ...kRailTools[kind],
      tool: chosen[kind],
      onChoose(on) {
        options.show(on ? kind : undefined);
        keys.use(on ? chosen[kind] : undefined);
        ring.hide();
        // Make sure that the paint is visible.
        const { mode } = session.view;
        if (on)
          session.setView({ paint: true, ...(mode === 'compare' || mode === 'result' ? {} : { mode: 'result' }) });
      },
    });
  }

  const canvas = element('view', HTMLCanvasElement);
  canvas.addEventListener('webglcontextlost', () => painter.cancel());
  canvas.addEventListener('webglcontextrestored', () => painter.restore());
  element('add-painting', HTMLButtonElement).addEventListener('click', () =>
    layers.edits.do('adding a painting', () => painter.addLayer()),
  );
  const image = element('sticker-image', HTMLInputElement);
  image.addEventListener('change', async () => {
    const file = image.files?.[0];
    image.value = ''; // so that the same file can be chosen again
    try {
      if (file) sticker.setImage(await readImage(file));
    } catch (error) {
      showError((error as Error).message);
    }
  });
}
