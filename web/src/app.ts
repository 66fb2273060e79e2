import { init } from 'cagecast';
import { Edits, History, LayerStack } from 'cagecast/three/paint';
import type { Texture } from 'three';
import { Explain } from './explain/explain-tool';
import { ExportPanel } from './export/export-panel';
import { exportedPaint } from './export/linked-layers';
import { followLinks } from './export/links';
import { Drawings } from './loading/drawn/drawings';
import { loaderFor } from './loading/load-model';
import { makeChecker } from './loading/load-paint';
import { Opener } from './loading/opener';
import { fetchAhead, loadSamples } from './loading/samples';
import { TransferClient } from './loading/transfer-client';
import { beginProjects } from './panels/begin-projects';
import { setUpCagePanel } from './panels/cage-panel';
import { carryOver } from './panels/carry-over';
import { FitPanel } from './panels/fit-panel';
import { LayerList } from './panels/layer-list';
import { setUpMethod } from './panels/method';
import { offerGuide } from './panels/offer-guide';
import { PartMenu } from './panels/part-menu';
import { PartsTable } from './panels/parts-table';
import { setUpPicture } from './panels/picture-panel';
import { fadePoster, removeOtherPoster } from './panels/poster';
import { offerPutAway } from './panels/put-away-layers';
import { showResults } from './panels/results';
import { setUpRules } from './panels/rules';
import { setUpSaving } from './panels/save-texture';
import { goTo, setUpSectionNav } from './panels/section-nav';
import { setUpWardrobe } from './panels/set-up-wardrobe';
import { showStatus } from './panels/status';
import { recordControls } from './panels/steps';
import { ThresholdMarks } from './panels/threshold-marks';
import { face, setUpFaces } from './platform/face';
import { catchLostFocus } from './platform/lost-focus';
import { keepOffline } from './platform/offline';
import { announce, element } from './platform/page';
import { setUpUndo } from './platform/undo';
import { CageMaker } from './state/cage-maker';
import { followPaints } from './state/follow-paints';
import { PutAwayLayers } from './state/put-away-layers';
import { Session } from './state/session';
import { setUpCageTools } from './tools/cage/set-up-cage-tools';
import { Live } from './tools/live/live-panel';
import type { Painter } from './tools/paint/painter';
import { setUpPainting } from './tools/paint/set-up-painting';
import { ExactBorders } from './view/exact-borders';
import { showComposite } from './view/show-composite';
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
removeOtherPoster();
catchLostFocus();
setUpFaces();
await painted();

const session = new Session(new TransferClient(), makeChecker());
const viewer = startViewer();
const loader = loaderFor(viewer?.renderer);
// Each feature follows the session by its events. The order matters: the model comes before what is drawn on it.
const stack = new LayerStack();
const history = new History();
const edits = new Edits(stack, history);
const away = new PutAwayLayers(session, stack, edits); // before the paint of a sample goes
followPaints(session, stack, edits);
offerPutAway(away, viewer && (() => carryOver(session, away, viewer.renderer)));
const engine = () => import('cagecast/cages');
const maker = new CageMaker({ session, loader, engine, announce });
setUpCagePanel(session, maker);
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
  setUpMethod(session, viewer);
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
setUpSectionNav(session);
setUpStageButtons(viewer?.controls, history);
element('stage-share', HTMLButtonElement).addEventListener('click', () => goTo(element('share', HTMLElement)));
const live = new Live(session, viewer);
recordControls(session, live, history);
const opener = new Opener(session, stack, edits, loader, new Drawings());
opener.cageFor = (target) => maker.cageFor(target);
const { png: exportPng, layers } = exportedPaint(session, stack, edits, opener, png);
const wardrobe =
  viewer &&
  paint &&
  setUpWardrobe({ session, loader, viewer, stack, paint, png: exportPng, samples: () => opener.samples });
if (wardrobe) opener.takesDrop = (files) => wardrobe.take(files);
const linked = { session, layers, live, controls: viewer?.controls };
const exportPanel = new ExportPanel(linked, exportPng);
stack.on('change', () => exportPanel.refresh());
// Whoever brings a model wants to see it painted, not compared.
session.on('transfer', ({ target }) => {
  if (!target.sample && face() === 'play' && session.view.mode === 'compare') session.setView({ mode: 'result' });
});
const restoreWork = beginProjects({
  session,
  stack,
  edits,
  history,
  maker,
  away,
  opener,
  loader,
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
