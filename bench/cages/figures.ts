import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';
import { root } from '../native.js';

/** Where the figures are written, and the cages for them. */
export const cagesFolder = `${root}build/cages`;

/** What a model is; goals differ by it. */
export type Kind = 'head' | 'body' | 'prop';

/** What is known of each vertex of a target; see examples/samples/README.md. */
export interface FigureTruth {
  ncz: number[];
  ignore: number[];
  /** Of the hand-made cage; zeros where there is none. */
  offCage: number[];
  /** Per vertex: 1 the left eyeball, 2 the right one, 3 the lashes, 0 anything else. */
  eyes: number[];
}

/** The same point of a mesh for each vertex of another. */
export interface Source {
  triangle: number[];
  barycentric: [number, number, number][];
}

/** A model to make or to fit cages for. */
export interface Figure {
  name: string;
  kind: Kind;
  /** Its target's file. */
  target: string;
  /** A hand-made cage's file, if there is one. */
  cage?: string;
  truth: FigureTruth;
  /** Name → position, of those that are known. Joint centres are called `joint_…`. */
  landmarks: Record<string, [number, number, number]>;
  /** The template whose vertices correspond to its own; none for figures of other topology. */
  template?: string;
  /** The vertices of `template` are not its own but correspond to these points of another figure of the same topology. */
  source?: { of: string; points: Source };
  /** Whether its parts have names that say what they are. */
  named: boolean;
}

/** Figures that fits are measured with, by kind. */
export const templates: Readonly<Record<'head' | 'body', string>> = { head: 'makehuman_head', body: 'makehuman_body' };

/** Per vertex: a string of 0 and 1, or an array of them. */
type Labels = string | number[];

interface TruthFile {
  ncz: Labels;
  ignore: Labels;
  offCage?: Labels;
  parts?: { name: string; firstVertex: number; vertexCount: number }[];
}
type PersonLandmarks = Record<'head' | 'body', Record<string, { position: [number, number, number] }>> & {
  joints: Record<string, [number, number, number]>;
};

/** The project's samples, and what is in the folder that CAGECAST_ASSETS names and in its subfolder `people`. */
export function listFigures(): Figure[] {
  const assets = process.env['CAGECAST_ASSETS'];
  const samples = `${root}examples/samples`;
  return [
    ...foldersOf(samples)
      .filter((name) => name !== 'human-misaligned') // its target is that of `human`
      .filter((name) => existsSync(`${samples}/${name}/cage.glb`)) // models of templates are no samples
      .map((name) => readFolder(name, `${samples}/${name}`)),
    ...(assets === undefined ? [] : foldersOf(assets).map((name) => readFolder(name, `${assets}/${name}`))),
    ...(assets === undefined ? [] : foldersOf(`${assets}/people`)).flatMap((name) =>
      readPerson(name, `${assets}/people/${name}`),
    ),
  ];
}

const foldersOf = (folder: string): string[] =>
  existsSync(folder)
    ? readdirSync(folder)
        .sort()
        .filter((name) => existsSync(`${folder}/${name}/truth.json`))
    : [];

const readJson = <T>(path: string): T => JSON.parse(readFileSync(path, 'utf8')) as T;

/** Samples that the package's templates were made for, whose landmarks are therefore known. */
const sampleTemplates: Readonly<Record<string, string>> = { human: 'human-head' };

/** The landmarks that a template has in the extras of its mesh. */
function landmarksOf(template: string): Figure['landmarks'] {
  const bytes = readFileSync(`${root}examples/samples/templates/${template}.glb`);
  const json = JSON.parse(bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12))) as {
    meshes: { extras?: { landmarks?: Figure['landmarks'] } }[];
  };
  return json.meshes[0]?.extras?.landmarks ?? {};
}

function readFolder(name: string, folder: string): Figure {
  const landmarks = `${folder}/landmarks.json`;
  const template = sampleTemplates[name];
  return {
    name,
    kind: kindOf(name),
    target: `${folder}/target.glb`,
    ...(existsSync(`${folder}/cage.glb`) && { cage: `${folder}/cage.glb` }),
    truth: truthOf(readJson(`${folder}/truth.json`)),
    landmarks: template ? landmarksOf(template) : existsSync(landmarks) ? readJson(landmarks) : {},
    named: !/fused|suzanne/.test(name),
  };
}

/** Guessed from the name, because the files do not say it. */
function kindOf(name: string): Kind {
  if (/head|face|bust|human|lizard|suzanne/.test(name) && !/body/.test(name)) return 'head';
  return /body|avatar|figure/.test(name) ? 'body' : 'prop';
}

function readPerson(person: string, folder: string): Figure[] {
  const landmarks = readJson<PersonLandmarks>(`${folder}/landmarks.json`);
  const truths = readJson<Record<'head' | 'body', TruthFile>>(`${folder}/truth.json`);
  return readdirSync(folder)
    .sort()
    .filter((file) => file.endsWith('.glb'))
    .map((file): Figure => {
      const kind = file.startsWith('body') ? 'body' : 'head';
      const joints = Object.entries(kind === 'body' ? landmarks.joints : {});
      const shared = {
        name: `${person}_${file.replace('.glb', '')}`,
        kind,
        target: `${folder}/${file}`,
        template: templates[kind],
        landmarks: Object.fromEntries([
          ...Object.entries(landmarks[kind]).map(([name, { position }]) => [name, position]),
          ...joints.map(([name, position]) => [`joint_${name}`, position]),
        ]),
      } satisfies Partial<Figure>;
      if (file !== 'head_fused.glb')
        return { ...shared, truth: truthOf(truths[kind]), named: !file.includes('merged') };
      const fused = JSON.parse(gunzipSync(readFileSync(`${folder}/truth_fused.json.gz`)).toString()) as TruthFile & {
        source: Source;
      };
      return { ...shared, truth: truthOf(fused), named: false, source: { of: `${person}_head`, points: fused.source } };
    });
}

function truthOf(file: TruthFile): FigureTruth {
  const { parts = [] } = file;
  const [ncz, ignore, offCage] = [file.ncz, file.ignore, file.offCage ?? []].map((labels) =>
    [...labels].map(Number),
  ) as [number[], number[], number[]];
  const eyes = ncz.map(() => 0);
  for (const { name, firstVertex, vertexCount } of parts) {
    const what = /lash/i.test(name) ? 3 : /^l.*eye|eye.*(_l|left)$/i.test(name) ? 1 : /eye/i.test(name) ? 2 : 0;
    if (!/brow/i.test(name)) eyes.fill(what, firstVertex, firstVertex + vertexCount);
  }
  return { ncz, ignore, offCage: file.offCage ? offCage : ncz.map(() => 0), eyes };
}
