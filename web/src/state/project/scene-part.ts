import type { Loader, Model } from '../model';
import type { Samples } from '../sample';
import type { Scene } from '../scene';
import type { Session } from '../session';
import { listOf, objectOf } from './checks';
import type { Files, Keep, SceneContribution } from './project';

const kMaxFiles = 1000; // of a model

/** The models, with all their files; those of samples too, so that a project outlives them. */
export function scenePart(session: Session, all: Samples, loader: Loader): SceneContribution {
  const save = ({ files, sample }: Model, keep: Keep): object => ({
    files: files.map((file) => keep(file)),
    ...(sample && { sample: sample.name }),
  });
  const read = async (saved: unknown, files: Files): Promise<Model> => {
    const { files: keys, sample: name } = objectOf(saved, 'model');
    // One that is named again would count again, for how large the model may be.
    const [file, ...others] = new Set(listOf(keys, kMaxFiles, 'files').map(files));
    const model = await loader.load(file ?? files(undefined), others);
    const sample = all.samples.find((one) => one.name === name);
    return sample ? { ...model, sample } : model;
  };
  return {
    name: 'models',
    isWork: true,
    isTouched: () => !session.shown!.target.sample || !session.shown!.cage.sample,
    save(keep) {
      const { target, cage } = session.shown!;
      return { target: save(target, keep), cage: save(cage, keep) };
    },
    async read(saved, files): Promise<Scene> {
      const { target, cage } = objectOf(saved, 'models');
      // One after the other: what is wrong with the first is reported first.
      const models = { target: await read(target, files), cage: await read(cage, files) };
      // The layers bring their own paints.
      return { ...models, paint: session.checker };
    },
  };
}
