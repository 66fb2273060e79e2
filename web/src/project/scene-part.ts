import type { WebGLRenderer } from 'three';
import { loadModel, type Model } from '../scene/load-model';
import type { Opener } from '../scene/opener';
import type { Scene, Session } from '../scene/session';
import { listOf, objectOf } from './checks';
import type { Files, Keep, SceneContribution } from './project';

const kMaxFiles = 1000; // of a model

/** The models, with all their files; those of samples too, so that a project outlives them. */
export function scenePart(session: Session, opener: Opener, renderer: WebGLRenderer | undefined): SceneContribution {
  const save = ({ files, sample }: Model, keep: Keep): object => ({
    files: files.map((file) => keep(file)),
    ...(sample && { sample: sample.name }),
  });
  const read = async (saved: unknown, files: Files): Promise<Model> => {
    const { files: keys, sample: name } = objectOf(saved, 'model');
    const [file, ...others] = listOf(keys, kMaxFiles, 'files').map(files);
    const model = await loadModel(file ?? files(undefined), renderer, others);
    const sample = opener.samples.find((one) => one.name === name);
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
