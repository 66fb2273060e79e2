import type { Question } from '../../platform/ask';
import { element } from '../../platform/page';
import type { Session } from '../../state/session';
import { showsPaint } from '../../state/view-state';
import type { RailTool, Tools } from '../../view/tool-rail';
import type { Viewer } from '../../view/viewer';
import { BrushTool } from './brush-tool';
import { EraserTool } from './eraser-tool';
import { Eyedropper } from './eyedropper';
import { FillTool } from './fill-tool';
import { holdImages } from './hold-images';
import { type PaintTool, paintByKeys } from './keys';
import { type Kind, PaintOptions } from './paint-options';
import { type Layers, Painter } from './painter';
import { Ring } from './ring';
import { StickerTool } from './sticker-tool';
import { Swatches } from './swatches';

/** Title, key and icon of each tool. */
const kRailTools: Record<Kind, Pick<RailTool, 'title' | 'key' | 'icon'>> = {
  brush: {
    title: 'Brush',
    key: 'b',
    icon: 'M14 10 20.5 3.5M10.5 10.5 3.5 20.5l10-7a2.5 2.5 0 0 0-3-3z',
  },
  eraser: { title: 'Erase', key: 'e', icon: 'M9 19h11M4.5 14.5 14 5l5 5-9 9H8zM9.5 9.5l5 5' },
  sticker: { title: 'Sticker', key: 's', icon: 'M5 4h14v9l-6 7H5zM13 20v-7h6' },
  fill: { title: 'Fill', key: 'f', icon: 'M11 4 4 11l7 7 7-7-9.5-9.5M4.5 11h13M20 15c2 3 1.5 5 0 5s-2-2 0-5z' },
};

/** What paints. */
interface Painting {
  painter: Painter;
  /** Lets an image be placed as a sticker. @returns What else can be done with it. */
  hold(image: ImageBitmap): Question['answers'];
}

/** Adds brush, eraser, stickers and filling to the tool rail, with their options below the layers. */
export function setUpPainting(session: Session, viewer: Viewer, tools: Tools, layers: Layers): Painting {
  const options = new PaintOptions();
  const painter = new Painter(session, viewer, layers, options);
  const ring = new Ring();
  const sticker = new StickerTool(painter, viewer, options, layers);
  painter.settle = () => sticker.showPlaced();
  const eyedropper = new Eyedropper(painter, viewer, layers.composite, options);
  const swatches = new Swatches(options);
  painter.on('painted', () => swatches.use(options.color));
  const eraser = new EraserTool(
    new BrushTool(painter, options, ring, true),
    painter,
    options,
    layers.stack,
    // Stickers that are to be erased become paint first.
    (sheet) => sticker.fix(sheet),
  );
  const chosen: Record<Kind, PaintTool> = {
    brush: eyedropper.before(new BrushTool(painter, options, ring, false)),
    eraser,
    sticker: eyedropper.before(sticker),
    fill: eyedropper.before(new FillTool(painter, options)),
  };
  const keys = paintByKeys(viewer.screen);
  const offers = {} as Record<Kind, RailTool>;
  for (const kind of ['brush', 'eraser', 'sticker', 'fill'] as const) {
    tools.add(
      (offers[kind] = {
        ...kRailTools[kind],
        tool: chosen[kind],
        onChoose(on) {
          options.show(on ? kind : undefined);
          keys.use(on ? chosen[kind] : undefined);
          ring.hide();
          eyedropper.set(false);
          sticker.leave();
          // Make sure that the paint is visible.
          const { mode } = session.view;
          if (on)
            session.setView({ paint: true, ...(mode === 'compare' || mode === 'result' ? {} : { mode: 'result' }) });
        },
      }),
    );
  }
  // Nobody paints unseen.
  session.on('view', ({ mode, paint }) => {
    if (Object.values(offers).includes(tools.chosen!) && !(paint && showsPaint(mode))) tools.choose(undefined);
  });

  const canvas = element('view', HTMLCanvasElement);
  element('stage', HTMLElement).addEventListener('keydown', ({ key, target, ctrlKey, metaKey, altKey }) => {
    if (ctrlKey || metaKey || altKey || target instanceof HTMLInputElement) return;
    if (key === '[' || key === ']') options.stepSize(key === '[' ? -1 : 1);
    else if (key === 'Delete' || key === 'Backspace') sticker.remove();
    else if (key.toLowerCase() === 'i') {
      if (!tools.chosen || tools.chosen === offers.eraser) tools.choose(offers.brush);
      eyedropper.set(!eyedropper.on);
    }
  });
  const showKeys = async (): Promise<void> => (await import('./shortcuts')).showShortcuts();
  element('shortcuts', HTMLButtonElement).addEventListener('click', () => void showKeys());
  addEventListener('keydown', ({ key, target }) => {
    const isWriting = target instanceof HTMLInputElement && target.type === 'text';
    if (key === '?' && !isWriting) void showKeys();
  });
  canvas.addEventListener('webglcontextlost', () => painter.cancel());
  canvas.addEventListener('webglcontextrestored', () => {
    sticker.restore();
    painter.restore();
  });
  element('add-painting', HTMLButtonElement).addEventListener('click', () =>
    layers.edits.do('adding a painting', () => painter.addLayer()),
  );
  const hold = holdImages(session, layers, sticker, (on) => tools.choose(on ? offers.sticker : undefined));
  return { painter, hold };
}
