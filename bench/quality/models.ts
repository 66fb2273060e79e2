import { existsSync, readdirSync } from 'node:fs';
import { mkdir, readFile } from 'node:fs/promises';
import { output, root, saveScene } from '../native.js';
import { readScene, type Scene } from '../scene-file.js';
import { reference } from './reference.js';

/** What is known of each vertex of a target; see `examples/assets/truth.ts`. */
export interface Truth {
  /** 1 = must not be painted. */
  ncz: ArrayLike<number>;
  /** 1 = not scored. */
  ignore: ArrayLike<number>;
  /** 1 = the cage says nothing about it. */
  offCage: ArrayLike<number>;
}

/** A target with its cage, and the truth about it. */
export interface Model {
  name: string;
  /** `asset`: of a folder given by the user; `sample`: of the project; `trap`: made to be difficult; `spoiled`: a sample that goes wrong on purpose. */
  kind: 'asset' | 'sample' | 'trap' | 'spoiled';
  scene: Scene;
  truth: Truth;
}

const folder = `${root}build/bench/quality`;

/**
 * All models there are: those of the folder that CAGECAST_ASSETS names (folders with target.glb, cage.glb, truth.json), the
 * project's samples, and the models made to be difficult.
 * @param only  Names; all if undefined.
 */
export async function loadModels(only: readonly string[] | undefined): Promise<Model[]> {
  await mkdir(folder, { recursive: true });
  const wanted = (name: string): boolean => only?.includes(name) ?? true;
  const models: Model[] = [];
  const add = async (name: string, kind: Model['kind'], path: string): Promise<void> => {
    if (!wanted(name)) return;
    const scene = `${folder}/${name}.scene`;
    await saveScene(`${path}/target.glb`, `${path}/cage.glb`, scene);
    const truth = JSON.parse(await readFile(`${path}/truth.json`, 'utf8')) as Truth;
    models.push({ name, kind, truth, scene: await load(scene, truth.ncz.length) });
  };

  const assets = process.env['CAGECAST_ASSETS'];
  for (const name of assets === undefined ? [] : readdirSync(assets).sort())
    if (existsSync(`${assets}/${name}/truth.json`)) await add(name, 'asset', `${assets}/${name}`);
  const samples = `${root}build/assets`;
  for (const { name } of JSON.parse(await readFile(`${samples}/index.json`, 'utf8')) as { name: string }[])
    // Named after the model they were spoiled from.
    await add(name, name.includes('-') ? 'spoiled' : 'sample', `${samples}/${name}`);

  const traps = `${folder}/traps`;
  await mkdir(traps, { recursive: true });
  await output(reference, ['--traps', traps]);
  for (const file of readdirSync(traps).filter((name) => name.endsWith('.scene')).sort()) {
    const name = file.replace('.scene', '');
    if (!wanted(name)) continue;
    // Per vertex 0: to be painted, 1: not to be, 2: either; padded to whole words.
    const labels = new Uint8Array(await readFile(`${traps}/${name}.truth`));
    const scene = readScene(bufferOf(await readFile(`${traps}/${file}`)));
    const truth: Truth = { ncz: labels.map((label) => +(label === 1)), ignore: labels.map((label) => +(label === 2)), offCage: new Uint8Array(labels.length) };
    models.push({ name, kind: 'trap', scene, truth });
  }
  return models;
}

const bufferOf = (bytes: Buffer): ArrayBuffer => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength) as ArrayBuffer;

async function load(path: string, vertices: number): Promise<Scene> {
  const scene = readScene(bufferOf(await readFile(path)));
  const found = scene.target.positions.length / 3;
  if (found !== vertices) throw new Error(`${path}: the target has ${found} vertices, its truth.json speaks of ${vertices}`);
  return scene;
}
