import { kMaxAvatars } from '../wardrobe/avatar';
import type { KeptAvatar, WardrobeOfPage } from '../wardrobe/kept';
import { kMaxMarks, marksOf, runsOf } from './bare-part';
import { listOf, locksOf, numberOf, objectOf, textOf } from './checks';
import type { Contribution, Files, Keep } from './project';

const kMaxFiles = 1000; // of a model

/** The avatars beside the one on the stage, with all their files. */
export function wardrobePart(wardrobe: WardrobeOfPage): Contribution {
  const saveModel = ({ files, sample }: NonNullable<KeptAvatar['cage']>, keep: Keep): object => ({
    files: files.map((file) => keep(file)),
    ...(sample && { sample }),
  });
  const readModel = (saved: unknown, files: Files): NonNullable<KeptAvatar['cage']> => {
    const { files: keys, sample } = objectOf(saved, 'avatar');
    const all = [...new Set(listOf(keys, kMaxFiles, 'files').map(files))];
    return { files: all.length > 0 ? all : [files(undefined)], sample: textOf(sample, '') || undefined };
  };
  return {
    name: 'wardrobe',
    isWork: true,
    isTouched: () => wardrobe.kept.avatars.length > 0,
    save(keep) {
      const { at, all, avatars } = wardrobe.kept;
      return {
        at,
        all,
        avatars: avatars.map(({ name, cage, follows, locks, bare, ...model }) => ({
          name,
          model: saveModel(model, keep),
          ...(cage && { cage: saveModel(cage, keep) }),
          follows,
          locks,
          ...(bare && { bare: runsOf(bare) }),
        })),
      };
    },
    read(saved, files) {
      const { at, all, avatars } = objectOf(saved, 'wardrobe');
      let room = kMaxMarks;
      const read = listOf(avatars, kMaxAvatars - 1, 'avatars').map((one): KeptAvatar => {
        const { name, model, cage, follows, locks, bare } = objectOf(one, 'avatar');
        const marks = bare === undefined ? undefined : marksOf(bare, room);
        room -= marks?.length ?? 0;
        return {
          name: textOf(name, 'Avatar'),
          ...readModel(model, files),
          cage: cage === undefined ? undefined : readModel(cage, files),
          follows: follows === true,
          locks: locksOf(locks),
          bare: marks,
        };
      });
      const place = Math.floor(numberOf(at, 0, read.length, 0));
      return { ready: () => wardrobe.restore({ at: place, all: all === true, avatars: read }) };
    },
  };
}
