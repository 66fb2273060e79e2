import { modelsAmong } from '../state/intake';
import type { Loader, Model } from '../state/model';
import type { Sample } from '../state/sample';
import { type Entry, nameOf } from '../state/wardrobe/avatar';
import type { KeptAvatar } from '../state/wardrobe/kept';
import { fetchFile } from './samples';

/** A sample as an avatar. */
export function sampleEntry(sample: Sample, loader: Loader): Entry {
  const model = async (address: string): Promise<Model> => ({
    ...(await loader.loadOwn(await fetchFile(address))),
    sample,
  });
  return { name: sample.title, sample, target: () => model(sample.target), cage: () => model(sample.cage) };
}

/** An avatar of a project. */
export function keptEntry(kept: KeptAvatar, samples: readonly Sample[], loader: Loader): Entry {
  const model = async ({ files: [file, ...rest], sample: name }: NonNullable<KeptAvatar['cage']>): Promise<Model> => {
    const sample = samples.find((one) => one.name === name);
    return { ...(await loader.load(file!, rest)), ...(sample && { sample }) };
  };
  const { name, cage } = kept;
  const sample = samples.find((one) => one.name === kept.sample);
  return { name, sample, kept, target: () => model(kept), cage: cage && (() => model(cage)) };
}

/**
 * Finds the cage of each model among files: a cage named as its model (`x.glb` and `x-cage.glb`), or the only cage for all of them.
 * A cage that belongs to none is left out.
 */
export function entriesOf(files: readonly File[], loader: Loader): Entry[] {
  const { cages, targets } = modelsAmong(files);
  const stem = ({ name }: File): string => nameOf(name).toLowerCase();
  const others = files.filter((file) => !cages.includes(file) && !targets.includes(file));
  return targets.map((file) => {
    const cage =
      cages.find((other) => stem(other).replace(/(?<![-_. ])[-_. ]*cage[-_. ]*/, '') === stem(file)) ??
      (cages.length === 1 ? cages[0] : undefined);
    const kept = {
      name: nameOf(file.name),
      sample: undefined,
      files: [file, ...others],
      cage: cage && { files: [cage, ...others], sample: undefined },
      follows: false,
      locks: {},
      bare: undefined,
    };
    return keptEntry(kept, [], loader);
  });
}
