import { init } from 'cagecast';
import { Edits, History, LayerStack } from 'cagecast/three/layers';
import { setUpPainting } from './brush/set-up-painting';
import { Explain } from './explain/explain-tool';
import { ExportPanel } from './export/export-panel';
import { exportedPaint } from './export/linked-layers';
import { followLinks } from './export/links';
import { followPaints, showComposite } from './layers/follow';
import { LayerList } from './layers/layer-list';
import { setUpSaving } from './layers/save';
import { Live } from './live/live-panel';
import { FitPanel } from './panels/fit-panel';
import { PartMenu } from './panels/part-menu';
import { PartsTable } from './panels/parts-table';
import { showResults } from './panels/results';
import { setUpRules } from './panels/rules';
import { setUpSectionNav } from './panels/section-nav';
import { showStatus } from './panels/status';
import { warnBeforeLeaving } from './platform/leave';
import { keepOffline } from './platform/offline';
import { element } from './platform/page';
import { setUpUndo } from './platform/undo';
import { CageMaker } from './scene/cage-maker';
import { Opener } from './scene/opener';
import { putAwayLayers } from './scene/put-away-layers';
import { fetchAhead, loadSamples } from './scene/samples';
import { Session } from './scene/session';
import { ExactBorders } from './view/exact-borders';
import { fadePoster } from './view/poster';
import { showModel } from './view/show-model';
import { setUpStageButtons } from './view/stage-buttons';
import { Tools } from './view/tool-rail';
import { setUpViewControls } from './view/view-controls';
import { showViewModes } from './view/view-modes';
import { Viewer } from './view/viewer';

/** Undefined without WebGL; the page still transfers then. */
function startViewer(): Viewer | undefined {
  try {
    return new Viewer(element('view', HTMLCanvasElement));
  } catch {
    return undefined;
  }
}

/** Waits for the first paint of the page: starting WebGL takes a moment, and text should appear first. */
function painted(): Promise<unknown> {
  const frames = new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  // Pages in the background have no frames.
  return Promise.race([frames, new Promise((done) => setTimeout(done, 200))]);
}

const samples = loadSamples();
// Start early; errors are reported where the results are awaited.
for (const early of [samples.then(([first]) => fetchAhead(first!)), init()]) early.catch(() => {});
await painted();

const session = new Session();
const viewer = startViewer();
// Each feature follows the session by its events. The order matters: the model comes before what is drawn on it.
const stack = new LayerStack();
const history = new History();
const edits = new Edits(stack, history);
followPaints(session, stack, edits);
putAwayLayers(session, stack, edits);
let png: (() => Promise<Blob>) | undefined;
if (viewer) {
  showModel(session, viewer);
  showViewModes(session, viewer);
  new ExactBorders(session, viewer);
  const composite = showComposite(viewer, stack);
  const tools = new Tools(viewer, element('stage', HTMLElement));
  setUpPainting(session, viewer, tools, { stack, composite, edits });
  new Explain(session, viewer, tools);
  new PartMenu(session, viewer);
  png = setUpSaving(viewer, composite);
} else element('explain', HTMLElement).hidden = true;
new LayerList(stack, edits);
setUpUndo(history);
warnBeforeLeaving(history);
showStatus(session, viewer === undefined);
fadePoster(session, viewer);
showResults(session);
new PartsTable(session, viewer);
const maker = new CageMaker(session, viewer?.renderer);
new FitPanel(session, viewer, maker);
setUpRules(session);
setUpViewControls(session);
setUpSectionNav();
setUpStageButtons(viewer, history);
const live = new Live(session, viewer);
const opener = new Opener(session, stack, edits, viewer?.renderer);
const { png: exportPng, layers } = exportedPaint(session, stack, edits, opener, png);
const linked = { session, layers, live, viewer };
const exportPanel = new ExportPanel(linked, exportPng);
stack.on('change', () => exportPanel.refresh());
keepOffline(session);

try {
  opener.listSamples(await samples);
  // The user may have opened files while the list was loading.
  if (!followLinks(linked, opener)) opener.openSample(opener.samples[0]!.name);
} catch (error) {
  session.fail(error);
}
