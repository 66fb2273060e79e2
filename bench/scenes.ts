import { createHash } from 'node:crypto';
import { existsSync, readdirSync } from 'node:fs';
import { mkdir, readFile, rename, rm, writeFile } from 'node:fs/promises';
import { root } from './native.js';
import { readCage, readTarget } from './read-glb.js';
import { bent, resized } from './resize.js';
import { type Scene, type SceneMesh, writeScene } from './scene-file.js';

/** One input of the benchmark. */
export interface BenchScene {
  name: string;
  /** About how many triangles the target has. */
  triangles: number;
  /** Whether the cage has as many triangles a target triangle as the sample's, or the sample's own, at every size. */
  isCageGrown: boolean;
  /** Its scene file. */
  path: string;
}

const folder = `${root}build/bench/scenes`;
const model = `${root}examples/samples/lizard`;

/** The triangles of the sample model, of which all others are made. */
const kSampleTriangles = 4782;
/** The sizes that are measured. */
const kSizes = [1200, kSampleTriangles, 50_000, 500_000, 2_000_000];

const describe = (triangles: number, isCageGrown: boolean): BenchScene => {
  const size = triangles >= 1e6 ? `${triangles / 1e6}M` : `${+(triangles / 1e3).toFixed(1)}k`;
  const name = `${size}${isCageGrown ? '' : '-fixed-cage'}`;
  return { name, triangles, isCageGrown, path: `${folder}/${name}.scene` };
};

/** Everything that is measured: each size with a growing cage, and from the sample up with a fixed one. */
export const kScenes: readonly BenchScene[] = [
  ...kSizes.map((triangles) => describe(triangles, true)),
  ...kSizes.filter((triangles) => triangles > kSampleTriangles).map((triangles) => describe(triangles, false)),
];

/** The sample model itself. */
export const sampleScene = kScenes.find(({ triangles }) => triangles === kSampleTriangles)!;

/** Makes the scene files that are not there yet, or were made of another model or by other code. */
export async function makeScenes(wanted: readonly BenchScene[], say: (line: string) => void): Promise<void> {
  const hash = createHash('sha256');
  const sources = ['resize.ts', 'scenes.ts', 'scene-file.ts'].map((name) => `${root}bench/${name}`);
  for (const file of [...sources, `${model}/target.glb`, `${model}/cage.glb`]) hash.update(await readFile(file));
  const stamp = hash.digest('hex');
  const stampFile = `${folder}/made-of`;
  if (!existsSync(stampFile) || (await readFile(stampFile, 'utf8')) !== stamp) {
    await rm(folder, { recursive: true, force: true });
    await mkdir(folder, { recursive: true });
    await writeFile(stampFile, stamp);
  }
  const missing = wanted.filter(({ path }) => !existsSync(path));
  if (missing.length === 0) return;
  const sample = await readModel(`${model}/target.glb`, `${model}/cage.glb`);
  for (const scene of missing) {
    say(`making ${scene.name}`);
    await writeFile(`${scene.path}.part`, writeScene(scene === sampleScene ? sample : await make(sample, scene)));
    await rename(`${scene.path}.part`, scene.path);
  }
}

async function make(sample: Scene, { triangles, isCageGrown }: BenchScene): Promise<Scene> {
  const cageTriangles = Math.round((triangles / kSampleTriangles) * (sample.cage.indices.length / 3));
  const cage = isCageGrown ? await resized(sample.cage, cageTriangles) : sample.cage;
  return bent({ cage, target: await resized(sample.target, triangles) }, 0.002);
}

async function readModel(targetFile: string, cageFile: string): Promise<Scene> {
  const arrays = ({ positions, indices, uvs, groups }: Partial<SceneMesh>): SceneMesh => ({
    positions: positions!,
    indices: Uint32Array.from(indices!),
    ...(uvs && { uvs }),
    ...(groups && { groups }),
  });
  const [target, cage] = [await readTarget(targetFile), await readCage(cageFile)];
  return { cage: arrays(cage as SceneMesh), target: arrays(target as SceneMesh) };
}

/** The models of the folder that CAGECAST_ASSETS names, as scenes: each a folder with target.glb and cage.glb. */
export async function givenScenes(): Promise<BenchScene[]> {
  const assets = process.env['CAGECAST_ASSETS'];
  const found: BenchScene[] = [];
  for (const name of assets === undefined ? [] : readdirSync(assets).sort()) {
    const [target, cage] = [`${assets}/${name}/target.glb`, `${assets}/${name}/cage.glb`];
    if (!existsSync(target) || !existsSync(cage)) continue;
    const path = `${folder}/model-${name}.scene`;
    const scene = await readModel(target, cage);
    await writeFile(path, writeScene(scene));
    found.push({ name, triangles: scene.target.indices.length / 3, isCageGrown: false, path });
  }
  return found;
}
