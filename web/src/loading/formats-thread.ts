// A worker with a three.js of its own: the page begins without what only loaders of other formats need of it.
import { toGlb } from 'cagecast/formats';
import { answerBy } from '../platform/ask-worker';
import { companionOf, paths } from './file-paths';

/** A file, and where it is if its folder was dropped. */
interface Placed {
  file: File;
  path: string | undefined;
}

/** A model of another format, and the files that came with it. */
export interface FormatsRequest {
  model: Placed;
  companions: readonly Placed[];
}

export interface Converted {
  glb: Uint8Array<ArrayBuffer>;
}

answerBy(
  async ({ model, companions }: FormatsRequest): Promise<Converted> => {
    for (const { file, path } of [model, ...companions]) if (path !== undefined) paths.set(file, path);
    const files = companions.map(({ file }) => file);
    const read = async (name: string) => {
      const found = companionOf(name, files, model.file);
      return found && new Uint8Array(await found.arrayBuffer());
    };
    const glb = await toGlb(new Uint8Array(await model.file.arrayBuffer()), { read });
    return { glb: glb as Uint8Array<ArrayBuffer> };
  },
  ({ glb }) => [glb.buffer],
);
