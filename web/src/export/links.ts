import type { Opener } from '../loading/opener';
import type { Session } from '../state/session';
import type { Live } from '../tools/live/live-panel';
import type { CameraControls } from '../view/camera-controls';
import { type LinkedLayer, type LinkState, readLink, writeLink } from './link';

/** The layers that a link can carry. */
export interface LinkedLayers {
  /** From the lowest to the uppermost; without the user's own paints. */
  readonly layers: LinkedLayer[];
  /** Names of the layers that a link leaves out. */
  readonly omitted: readonly string[];
  /** Restores them once the sample is loaded. Paints that the page does not have are left out. */
  restore(layers: LinkedLayer[]): void;
}

/** The sources of a link. */
export interface Linked {
  session: Session;
  layers: LinkedLayers;
  live: Live;
  /** Undefined without WebGL. */
  controls: CameraControls | undefined;
}

/** The state for a link. @returns Undefined if the model is not a sample. */
function stateOf({
  session: { shown, rules, locks, view },
  layers: { layers },
  live,
  controls,
}: Linked): LinkState | undefined {
  const sample = shown?.target.sample;
  if (!sample || sample !== shown.cage.sample) return undefined;
  const { shape } = live;
  const rests = shape.amount === 0 && shape.morphs.size === 0;
  return { sample: sample.name, layers, rules, locks, view, shape: rests ? undefined : shape, angle: controls?.angle };
}

/** The URL fragment for the current state, with `#`. @returns Undefined if the model is not a sample. */
export function linkOf(linked: Linked): string | undefined {
  const state = stateOf(linked);
  return state && `#${writeLink(state)}`;
}

/**
 * Restores the state in the page's URL, now (unless the user opened something already) and whenever it changes.
 * @returns Whether anything is being opened.
 */
export function followLinks(linked: Linked, opener: Opener): boolean {
  const { session, layers, live, controls } = linked;
  const restore = (): boolean => {
    const state = readLink(location.hash);
    if (!state || !opener.samples.some(({ name }) => name === state.sample)) return false;
    const { angle, shape } = state;
    const shown = stateOf(linked);
    if (shown && writeLink({ ...shown, angle: undefined }) === writeLink({ ...state, angle: undefined })) {
      // The state is shown already, such as after copying the link.
      if (angle) controls?.lookFrom(angle);
      return true;
    }
    opener.onReplace?.();
    session.setRules(state.rules);
    session.setView(state.view);
    opener.openSample(state.sample, state.layers?.[0]?.paint, state.locks);
    if (state.layers) layers.restore(state.layers);
    const ends = [
      session.on('transfer', ({ target }) => {
        end();
        if (target.sample?.name !== state.sample) return;
        if (angle) controls?.lookFrom(angle);
        if (shape) live.move(shape);
      }),
      // The request failed or was cancelled.
      session.on('progress', ({ state }) => state !== 'working' && end()),
    ];
    const end = (): void => ends.forEach((off) => off());
    return true;
  };
  addEventListener('hashchange', restore);
  return session.begun || restore();
}
