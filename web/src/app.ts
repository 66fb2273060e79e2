import { init } from 'cagecast';
import { Edits, History, LayerStack } from 'cagecast/three/paint';
import type { Texture } from 'three';
import type { Painter } from './brush/painter';
import { setUpPainting } from './brush/set-up-painting';
import { setUpCageTools } from './cage/set-up';
import { Explain } from './explain/explain-tool';
import { ExportPanel } from './export/export-panel';
import { exportedPaint } from './export/linked-layers';
import { followLinks } from './export/links';
import { followPaints, showComposite } from './layers/follow';
import { LayerList } from './layers/layer-list';
import { setUpSaving } from './layers/save';
import { Live } from './live/live-panel';
import { keepOffline } from './offline';
import { FitPanel } from './panels/fit-panel';
import { offerGuide } from './panels/offer-guide';
import { PartMenu } from './panels/part-menu';
import { PartsTable } from './panels/parts-table';
import { setUpPicture } from './panels/picture-panel';
import { showResults } from './panels/results';
import { setUpRules } from './panels/rules';
import { setUpSectionNav } from './panels/section-nav';
import { showStatus } from './panels/status';
import { recordControls } from './panels/steps';
import { ThresholdMarks } from './panels/threshold-marks';
import { catchLostFocus } from './platform/lost-focus';
import { element } from './platform/page';
import { setUpUndo } from './platform/undo';
import { fadePoster, removeOtherPoster } from './poster';
import { beginProjects } from './project/begin';
import { CageMaker } from './scene/cage-maker';
import { Opener } from './scene/opener';
import { putAwayLayers } from './scene/put-away-layers';
import { fetchAhead, loadSamples } from './scene/samples';
import { Session } from './scene/session';
import { ExactBorders } from './view/exact-borders';
import { showModel } from './view/show-model';
import { setUpStageButtons } from './view/stage-buttons';
import { Tools } from './view/tool-rail';
import { setUpViewControls } from './view/view-controls';
import { showViewModes } from './view/view-modes';
import { Viewer } from './view/viewer';
import { setUpWardrobe } from './wardrobe/set-up-wardrobe';

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
removeOtherPoster();
catchLostFocus();
await painted();

const session = new Session();
const viewer = startViewer();
// Each feature follows the session by its events. The order matters: the model comes before what is drawn on it.
const stack = new LayerStack();
const history = new History();
const edits = new Edits(stack, history);
followPaints(session, stack, edits);
const away = putAwayLayers(session, stack, edits);
const maker = new CageMaker(session, viewer?.renderer);
let png: (() => Promise<Blob>) | undefined;
let paint: Texture | undefined;
let painter: Painter | undefined;
if (viewer) {
  showModel(session, viewer);
  showViewModes(session, viewer.stage);
  new ExactBorders(session, viewer.stage);
  const composite = showComposite(viewer, stack);
  paint = composite.texture;
  const tools = new Tools(viewer, element('stage', HTMLElement));
  painter = setUpPainting(session, viewer, tools, { stack, composite, edits });
  new Explain(session, viewer, tools);
  new PartMenu(session, viewer);
  setUpCageTools(session, viewer, tools, maker, history);
  setUpPicture(session, viewer);
  png = setUpSaving(viewer, composite);
} else {
  element('explain', HTMLElement).hidden = true;
  element('open-wardrobe', HTMLButtonElement).hidden = true;
}
new LayerList(stack, edits);
setUpUndo(history);
showStatus(session, viewer === undefined);
fadePoster(session, viewer);
showResults(session);
new PartsTable(session, viewer?.stage);
new FitPanel(session, viewer?.stage, maker);
setUpRules(session);
new ThresholdMarks(session);
setUpViewControls(session);
setUpSectionNav();
setUpStageButtons(viewer?.controls, history);
const live = new Live(session, viewer);
recordControls(session, live, history);
const opener = new Opener(session, stack, edits, viewer?.renderer);
const { png: exportPng, layers } = exportedPaint(session, stack, edits, opener, png);
const wardrobe =
  viewer && paint && setUpWardrobe({ session, viewer, stack, paint, png: exportPng, samples: () => opener.samples });
if (wardrobe) opener.takesDrop = (files) => wardrobe.take(files);
const linked = { session, layers, live, controls: viewer?.controls };
const exportPanel = new ExportPanel(linked, exportPng);
stack.on('change', () => exportPanel.refresh());
const restoreWork = beginProjects({
  session,
  stack,
  edits,
  history,
  maker,
  away,
  opener,
  painter,
  live,
  viewer,
  wardrobe,
});
keepOffline(session);
offerGuide(session);

try {
  opener.listSamples(await samples);
  const failed = await restoreWork();
  // The user may have opened files, or work was brought back.
  if (!followLinks(linked, opener) || (failed && !location.hash)) opener.openSample(opener.samples[0]!.name);
} catch (error) {
  session.fail(error);
}
