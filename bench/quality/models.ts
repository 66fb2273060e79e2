import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { mkdir, readFile } from 'node:fs/promises';
import { output, root } from '../native.js';
import { readGlb } from '../read-glb.js';
import { readScene, type Scene } from '../scene-file.js';

/** What is known of each vertex of a target; see examples/samples/README.md. */
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
  /** `sample`: of the project; `asset`: given by the user; `trap`: made to be difficult; `spoiled`: a sample that goes wrong on purpose. */
  kind: 'sample' | 'asset' | 'trap' | 'spoiled';
  scene: Scene;
  truth: Truth;
  /** Where its files are; none if it was made without. */
  folder?: string;
}

const samplesFolder = `${root}examples/samples`;

/** A model that lies in a folder. */
export type ModelFiles = Pick<Model, 'name' | 'kind'> & { folder: string };

/** The project's samples, and the models of the folder that CAGECAST_ASSETS names: folders with target.glb, cage.glb and truth.json. */
export function listFiles(): ModelFiles[] {
  const samples = (JSON.parse(readFileSync(`${samplesFolder}/index.json`, 'utf8')) as { name: string }[]).map(
    ({ name }): ModelFiles => {
      // Named after the model they were spoiled from.
      return { name, kind: name.includes('-') ? 'spoiled' : 'sample', folder: `${samplesFolder}/${name}` };
    },
  );
  const assets = process.env['CAGECAST_ASSETS'];
  const given = (assets === undefined ? [] : readdirSync(assets).sort())
    .filter((name) => ['target.glb', 'cage.glb', 'truth.json'].every((file) => existsSync(`${assets}/${name}/${file}`)))
    .map((name): ModelFiles => ({ name, kind: 'asset', folder: `${assets}/${name}` }));
  return [...samples, ...given].sort((a, b) => Number(a.kind === 'spoiled') - Number(b.kind === 'spoiled'));
}

/**
 * All models there are: of files, and those made to be difficult.
 * @param only  Names; all if undefined.
 * @throws {NoSuchModel} if a name is of none.
 * @throws {Error} if a truth is not of its target.
 */
export async function loadModels(only?: readonly string[]): Promise<Model[]> {
  const files = listFiles();
  const traps = only?.every((name) => files.some((file) => file.name === name)) ? [] : await loadTraps();
  const names = [...files, ...traps].map(({ name }) => name);
  const unknown = only?.find((name) => !names.includes(name));
  if (unknown !== undefined) throw new NoSuchModel(`no model is called "${unknown}"; there are ${names.join(', ')}`);
  const isWanted = ({ name }: { name: string }): boolean => only?.includes(name) ?? true;
  return [...(await Promise.all(files.filter(isWanted).map(loadFiles))), ...traps.filter(isWanted)];
}

/** A name was given that no model has. */
export class NoSuchModel extends Error {}

/**
 * Reads the files of a model.
 * @throws {Error} if its truth is not of its target.
 */
export async function loadFiles({ name, kind, folder }: ModelFiles): Promise<Model> {
  const [target, cage] = await Promise.all(['target', 'cage'].map((file) => readGlb(`${folder}/${file}.glb`)));
  const truth = readTruth(await readFile(`${folder}/truth.json`, 'utf8'));
  const found = target!.mesh.positions.length / 3;
  if (found !== truth.ncz.length)
    throw new Error(`${folder}: the target has ${found} vertices, its truth.json speaks of ${truth.ncz.length}`);
  return { name, kind, truth, folder, scene: { cage: cage!.mesh, target: target!.mesh } };
}

/** Labels are a string of 0 and 1 in the samples, and may be an array in models of others. */
function readTruth(text: string): Truth {
  const { ncz, ignore, offCage } = JSON.parse(text) as Record<keyof Truth, string | number[]>;
  const labelsOf = (labels: string | number[]): Uint8Array => Uint8Array.from(labels as number[]);
  return { ncz: labelsOf(ncz), ignore: labelsOf(ignore), offCage: labelsOf(offCage) };
}

/** The models of tests/core/scenes/traps.cpp, which the reference writes. */
async function loadTraps(): Promise<Model[]> {
  let reference = process.env['CAGECAST_REFERENCE'];
  if (reference === undefined) {
    await output('cmake', ['--preset', 'release', '-Wno-dev', '--log-level=WARNING']);
    await output('cmake', ['--build', '--preset', 'release', '--target', 'cagecast_reference']);
    reference = `${root}build/release/tests/core/cagecast_reference`;
  }
  const folder = `${root}build/bench/traps`;
  await mkdir(folder, { recursive: true });
  await output(reference, ['--traps', folder]);
  const names = readdirSync(folder).flatMap((file) => (file.endsWith('.scene') ? [file.replace('.scene', '')] : []));
  return Promise.all(
    names.sort().map(async (name): Promise<Model> => {
      const bytes = await readFile(`${folder}/${name}.scene`);
      const scene = readScene(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength) as ArrayBuffer);
      // Per vertex 0: to be painted, 1: not to be, 2: either; padded to whole words.
      const labels = new Uint8Array(await readFile(`${folder}/${name}.truth`)).subarray(
        0,
        scene.target.positions.length / 3,
      );
      const where = (wanted: number): Uint8Array => labels.map((label) => +(label === wanted));
      return {
        name,
        kind: 'trap',
        scene,
        truth: { ncz: where(1), ignore: where(2), offCage: new Uint8Array(labels.length) },
      };
    }),
  );
}
