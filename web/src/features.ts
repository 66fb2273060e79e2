// What the first picture and its verdict do without.
import type { Composite, Edits, History, LayerStack } from '#three';
import { FilmStrip } from './explain/film-strip';
import { ExportPanel } from './export/export-panel';
import { exportedPaint } from './export/linked-layers';
import { followLinks } from './export/links';
import { ShareSheet } from './export/share-sheet';
import { Strokes } from './export/strokes';
import type { Opener } from './loading/opener';
import { beginProjects } from './panels/begin-projects';
import { offerGuide } from './panels/offer-guide';
import { setUpSaving } from './panels/save-texture';
import { setUpWardrobe } from './panels/set-up-wardrobe';
import { recordControls } from './panels/steps';
import { keepOffline } from './platform/offline';
import { flags } from './platform/shelf';
import type { CageMaker } from './state/cage-maker';
import type { Loader } from './state/model';
import type { PutAwayLayers } from './state/put-away-layers';
import type { Session } from './state/session';
import { Live } from './tools/live/live-panel';
import { setUpPainting } from './tools/paint/set-up-painting';
import { rollOnFirst } from './view/overlay/roll-on';
import type { Tools } from './view/tool-rail';
import type { Viewer } from './view/viewer';

/** What the page began with. */
interface Begun {
  session: Session;
  stack: LayerStack;
  history: History;
  edits: Edits;
  away: PutAwayLayers;
  maker: CageMaker;
  loader: Loader;
  opener: Opener;
  /** Undefined without WebGL. */
  stage: { viewer: Viewer; tools: Tools; composite: Composite } | undefined;
}

/**
 * Adds all other features to the page.
 * @returns Brings kept work back, or what the link in the page's URL says. It says whether anything is being opened.
 */
export function addFeatures({ stage, ...page }: Begun): () => Promise<boolean> {
  const { session, stack, history, edits, opener } = page;
  const { viewer } = stage ?? {};
  const painting =
    stage && setUpPainting(session, stage.viewer, stage.tools, { stack, composite: stage.composite, edits });
  if (stage) {
    new FilmStrip(session, stage.viewer);
    // Work that is brought back was seen before.
    if (!flags.get('work')) rollOnFirst(session, stage.viewer, stage.composite.texture);
    new ShareSheet(session, stage.viewer, { stack, paint: stage.composite.texture });
  }
  const live = new Live(session, viewer);
  recordControls(session, live, history);
  const saved = stage && setUpSaving(stage.viewer, stage.composite);
  const { png, layers } = exportedPaint(
    session,
    stack,
    edits,
    { opener, strokes: new Strokes(viewer?.renderer) },
    saved,
  );
  const wardrobe =
    stage &&
    setUpWardrobe({
      ...{ session, loader: page.loader, maker: page.maker, viewer: stage.viewer },
      ...{ stack, drawings: opener.drawings, paint: stage.composite.texture, png },
      samples: () => opener.samples,
    });
  opener.wardrobe = wardrobe;
  opener.onPicture = painting?.hold;
  const linked = { session, layers, live, maker: page.maker, controls: viewer?.controls };
  const exportPanel = new ExportPanel(linked, png);
  for (const event of ['change', 'pictures'] as const) stack.on(event, () => exportPanel.refresh());
  const restoreWork = beginProjects({ ...page, painter: painting?.painter, live, viewer, wardrobe });
  keepOffline(session);
  offerGuide(session);
  return async () => {
    const failed = await restoreWork();
    // The user may have opened files, or work was brought back.
    return followLinks(linked, opener) && !(failed && !location.hash);
  };
}
