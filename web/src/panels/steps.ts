import type { History } from '#three';
import type { Locks, Rules } from '../state/choices';
import { type Controlled, ControlSteps } from '../state/control-steps';
import type { ChosenShape } from '../state/deform';
import type { Session } from '../state/session';
import type { Live } from '../tools/live/live-panel';
import { nameOfPart } from './part-menu';

const kDone = {
  keep: 'keeping',
  always: 'painting anyway',
  exclude: 'excluding',
  out: 'leaving out',
  auto: 'no override of',
} as const;

/** Makes changes of rules, overrides of parts and the shape steps of the undo history. */
export function recordControls(session: Session, live: Live, history: History): void {
  const rules: Controlled<Rules> = {
    get: () => ({ ...session.rules }),
    set: (state) => session.setRules(state),
    nameOf: (before, after) =>
      before.threshold !== after.threshold
        ? 'changing the threshold'
        : before.preset !== after.preset
          ? 'choosing rules'
          : before.weldTolerance !== after.weldTolerance
            ? 'joining pieces'
            : 'exact borders',
  };
  const locks: Controlled<Locks> = {
    get: () => ({ ...session.locks }),
    set: (state) => session.setLocks(state),
    nameOf(before, after) {
      const changed = Object.keys({ ...before, ...after }).filter((key) => before[Number(key)] !== after[Number(key)]);
      const segment = Number(changed[0]);
      const rest = changed.length > 1 ? ` and ${changed.length - 1} more` : '';
      return `${kDone[after[segment] ?? 'auto']} ${nameOfPart(session.shown!, segment)}${rest}`;
    },
  };
  const shape: Controlled<Omit<ChosenShape, 'morphs'> & { morphs: [string, number][] }> = {
    get: () => ({ ...live.shape, morphs: [...live.shape.morphs] }),
    set: (state) => live.move({ ...state, morphs: new Map(state.morphs) }),
    nameOf: () => 'changing the shape',
  };
  const steps = new ControlSteps(history, [rules, locks, shape]);
  // On the window, so that it runs after the controls' own.
  for (const event of ['change', 'click'] as const) addEventListener(event, () => steps.record());
  let last: unknown;
  let isOpening = false;
  session.on('transfer', ({ target }) => {
    isOpening = target !== last;
    last = target;
    // Steps on another model do not apply any more.
    if (isOpening) steps.reset();
    // Segments that were joined have other numbers.
    else steps.take();
  });
  session.on('progress', ({ state }) => {
    if (state === 'working' || !isOpening) return;
    isOpening = false;
    // A link or a project has set states of its own.
    steps.reset();
  });
}
