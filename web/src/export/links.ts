import type { Live } from '../live/live';
import type { Opener } from '../scene/open';
import type { Session } from '../scene/session';
import type { Viewer } from '../view/viewer';
import { type LinkedLayer, type LinkState, readLink, writeLink } from './link';

/** The layers, as a link can carry them. */
export interface LinkedLayers {
  /** From the lowest to the uppermost; without the visitor's own. */
  readonly layers: LinkedLayer[];
  /** How many are left out. */
  readonly left: number;
  /** Lays them once the sample is there, in place of its paint. What the page does not have is left out. */
  restore(layers: LinkedLayer[]): void;
}

/** What a link is made of. */
export interface Linked {
  session: Session;
  layers: LinkedLayers;
  live: Live;
  /** What shows it, if anything can. */
  viewer: Viewer | undefined;
}

/** What a link to what is shown restores. @returns Nothing if it is not a sample. */
function stateOf({
  session: { shown, rules, locks, view },
  layers: { layers },
  live,
  viewer,
}: Linked): LinkState | undefined {
  const sample = shown?.target.sample;
  if (!sample || sample !== shown.cage.sample) return undefined;
  return { sample: sample.name, layers, rules, locks, view, shape: live.shape, angle: viewer?.angle };
}

/** The fragment that leads to what is shown, with its `#`. @returns Nothing if it is not a sample. */
export function linkOf(linked: Linked): string | undefined {
  const state = stateOf(linked);
  return state && `#${writeLink(state)}`;
}

/**
 * Restores what the page's address says, now and whenever it changes; now only if nothing was asked for yet.
 * @returns Whether there is anything to come.
 */
export function followLinks(linked: Linked, opener: Opener): boolean {
  const { session, layers, live, viewer } = linked;
  const restore = (): boolean => {
    const state = readLink(location.hash);
    if (!state || !opener.samples.some(({ name }) => name === state.sample)) return false;
    const { angle, shape } = state;
    const shown = stateOf(linked);
    if (shown && writeLink({ ...shown, angle: undefined }) === writeLink({ ...state, angle: undefined })) {
      // As after a link was made of what is shown.
      if (angle) viewer?.lookFrom(angle);
      return true;
    }
    session.setRules(state.rules);
    session.setView(state.view);
    opener.openSample(state.sample, state.layers?.[0]?.paint, state.locks);
    if (state.layers) layers.restore(state.layers);
    const ends = [
      session.on('transfer', ({ target }) => {
        end();
        if (target.sample?.name !== state.sample) return;
        if (angle) viewer?.lookFrom(angle);
        if (shape) live.move(shape);
      }),
      // It came to nothing: what is opened next has nothing to do with it.
      session.on('progress', ({ state }) => state !== 'working' && end()),
    ];
    const end = (): void => ends.forEach((off) => off());
    return true;
  };
  addEventListener('hashchange', restore);
  return session.begun || restore();
}
