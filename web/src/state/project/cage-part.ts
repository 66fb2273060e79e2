import type { Landmarks, TemplateName } from 'cagecast/cages';
import { type Fitting, madeOf, noteMade } from '../made-cages';
import type { Samples } from '../sample';
import type { Session } from '../session';
import type { WardrobeOfPage } from '../wardrobe/kept';
import { damaged, listOf, numberOf, objectOf, textOf } from './checks';
import type { Contribution } from './project';

const kMaxCages = 100;
const kMaxLandmarks = 1000;
const kFarthest = 1e9; // of a landmark
const kName = /^[a-z][a-z0-9_]{0,60}$/; // of a landmark

/** What says how cages were made. */
interface CagesOfPage {
  session: Session;
  samples: Samples;
  /** The names of all templates. */
  templates: readonly string[];
}

/** How the cages were made that were made here, those of the wardrobe too. */
export function cagePart(
  { session, samples, templates }: CagesOfPage,
  wardrobe: WardrobeOfPage | undefined,
): Contribution {
  return {
    name: 'cages',
    isWork: true,
    save(keep) {
      const { target, cage } = session.shown!;
      const others = wardrobe?.kept.avatars ?? [];
      const pairs = [{ files: target.files, cage }, ...others].flatMap(({ files, cage }) =>
        files[0] && cage?.files[0] ? [{ target: files[0], cage: cage.files[0] }] : [],
      );
      const all = pairs.flatMap(({ target, cage }) => {
        const own = madeOf(cage);
        if (!own) return [];
        const { fitting, sample, isNew } = own;
        // The model that it was made for may be gone.
        return [
          {
            cage: keep(cage),
            ...(own.target === target && { target: keep(target) }),
            fitting,
            sample: sample?.name,
            isNew,
          },
        ];
      });
      return all.length > 0 ? all : undefined;
    },
    read(saved, files) {
      const all = listOf(saved, kMaxCages, 'cages').map((one) => {
        const { cage, target, fitting, sample, isNew } = objectOf(one, 'cage');
        const file = files(cage);
        // The cage itself stands for a model that is gone: it is no target.
        const made = {
          target: target === undefined ? file : files(target),
          fitting: fitting === undefined ? undefined : fittingOf(fitting, templates),
          sample: samples.samples.find(({ name }) => name === sample),
          isNew: isNew === true,
        };
        return { file, made };
      });
      return {
        before() {
          // Of one that is still known, more is known.
          for (const { file, made } of all) if (!madeOf(file)) noteMade(file, made);
        },
      };
    },
  };
}

function fittingOf(saved: unknown, templates: readonly string[]): Fitting {
  const { template, given, used, confidence, missing, guessed = [] } = objectOf(saved, 'fit');
  if (!templates.includes(template as string)) damaged('it has an unknown template');
  return {
    template: template as TemplateName,
    given: landmarksOf(given),
    used: landmarksOf(used),
    confidence: Object.fromEntries(named(confidence).map(([name, value]) => [name, numberOf(value, 0, 1, 1)])),
    missing: namesOf(missing),
    guessed: namesOf(guessed),
  };
}

const namesOf = (saved: unknown): string[] =>
  listOf(saved, kMaxLandmarks, 'landmarks')
    .map((name) => textOf(name, ''))
    .filter((name) => kName.test(name));

const named = (saved: unknown): [string, unknown][] =>
  Object.entries(objectOf(saved, 'landmarks'))
    .filter(([name]) => kName.test(name))
    .slice(0, kMaxLandmarks);

const landmarksOf = (saved: unknown): Landmarks =>
  Object.fromEntries(
    named(saved).map(([name, at]) => {
      const coordinate = (value: unknown): number =>
        typeof value === 'number' && Math.abs(value) < kFarthest ? value : damaged('a landmark has no place');
      const [x, y, z] = listOf(at, 3, 'coordinates');
      return [name, [coordinate(x), coordinate(y), coordinate(z)]];
    }),
  );
