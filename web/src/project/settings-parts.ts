import { type Deform, kDeforms } from '../live/deform';
import type { Live } from '../live/live-panel';
import { element } from '../platform/page';
import type { Locks, Session } from '../scene/session';
import { kLightNames, kModes } from '../scene/view-state';
import type { CameraControls } from '../view/camera-controls';
import { listOf, locksOf, numberOf, objectOf, oneOf, textOf } from './checks';
import type { Contribution } from './project';

const kMaxMorphs = 10_000;
/** Fields of the painting tools. */
const kFields = ['color', 'size', 'hardness', 'opacity', 'mirror'].map((name) => `brush-${name}`);

/** Rules, overrides of parts, the shape, the view and the brush. */
export function settingsParts(session: Session, live: Live, controls: CameraControls | undefined): Contribution[] {
  return [
    {
      name: 'rules',
      isWork: true,
      save: () => session.rules,
      read(saved) {
        const { preset, threshold, borders } = objectOf(saved, 'rules');
        return {
          before: () => session.setRules({ preset: oneOf(preset, ['default', 'paper']) }),
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
        const locks = Object.entries(locksOf(saved));
        const known = (): Locks => {
          const count = session.shown!.projection.segmentStats.length;
          return Object.fromEntries(locks.filter(([key]) => Number(key) < count));
        };
        return { shown: () => session.setLocks(known()) };
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
    {
      name: 'view',
      isWork: false,
      save: () => ({ ...session.view, angle: controls?.angle }),
      read(saved) {
        const { mode, split, paint, cage, light, background, angle } = objectOf(saved, 'view');
        const { turn, tilt, near } = (angle ?? {}) as Record<string, unknown>;
        return {
          shown() {
            session.setView({
              mode: oneOf(mode, kModes),
              split: numberOf(split, 0, 1, 0.5),
              paint: paint !== false,
              cage: cage === true,
              light: oneOf(light, kLightNames),
              background: /^#[0-9a-f]{6}$/i.test(textOf(background, '')) ? (background as string) : '',
            });
            if (angle)
              controls?.lookFrom({
                turn: numberOf(turn, -360, 360, 0),
                tilt: numberOf(tilt, 0, 180, 90),
                near: numberOf(near, 0.01, 100, 1),
              });
          },
        };
      },
    },
    {
      name: 'brush',
      isWork: false,
      save: () =>
        Object.fromEntries(
          kFields.map((id) => {
            const { type, checked, value } = element(id, HTMLInputElement);
            return [id, type === 'checkbox' ? checked : value];
          }),
        ),
      read(saved) {
        const values = objectOf(saved, 'brush');
        return {
          shown() {
            for (const id of kFields) {
              const field = element(id, HTMLInputElement);
              if (field.type === 'checkbox') field.checked = values[id] === true;
              // Fields replace what they cannot hold.
              else field.value = textOf(values[id], field.value);
              field.dispatchEvent(new Event('input', { bubbles: true }));
            }
          },
        };
      },
    },
  ];
}
