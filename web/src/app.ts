import { init } from 'cagecast';
import { type Composite, Edits, History, LayerStack } from '#three';
import { Drawings } from './loading/drawn/drawings';
import { loaderFor } from './loading/load-model';
import { makeChecker } from './loading/load-paint';
import { Opener } from './loading/opener';
import { setUpShelf } from './loading/paint-picker';
import { fetchAhead, loadSamples } from './loading/samples';
import { TransferClient } from './loading/transfer-client';
import { watchOver } from './loading/watch-over';
import { setUpCagePanel } from './panels/cage-panel';
import { LayerList } from './panels/layer-list';
import { PartMenu } from './panels/part-menu';
import { fadePoster, removeOtherPoster } from './panels/poster';
import { offerPutAway } from './panels/put-away-layers';
import { showResults } from './panels/results';
import { setUpRules } from './panels/rules';
import { setUpSectionNav } from './panels/section-nav';
import { showStatus } from './panels/status';
import { FitPanel } from './panels/verdict/fit-panel';
import { face, onFace, setUpFaces } from './platform/face';
import { setUpLanguage } from './platform/language';
import { catchLostFocus } from './platform/lost-focus';
import { announce, element } from './platform/page';
import { flags } from './platform/shelf';
import { setUpUndo } from './platform/undo';
import { CageMaker } from './state/cage-maker';
import { followPaints } from './state/follow-paints';
import { PutAwayLayers } from './state/put-away-layers';
import { Session } from './state/session';
import { setUpCageTools } from './tools/cage/set-up-cage-tools';
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

/** Shows models, and paint on them, in the view. */
function setUpStage(viewer: Viewer): { viewer: Viewer; tools: Tools; composite: Composite } {
  showModel(session, viewer);
  showViewModes(session, viewer.stage);
  new ExactBorders(session, viewer.stage);
  const composite = showComposite(viewer, stack);
  const tools = new Tools(viewer, element('stage', HTMLElement));
  new PartMenu(session, viewer);
  setUpCageTools(session, viewer, tools, maker, history);
  return { viewer, tools, composite };
}

const samples = loadSamples();
watchOver('The samples', samples, () => location.reload());
// Start early; errors are reported where the results are awaited.
for (const early of [samples.then(([first]) => fetchAhead(first!)), init()]) early.catch(() => {});
removeOtherPoster();
catchLostFocus();
setUpLanguage();
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
offerPutAway(
  away,
  viewer && (async () => (await import('./panels/carry-over')).carryOver(session, away, viewer.renderer)),
);
const engine = () => import('cagecast/cages');
const maker = new CageMaker({ session, loader, engine, announce });
setUpCagePanel(session, maker);
const stage = viewer && setUpStage(viewer);
if (!stage) {
  element('open-wardrobe', HTMLButtonElement).hidden = true;
}
new LayerList(stack, edits);
setUpUndo(history); // before what copies its buttons
showStatus(session, viewer === undefined);
fadePoster(session, viewer);
showResults(session);
new FitPanel(session, viewer, maker);
setUpRules(session);
setUpViewControls(session);
setUpShelf(); // before what lists the sections
setUpSectionNav(session, (open) => void viewer?.lookAtFace(open));
setUpStageButtons(viewer, history);
// Whoever brings a model wants to see it painted, not compared.
session.on('transfer', ({ target }) => {
  document.documentElement.toggleAttribute('data-own', !target.sample); // who has one needs no motto
  if (!target.sample && face() === 'play' && session.view.mode === 'compare') session.setView({ mode: 'result' });
});
const opener = new Opener(session, stack, edits, loader, new Drawings());
opener.cageFor = (target) => maker.cageFor(target);

let added: Promise<() => Promise<boolean>> | undefined;

/** Adds all other features. @returns As `addFeatures`. */
const complete = (): Promise<() => Promise<boolean>> => (added ??= add());

async function add(): Promise<() => Promise<boolean>> {
  const { addFeatures } = await import('./features');
  const page = { session, stack, history, edits, away, maker, loader, opener, stage };
  const open = session.joinLate(() => addFeatures(page));
  let inspect: Promise<void> | undefined;
  onFace((shown) => {
    if (shown === 'inspect') inspect ??= addInspect();
  });
  await inspect;
  document.documentElement.dataset.complete = ''; // for tests
  return open;
}

/** Adds what only Inspect has. */
async function addInspect(): Promise<void> {
  const inspect = await import('./panels/study/inspect');
  session.joinLate(() => inspect.addInspect(session, stage));
}

/** Waits until the first model is judged, or somebody is about to use the page. */
function judgedOrUsed(): Promise<unknown> {
  const kUses = ['pointermove', 'pointerdown', 'keydown', 'focusin', 'dragenter'];
  return Promise.race([
    new Promise((done) => session.on('inspected', done)),
    new Promise((done) => session.on('progress', ({ state }) => state === 'failed' && done(state))),
    ...kUses.map((name) => new Promise((done) => addEventListener(name, done, { once: true }))),
  ]);
}

opener.onProject = (file) => void complete().then(() => opener.onProject!(file));
try {
  opener.listSamples(await samples);
  const showFirst = (): void => opener.openSample(opener.samples[0]!.name);
  if (!session.begun && !flags.get('work') && !location.hash) {
    showFirst();
    await judgedOrUsed();
  }
  const isOpening = await (await complete())();
  if (!isOpening) showFirst();
} catch (error) {
  session.fail(error);
  await complete();
}
