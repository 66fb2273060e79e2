import assert from 'node:assert/strict';
import { CagecastError, init, type ProjectOptions, project, type Timings } from 'cagecast';
import type { Cage } from 'cagecast/cages';
import { BufferAttribute, BufferGeometry, Group, Mesh, Texture } from 'three';
import { meshesOf } from '../../../web/src/loading/extract-mesh';
import { arraysOf } from '../../../web/src/state/arrays';
import type { Loader, Model } from '../../../web/src/state/model';
import type { Paint } from '../../../web/src/state/paint';
import { Session } from '../../../web/src/state/session';
import { Superseded, type Tasks, type Transferer } from '../../../web/src/state/transfers';
import { tetrahedron } from '../../support/glb';

/** What holds promises back until a test lets them go. */
export class Gate {
  #isOpen = true;
  #held: (() => void)[] = [];

  hold(): void {
    this.#isOpen = false;
  }

  /** How many wait. */
  get count(): number {
    return this.#held.length;
  }

  open(): void {
    this.#isOpen = true;
    for (const pass of this.#held.splice(0)) pass();
  }

  /** Lets the last of those who wait pass. */
  pass(): void {
    this.#held.pop()?.();
  }

  wait(signal?: AbortSignal): Promise<void> {
    return new Promise((done, fail) => {
      signal?.addEventListener('abort', () => {
        this.#held = this.#held.filter((pass) => pass !== done);
        fail(signal.reason);
      });
      if (this.#isOpen) done();
      else this.#held.push(done);
    });
  }
}

/** Waits until something is so, by turns of the event loop. */
export async function until(isSo: () => unknown, what = 'it'): Promise<void> {
  for (let turn = 0; !isSo(); turn++) {
    assert.ok(turn < 2000, `${what} does not come: ${isSo}`);
    await new Promise((done) => setImmediate(done));
  }
}

/** Lets everything happen that needs no gate. */
export async function quiet(): Promise<void> {
  for (let turn = 0; turn < 25; turn++) await new Promise((done) => setImmediate(done));
}

interface Arrays {
  positions: Float32Array;
  indices: ArrayLike<number>;
  uvs?: Float32Array | undefined;
}

const meshes = new WeakMap<File, Arrays>();
/** Cages that the engine of a test has put into files, which have their numbers. */
const made: Cage[] = [];
export const cageGlb = (cage: Cage): Uint8Array<ArrayBuffer> => new TextEncoder().encode(String(made.push(cage) - 1));

/** A file of a tetrahedron. @param uv  Moves its UVs: those of equal numbers are equal. */
export function fileOf(name: string, size = 1, uv = 0): File {
  const file = new File([name], name);
  const { uvs, ...mesh } = tetrahedron(size);
  meshes.set(file, { ...mesh, uvs: uvs.map((value) => value / (1 + uv)) });
  return file;
}

const scenes = new WeakMap<File, Group>();

/** A file of several tetrahedra, by their names and sizes; those of names in brackets are hidden. */
export function sceneOf(name: string, parts: Record<string, number>): File {
  const file = new File([name], name);
  const scene = new Group();
  for (const [part, size] of Object.entries(parts)) {
    const mesh = meshOf(tetrahedron(size));
    scene.add(Object.assign(mesh, { name: part, visible: !part.startsWith('(') }));
  }
  scenes.set(file, scene);
  return file;
}

function meshOf({ positions, indices, uvs }: Arrays): Mesh {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  if (uvs) geometry.setAttribute('uv', new BufferAttribute(uvs, 2));
  geometry.setIndex([...(indices as number[])]);
  return new Mesh(geometry);
}

function modelOf(file: File, scene: Group, others: readonly File[] = []): Model {
  return {
    name: file.name,
    files: [file, ...others],
    scene,
    loaded: { scene, userData: {} },
    animations: [],
    ...meshesOf(scene),
  };
}

/** Reads the files of `fileOf`, except those whose names begin with “broken”. */
export class FakeLoader implements Loader {
  readonly gate = new Gate();
  readonly disposed: string[] = [];

  async load(file: File, others: readonly File[] = []): Promise<Model> {
    await this.gate.wait();
    if (file.name.startsWith('broken')) throw new Error(`${file.name}: it is broken`);
    const scene = scenes.get(file);
    if (scene) return modelOf(file, scene, others);
    const { uvs, ...arrays } = meshes.get(file) ?? made[Number(await file.text())]!;
    const mesh = meshOf({ ...arrays, uvs });
    if ('landmarks' in arrays) mesh.userData['landmarks'] = arrays.landmarks;
    return modelOf(file, new Group().add(mesh), others);
  }

  loadOwn(file: File): Promise<Model> {
    return this.load(file);
  }

  dispose({ name }: Model): void {
    this.disposed.push(name);
  }
}

/** Transfers at once, or when its gate opens. The latest request wins. */
export class FakeTransferer implements Transferer {
  readonly gate = new Gate();
  /** The tasks that were asked for: with the preset, and the name of the target. */
  asked: string[] = [];
  /** What is answered to those who want transfers timed. */
  runs: Partial<Timings>[] = [{ total: 1 }];
  /** Fails by it once. */
  failure: Error | undefined;
  #reject: ((error: Error) => void) | undefined;

  ask<Task extends keyof Tasks>(
    task: Task,
    cage: Model,
    target: Model,
    options: Tasks[Task]['options'],
  ): Promise<Tasks[Task]['answer']> {
    this.cancel();
    const { preset = '' } = ('rules' in options ? options.rules : options) as { preset?: string };
    this.asked.push(`${task} ${preset} ${target.name}`);
    return new Promise((resolve, reject) => {
      this.#reject = reject;
      this.gate.wait().then(() => {
        const { failure } = this;
        this.failure = undefined;
        if (failure) return reject(failure);
        if (task === 'inspect') return resolve({ verdict: 'good', findings: [] } as never);
        if (task === 'time') return resolve({ runs: this.runs } as never);
        try {
          const arrays = arraysOf(cage, target);
          resolve({ ...project(arrays.cage, arrays.target, options as ProjectOptions), split: {} } as never);
        } catch (error) {
          reject(error);
        }
      }, reject);
    });
  }

  cancel(): void {
    this.#reject?.(new Superseded());
    this.#reject = undefined;
  }
}

export const paintOf = (name: string, sample?: Paint['sample']): Paint => ({
  name,
  texture: new Texture(),
  picture: name,
  ...(sample && { sample }),
});

/** A session with what it is handed, and what it says. */
export async function begin() {
  await init();
  const [loader, transferer] = [new FakeLoader(), new FakeTransferer()];
  const session = new Session(transferer, paintOf('UV checker'));
  const said: string[] = [];
  let last: { state: string; error?: Error } = { state: 'none' };
  session.on('progress', (progress) => (last = progress));
  for (const event of ['transfer', 'paint', 'rules', 'zones'] as const) session.on(event, () => said.push(event));
  const load = (name: string, size = 1, uv = 0): Promise<Model> => loader.load(fileOf(name, size, uv));
  return {
    session,
    loader,
    transferer,
    /** Events of the session, by name. */
    said,
    load,
    /** Opens a target, and a cage if it is named. */
    open: (target: string, cage?: string, uv = 0): void =>
      session.request({ target: load(target), ...(cage && { cage: load(cage, 4, uv) }) }),
    /** Waits until it is ready. */
    async ready(): Promise<void> {
      await until(() => last.state !== 'working', 'the end of the work');
      assert.equal(last.state, 'ready', String(last.error));
    },
    /** Waits until it has failed. @returns What is said. */
    async failed(): Promise<string> {
      await until(() => last.state !== 'working', 'the end of the work');
      assert.equal(last.state, 'failed');
      return last.error!.message;
    },
    get state() {
      return last.state;
    },
    /** The names of what is shown. */
    get shown(): string[] {
      const { target, cage, paint } = session.shown ?? {};
      return [target, cage, paint].map((one) => one?.name ?? 'none');
    },
  };
}

export const refusal = (argument?: 'target' | 'cage'): CagecastError =>
  new CagecastError('internal', 'project', 'it does not fit', { argument });

/** A file of a cage that was fitted: the mesh of another. */
export function copyOf(name: string, { mesh: { positions, indices, uvs } }: Model): File {
  const file = new File([name], name);
  meshes.set(file, { positions, indices, uvs });
  return file;
}
