import { kMaxWeld, knownLocks } from '../choices';
import { type ChosenShape, type Deform, kDeforms } from '../deform';
import type { Session } from '../session';
import { type Angle, kHalves, kLastStep, kLightNames, kModes } from '../view-state';
import { listOf, locksOf, numberOf, objectOf, oneOf, textOf } from './checks';
import type { Contribution } from './project';

const kMaxMorphs = 10_000;
/** What can be moved, and how. */
interface Shaped {
  readonly shape: ChosenShape;
  move(shape: ChosenShape): void;
}

/** What the model is seen by. */
interface Camera {
  readonly angle: Angle | undefined;
  lookFrom(angle: Angle): void;
  /** Calls back when the user has moved it. */
  onMove(follow: () => void): void;
}

/** A place in the model. */
function placeOf(saved: unknown): NonNullable<Angle['at']> {
  const [x, y, z] = listOf(saved, 3, 'coordinates').map((value) => numberOf(value, -1, 1, 0));
  return [x ?? 0, y ?? 0, z ?? 0];
}

/** Rules, overrides of parts and the shape. */
export function settingsParts(session: Session, live: Shaped): Contribution[] {
  return [
    {
      name: 'rules',
      isWork: true,
      save: () => session.rules,
      read(saved) {
        const { preset, threshold, weldTolerance, borders } = objectOf(saved, 'rules');
        return {
          before: () =>
            session.setRules({
              preset: oneOf(preset, ['default', 'paper']),
              weldTolerance: numberOf(weldTolerance, 0, kMaxWeld, 0),
            }),
          shown: () =>
            session.setRules({
              threshold: numberOf(threshold, 0, 1, 0.5),
              borders: oneOf(borders, ['triangle', 'cut']),
            }),
        };
      },
    },
    {
      name: 'overrides',
      isWork: true,
      save: () => session.locks,
      read(saved) {
        const locks = locksOf(saved);
        return { shown: () => session.setLocks(knownLocks(locks, session.shown!.projection)) };
      },
    },
    {
      name: 'shape',
      isWork: true,
      save: () => ({ ...live.shape, morphs: [...live.shape.morphs] }),
      read(saved) {
        const { deform, amount, cage, morphs } = objectOf(saved, 'shape');
        const weights = listOf(morphs ?? [], kMaxMorphs, 'morphs').map((morph): [string, number] => {
          const [name, weight] = listOf(morph, 2, 'morphs');
          return [textOf(name, ''), numberOf(weight, -1e6, 1e6, 0)];
        });
        const shape = {
          deform: oneOf<Deform>(deform, kDeforms),
          amount: numberOf(amount, -1, 1, 0),
          cage: cage !== false,
          morphs: new Map(weights),
        };
        return shape.amount === 0 && weights.length === 0 ? {} : { shown: () => live.move(shape) };
      },
    },
  ];
}

/** The view; last of all, as others make the camera show what they bring. @param controls Undefined without WebGL. */
export function viewPart(session: Session, controls: Camera | undefined): Contribution {
  return {
    name: 'view',
    isWork: false,
    follow: (touch) => controls?.onMove(touch),
    save: () => ({ ...session.view, angle: controls?.angle }),
    read(saved) {
      const { mode, split, left, right, step, paint, cage, seeThrough, light, background, angle } = objectOf(
        saved,
        'view',
      );
      const { turn, tilt, near, at } = (angle ?? {}) as Record<string, unknown>;
      const look = (): void => {
        if (angle)
          controls?.lookFrom({
            turn: numberOf(turn, -360, 360, 0),
            tilt: numberOf(tilt, 0, 180, 90),
            near: numberOf(near, 0.01, 100, 1),
            at: at === undefined ? undefined : placeOf(at),
          });
      };
      return {
        // Others beside the model have come last, and are shown from where all are seen.
        ready: look,
        shown() {
          session.setView({
            mode: oneOf(mode, kModes),
            split: numberOf(split, 0, 1, 0.5),
            left: oneOf(left, kHalves),
            right: oneOf(right, [...kHalves].reverse()),
            step: numberOf(step, 0, kLastStep, 0),
            paint: paint !== false,
            cage: cage === true,
            seeThrough: seeThrough === true,
            light: oneOf(light, kLightNames),
            background: /^#[0-9a-f]{6}$/i.test(textOf(background, '')) ? (background as string) : '',
          });
          look();
        },
      };
    },
  };
}
