import { likelyTemplate } from '#three';
import { askWorker } from '../../platform/ask-worker';
import { landmarksOf, type Model } from '../../state/model';
import type { Paint } from '../../state/paint';
import { loadPaint } from '../load-paint';
import { type DrawnPaint, drawnPaints } from './names';
import type { Drawn, DrawRequest } from './paint-worker';
import type { Canvas } from './spots';

const kTexels = 1024;
const kPixels = 144; // of a picture, twice what is shown

/** Paints that are drawn for any cage. */
export class Drawings {
  /** The pictures that were asked for last. */
  #pictures: { of: Model['mesh']; urls: Promise<readonly string[]> } | undefined;

  /** Those that suit a cage. */
  listFor(cage: Model): readonly DrawnPaint[] {
    const isFace = 'eye_centre_left' in landmarksOf(cage);
    return drawnPaints.filter(({ kind }) => isFace || kind !== 'face');
  }

  /** What a cage that has no paint yet is painted with. */
  firstFor(cage: Model): DrawnPaint {
    const landmarks = landmarksOf(cage);
    const isCar = 'bumper_front' in landmarks || likelyTemplate(cage.mesh.positions) === 'car';
    // Without a face to be drawn for, stripes are but lines.
    const name = isCar ? 'carbon' : Object.keys(landmarks).length > 0 ? 'tiger' : 'flowers';
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

  /** Pictures of a cage with the paints that suit it, as URLs, until those of another cage are asked for. */
  pictures(cage: Model): Promise<readonly string[]> {
    const last = this.#pictures;
    if (last?.of === cage.mesh) return last.urls;
    const names = this.listFor(cage).map(({ name }) => name);
    const drawn = ask({ names, canvas: canvasOf(cage), size: kPixels, kind: 'portrait' });
    const urls = drawn.then((files) => files.map((file) => URL.createObjectURL(file)));
    this.#pictures = { of: cage.mesh, urls };
    void last?.urls.then(
      (old) => old.map((url) => URL.revokeObjectURL(url)),
      () => {}, // there are none
    );
    return urls;
  }
}

async function ask(request: DrawRequest): Promise<Blob[]> {
  const worker = new Worker(new URL('./paint-worker.ts', import.meta.url), { type: 'module' });
  return (await askWorker<Drawn>(worker, request)).files;
}

/** A cage as it is in its file. */
function canvasOf(cage: Model): Canvas {
  const { positions, rest = positions, indices, uvs = new Float32Array() } = cage.mesh;
  return { positions: rest, uvs, indices, landmarks: landmarksOf(cage) };
}
