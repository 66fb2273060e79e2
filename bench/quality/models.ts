import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { gunzipSync } from 'node:zlib';
import type { Mesh } from 'cagecast';
import type { CageModel, Landmarks, Template } from 'cagecast/cages';
import { output, root } from '../native.js';
import { type Labels, labelsOf, readJson } from '../public/labels.js';
import { type ModelFiles as LabelledFiles, readModel } from '../public/models.js';
import { readCage, readTarget } from '../read-glb.js';
import { readScene } from '../scene-file.js';

/** What is known of each vertex of a target. */
export interface Truth extends Labels {
  /** 1 the left eyeball, 2 the right one, 3 the lashes, 0 anything else. */
  eyes: Uint8Array;
}

/** A target with its cage, and the truth about it. */
export interface Model {
  name: string;
  /** `sample`: of the project; `asset`: given by the user; `trap`: made to be difficult; `spoiled`: a sample that goes wrong on purpose. */
  kind: 'sample' | 'asset' | 'trap' | 'spoiled';
  scene: { cage: Mesh; target: Mesh };
  truth: Truth;
}

/** The files of a model. */
export type ModelFiles = LabelledFiles & Pick<Model, 'kind'>;

const samplesFolder = `${root}examples/samples`;
const assets = process.env['CAGECAST_ASSETS'];

const foldersOf = (folder: string | undefined, ...files: string[]): string[] =>
  folder !== undefined && existsSync(folder)
    ? readdirSync(folder)
        .sort()
        .filter((name) => files.every((file) => existsSync(`${folder}/${name}/${file}`)))
    : [];

/** The samples, and the models of the folder that CAGECAST_ASSETS names: folders with target.glb, cage.glb and truth.json. */
export function listFiles(): ModelFiles[] {
  const filesOf = (folder: string, name: string) => ({
    target: `${folder}/${name}/target.glb`,
    cage: `${folder}/${name}/cage.glb`,
    labels: `${folder}/${name}/truth.json`,
  });
  const index = readFileSync(`${samplesFolder}/index.json`, 'utf8');
  const listed = JSON.parse(index) as { name: string; truth?: string }[];
  const samples = listed.flatMap(({ name, truth }): ModelFiles[] => {
    // Named after the model they were spoiled from.
    const kind = name.includes('-') ? 'spoiled' : 'sample';
    return truth ? [{ name, kind, ...filesOf(samplesFolder, name) }] : [];
  });
  const given = foldersOf(assets, 'target.glb', 'cage.glb', 'truth.json').map(
    (name): ModelFiles => ({ name, kind: 'asset', ...filesOf(assets!, name) }),
  );
  return [...samples, ...given].sort((a, b) => Number(a.kind === 'spoiled') - Number(b.kind === 'spoiled'));
}

/** A name was given that no model has. */
export class NoSuchModel extends Error {}

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
  const isChosen = ({ name }: { name: string }): boolean => only?.includes(name) ?? true;
  return [...(await Promise.all(files.filter(isChosen).map(loadFiles))), ...traps.filter(isChosen)];
}

/**
 * Reads the files of a model.
 * @throws {Error} if its truth is not of its target.
 */
export async function loadFiles(files: ModelFiles): Promise<Model> {
  const { name, scene, labels } = await readModel(files);
  return { name, kind: files.kind, scene, truth: { ...labels, eyes: eyesOf(readJson(files.labels), labels) } };
}

type TruthFile = Record<string, unknown> & {
  parts?: { name: string; firstVertex: number; vertexCount: number }[];
};

/** Which vertices are of eyeballs and lashes, by the names of parts. */
function eyesOf(file: TruthFile, { ncz }: Labels): Uint8Array {
  const eyes = new Uint8Array(ncz.length);
  for (const { name, firstVertex, vertexCount } of file.parts ?? []) {
    const what = /lash/i.test(name) ? 3 : /^l.*eye|eye.*(_l|left)$/i.test(name) ? 1 : /eye/i.test(name) ? 2 : 0;
    if (!/brow/i.test(name)) eyes.fill(what, firstVertex, firstVertex + vertexCount);
  }
  return eyes;
}

function truthOf(file: TruthFile, path: string, target: CageModel): Truth {
  const labels = labelsOf(file, path, target);
  return { ...labels, eyes: eyesOf(file, labels) };
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
  return names.sort().map((name): Model => {
    const scene = readScene(readFileSync(`${folder}/${name}.scene`));
    // Per vertex 0: to be painted, 1: not to be, 2: either; padded to whole words.
    const count = scene.target.positions.length / 3;
    const labels = new Uint8Array(readFileSync(`${folder}/${name}.truth`)).subarray(0, count);
    const [ncz, ignore] = [1, 2].map((label) => labels.map((other) => +(other === label))) as [Uint8Array, Uint8Array];
    const none = new Uint8Array(count);
    return { name, kind: 'trap', scene, truth: { ncz, ignore, offCage: none, eyes: none } };
  });
}

/** A model to make or to fit cages for. */
export interface Figure {
  name: string;
  /** What it is; goals differ by it. */
  kind: 'head' | 'body' | 'prop';
  target: CageModel;
  /** Made by hand, if there is one. */
  cage?: Template;
  truth: Truth;
  /** Name → position, of those that are known. Joint centres are called `joint_…`. */
  landmarks: Landmarks;
  /** Whether its parts have names that say what they are. */
  isNamed: boolean;
  /** Of a person: the figure whose vertices correspond to its own, or to the points `source` of a figure of the same topology. */
  template?: string;
  source?: Source;
}

/** For each vertex a point of another mesh. */
export interface Source {
  triangle: number[];
  barycentric: [number, number, number][];
}

/**
 * The samples, the models of CAGECAST_ASSETS, with or without a cage, and the people in its subfolder `people`.
 * @param only  Names; all if undefined.
 */
export async function loadFigures(only?: readonly string[]): Promise<Figure[]> {
  const isChosen = (name: string): boolean => only?.includes(name) ?? true;
  const figures: Figure[] = [];
  // The target of human-misaligned is that of human.
  const samples = foldersOf(samplesFolder, 'target.glb', 'cage.glb').filter((name) => name !== 'human-misaligned');
  for (const [folder, names] of [
    [samplesFolder, samples],
    [assets, foldersOf(assets, 'target.glb', 'truth.json')],
  ] as const)
    for (const name of names.filter(isChosen)) figures.push(await loadFigure(name, `${folder}/${name}`));
  const people = `${assets}/people`;
  for (const person of foldersOf(people, 'truth.json'))
    for (const file of readdirSync(`${people}/${person}`).sort())
      if (file.endsWith('.glb') && isChosen(`${person}_${file.replace('.glb', '')}`))
        figures.push(await loadPerson(`${people}/${person}`, file));
  return figures;
}

/** Reads a figure by the name of its folder. */
export async function loadFigure(name: string, folder = `${assets}/${name}`): Promise<Figure> {
  const [cage, landmarks] = [`${folder}/cage.glb`, `${folder}/landmarks.json`];
  const target = await readTarget(`${folder}/target.glb`);
  const isHead = /head|face|bust|human|lizard|suzanne/.test(name) && !/body/.test(name);
  return {
    name,
    kind: isHead ? 'head' : /body|avatar|figure/.test(name) ? 'body' : 'prop',
    target,
    ...(existsSync(cage) && { cage: await readCage(cage) }),
    truth: truthOf(readJson(`${folder}/truth.json`), `${folder}/truth.json`, target),
    landmarks: existsSync(landmarks) ? readJson(landmarks) : {},
    isNamed: !/fused|suzanne/.test(name),
  };
}

type PersonLandmarks = Record<'head' | 'body', Record<string, { position: [number, number, number] }>> & {
  joints: Landmarks;
};

async function loadPerson(folder: string, file: string): Promise<Figure> {
  const kind = file.startsWith('body') ? 'body' : 'head';
  const isFused = file === 'head_fused.glb';
  const target = await readTarget(`${folder}/${file}`);
  const known = readJson<PersonLandmarks>(`${folder}/landmarks.json`);
  const truth: TruthFile & { source?: Source } = isFused
    ? (JSON.parse(gunzipSync(readFileSync(`${folder}/truth_fused.json.gz`)).toString()) as TruthFile)
    : readJson<Record<'head' | 'body', TruthFile>>(`${folder}/truth.json`)[kind];
  return {
    name: `${folder.split('/').at(-1)}_${file.replace('.glb', '')}`,
    kind,
    target,
    truth: truthOf(truth, `${folder}: truth of ${file}`, target),
    landmarks: Object.fromEntries([
      ...Object.entries(known[kind]).map(([name, { position }]) => [name, position]),
      ...Object.entries(kind === 'body' ? known.joints : {}).map(([name, position]) => [`joint_${name}`, position]),
    ]),
    isNamed: !isFused && !file.includes('merged'),
    template: `makehuman_${kind}`,
    ...(truth.source && { source: truth.source }),
  };
}
