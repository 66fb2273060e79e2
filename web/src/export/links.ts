import type { Opener } from '../loading/opener';
import { ask } from '../platform/ask';
import { element } from '../platform/page';
import type { CageMaker } from '../state/cage-maker';
import type { Shown } from '../state/scene';
import type { Session } from '../state/session';
import type { Live } from '../tools/live/live-panel';
import type { CameraControls } from '../view/camera-controls';
import {
  kStandIns,
  type LinkedLayer,
  type LinkState,
  type Look,
  readLink,
  readLook,
  writeLink,
  writeLook,
} from './link';

/** The layers that a link can carry. */
export interface LinkedLayers {
  /** Those of a link, from the lowest to the uppermost, and the names of all others: the user's own paints, and too many strokes. */
  write(): Promise<{ layers: LinkedLayer[]; omitted: readonly string[] }>;
  /** Restores them once the sample is loaded. Paints that the page does not have are left out. */
  restore(layers: LinkedLayer[]): void;
}

/** The sources of a link. */
export interface Linked {
  session: Session;
  layers: LinkedLayers;
  live: Live;
  maker: CageMaker;
  /** Undefined without WebGL. */
  controls: CameraControls | undefined;
}

/** A link to what is shown: a sample as it is seen, or the look of a model of one's own. */
export interface Link {
  /** The URL fragment, with `#`. */
  hash: string;
  isLook: boolean;
  /** Names of the layers that it leaves out. */
  omitted: readonly string[];
}

/** What is said of a link of which something cannot be read. */
export const kDamagedLink = {
  text: 'The link is cut off or damaged. What can be read of it is shown; ask for it again.',
  answers: [],
};

/** The state for a link. @returns Undefined if the model is not a sample. */
function stateOf({
  session: { shown, rules, locks, view },
  live,
  controls,
}: Linked): Omit<LinkState, 'layers'> | undefined {
  const sample = shown?.target.sample;
  if (!sample || sample !== shown.cage.sample) return undefined;
  const { shape } = live;
  const rests = shape.amount === 0 && shape.morphs.size === 0;
  return { sample: sample.name, rules, locks, view, shape: rests ? undefined : shape, angle: controls?.angle };
}

/** The link to what is shown. @returns Undefined if its cage belongs to it alone, so that nothing else can wear its look. */
export async function linkOf(linked: Linked): Promise<Link | undefined> {
  const { light, background } = linked.session.view;
  const template = stateOf(linked) ? undefined : await linked.maker.template();
  const { layers, omitted } = await linked.layers.write();
  const state = stateOf(linked);
  if (state) return { hash: `#${writeLink({ ...state, layers })}`, isLook: false, omitted };
  return template && { hash: `#${writeLook({ template, layers, light, background })}`, isLook: true, omitted };
}

/**
 * Restores what the page's URL says, now (unless the user opened something already) and whenever it changes. What cannot be read of
 * it is said.
 * @returns Whether anything is being opened.
 */
export function followLinks(linked: Linked, opener: Opener): boolean {
  const restore = (): boolean => {
    const { hash } = location;
    const look = readLook(hash);
    const state = readLink(hash);
    if (look) openLook(linked, opener, look);
    else if (state && opener.samples.some(({ name }) => name === state.sample)) openState(linked, opener, state);
    else {
      if (/[#&](look|sample)=/.test(hash)) ask(kDamagedLink);
      return false;
    }
    return true;
  };
  addEventListener('hashchange', async () => {
    // A look that cannot be written, such as while it changes, is another one.
    if (!(await isShown(linked).catch(() => false))) restore();
  });
  return linked.session.begun || restore();
}

/** Whether the page shows already what its URL says; a sample is turned as it says. */
async function isShown(linked: Linked): Promise<boolean> {
  const { hash } = location;
  const link = linked.session.shown && (await linkOf(linked));
  if (!link) return false;
  const plain = (hash: string): string => hash.replace(/&angle=[^&]*/, '');
  const angle = readLink(hash)?.angle;
  const isSame = plain(link.hash) === plain(hash);
  if (isSame && angle) linked.controls?.lookFrom(angle);
  return isSame;
}

function openState({ session, layers, live, controls }: Linked, opener: Opener, state: LinkState): void {
  const { angle, shape } = state;
  opener.onReplace?.();
  session.setRules(state.rules);
  session.setView(state.view);
  opener.openSample(state.sample, { paint: state.layers?.[0]?.paint, locks: state.locks });
  if (state.layers) layers.restore(state.layers);
  onceShown(session, ({ target }) => {
    if (target.sample?.name !== state.sample) return;
    if (angle) controls?.lookFrom(angle);
    if (shape) live.move(shape);
  });
}

/** Shows a look on a sample, and offers to wear it. */
function openLook({ session, layers, maker }: Linked, opener: Opener, { template, ...look }: Look): void {
  const sample = kStandIns[template];
  opener.onReplace?.();
  session.setView({ mode: 'result', light: look.light, background: look.background });
  opener.openSample(sample, { paint: look.layers[0]?.paint, cageFor: (target) => maker.cageFor(target, template) });
  layers.restore(look.layers);
  onceShown(session, ({ target }) => {
    if (target.sample?.name !== sample) return;
    ask({
      text: 'Somebody made this look for a model of theirs. Drop yours: it wears it.',
      answers: [{ title: 'Open a model', run: () => element('target-input', HTMLInputElement).click() }],
    });
  });
}

/** Calls back with what is shown next, unless the request fails or is cancelled. */
function onceShown(session: Session, act: (shown: Shown) => void): void {
  const ends = [
    session.on('transfer', (shown) => {
      end();
      act(shown);
    }),
    session.on('progress', ({ state }) => state !== 'working' && end()),
  ];
  const end = (): void => ends.forEach((off) => off());
}
