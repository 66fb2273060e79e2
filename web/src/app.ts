import { init } from 'cagecast';
import { setUpPainting } from './brush/set-up-painting';
import { Why } from './explain/explain';
import { Take } from './export/export-panel';
import { paintOf } from './export/linked-layers';
import { followLinks } from './export/links';
import { Edits } from './layers/edits';
import { followPaints, showComposite } from './layers/follow';
import { LayerList } from './layers/layer-list';
import { setUpSaving } from './layers/save';
import { LayerStack } from './layers/stack';
import { Live } from './live/live';
import { FitPanel } from './panels/fit';
import { PartsTable } from './panels/parts';
import { showResults } from './panels/results';
import { setUpRules } from './panels/rules';
import { setUpJump } from './panels/section-nav';
import { showStatus } from './panels/status';
import { History } from './platform/history';
import { keepOffline } from './platform/offline';
import { element } from './platform/page';
import { setUpUndo } from './platform/undo';
import { Opener } from './scene/open';
import { fetchAhead, loadSamples } from './scene/samples';
import { Session } from './scene/session';
import { ExactBorders } from './view/exact-borders';
import { showPicture } from './view/picture';
import { fadeStill } from './view/poster';
import { Tools } from './view/tool-rail';
import { setUpViewControls } from './view/view-controls';
import { showViewModes } from './view/view-modes';
import { Viewer } from './view/viewer';

/** Without WebGL the page still transfers. */
function startViewer(): Viewer | undefined {
  try {
    return new Viewer(element('view', HTMLCanvasElement));
  } catch {
    return undefined;
  }
}

/** Waits until the page is on the screen: making a picture in 3D can take a moment, and words come first. */
function painted(): Promise<unknown> {
  const frames = new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  // A page in the background has no frames.
  return Promise.race([frames, new Promise((done) => setTimeout(done, 200))]);
}

const samples = loadSamples();
// Begun while the files are on their way; told when they are waited for.
for (const early of [samples.then(([first]) => fetchAhead(first!)), init()]) early.catch(() => {});
await painted();

const session = new Session();
const viewer = startViewer();
// Each feature follows the session by itself. The picture comes first: what others lay on it needs it up to date.
const stack = new LayerStack();
const history = new History();
const edits = new Edits(stack, history);
followPaints(session, stack, edits);
let png: (() => Promise<Blob>) | undefined;
if (viewer) {
  showPicture(session, viewer);
  showViewModes(session, viewer);
  new ExactBorders(session, viewer);
  const composite = showComposite(viewer, stack);
  const tools = new Tools(viewer, element('stage', HTMLElement));
  setUpPainting(session, viewer, tools, { stack, composite, edits });
  new Why(session, viewer, tools);
  png = setUpSaving(viewer, composite);
} else element('why', HTMLElement).hidden = true;
new LayerList(stack, edits);
setUpUndo(history);
showStatus(session, viewer === undefined);
fadeStill(session, viewer);
showResults(session);
new PartsTable(session, viewer);
new FitPanel(session, viewer);
setUpRules(session);
setUpViewControls(session);
setUpJump();
const live = new Live(session, viewer);
const opener = new Opener(session, stack, edits, viewer?.renderer);
const { png: takenPng, layers } = paintOf(session, stack, edits, opener, png);
const linked = { session, layers, live, viewer };
const take = new Take(linked, takenPng);
stack.on('change', () => take.refresh());
keepOffline(session);

try {
  opener.listSamples(await samples);
  // Files of one's own may have come in while the list was on its way.
  if (!followLinks(linked, opener)) opener.openSample(opener.samples[0]!.name);
} catch (error) {
  session.fail(error);
}
