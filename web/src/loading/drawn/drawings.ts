import { Vector3 } from 'three';
import { askWorker } from '../../platform/ask-worker';
import type { Model } from '../../state/model';
import type { Paint } from '../../state/paint';
import { loadPaint } from '../load-paint';
import { type DrawnPaint, drawnPaints } from './names';
import type { Drawn, DrawRequest } from './paint-worker';
import type { Canvas } from './spots';

const kTexels = 1024;
const kPixels = 96; // of a picture, twice what is shown

/** Paints that are drawn for any cage. */
export class Drawings {
  readonly #pictures = new WeakMap<Model['mesh'], Promise<readonly string[]>>();

  /** Those that suit a cage. */
  listFor(cage: Model): readonly DrawnPaint[] {
    const isFace = 'eye_centre_left' in landmarksOf(cage);
    return drawnPaints.filter(({ ofFaces }) => isFace || !ofFaces);
  }

  /** What a cage that has no paint yet is painted with. */
  firstFor(cage: Model): DrawnPaint {
    const name = 'bumper_front' in landmarksOf(cage) ? 'carbon' : 'tiger';
    return drawnPaints.find((one) => one.name === name)!;
  }

  /** The paint of a name; undefined if there is none. */
  find(name: string): DrawnPaint | undefined {
    return drawnPaints.find((one) => one.name === name);
  }

  /** Draws a paint for a cage. @throws Error if the worker cannot be started. */
  async draw({ name, title }: DrawnPaint, cage: Model): Promise<Paint> {
    const [file] = await ask({ names: [name], canvas: canvasOf(cage), size: kTexels, kind: 'texture' });
    return { ...(await loadPaint(new File([file!], `${name}.png`))), name: title, drawn: name };
  }

  /** Pictures of a cage with the paints that suit it, as URLs. */
  pictures(cage: Model): Promise<readonly string[]> {
    const known = this.#pictures.get(cage.mesh);
    if (known) return known;
    const names = this.listFor(cage).map(({ name }) => name);
    const made = ask({ names, canvas: canvasOf(cage), size: kPixels, kind: 'portrait' }).then((files) =>
      files.map((file) => URL.createObjectURL(file)),
    );
    this.#pictures.set(cage.mesh, made);
    return made;
  }
}

async function ask(request: DrawRequest): Promise<Blob[]> {
  const worker = new Worker(new URL('./paint-worker.ts', import.meta.url), { type: 'module' });
  return (await askWorker<Drawn>(worker, request)).files;
}

function landmarksOf({ scene }: Model): Canvas['landmarks'] {
  const found: Record<string, number[]> = {};
  scene.traverse((object) => {
    const landmarks = Object.entries((object.userData.landmarks ?? {}) as Canvas['landmarks']);
    if (landmarks.length > 0) object.updateWorldMatrix(true, false);
    for (const [name, at] of landmarks) found[name] = object.localToWorld(new Vector3().fromArray(at)).toArray();
  });
  return found;
}

/** A cage as it is in its file. */
function canvasOf(cage: Model): Canvas {
  const { positions, rest = positions, indices, uvs = new Float32Array() } = cage.mesh;
  return { positions: rest, uvs, indices, landmarks: landmarksOf(cage) };
}
