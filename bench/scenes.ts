import { createHash } from 'node:crypto';
import { existsSync } from 'node:fs';
import { mkdir, readFile, rename, rm, writeFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { saveScene } from './native.js';
import { bent, resized, shuffled } from './resize.js';
import { readScene, type Scene, writeScene } from './scene-file.js';

/** One input of the benchmark. */
export interface BenchScene {
  name: string;
  /** About how many triangles the target has. */
  triangles: number;
  /** `grown`: as many triangles a target triangle as the sample's; `fixed`: the sample's own, at every size. */
  cage: 'grown' | 'fixed';
  shuffled: boolean;
  /** Its scene file. */
  path: string;
}

const root = fileURLToPath(new URL('..', import.meta.url));
const folder = `${root}build/bench/scenes`;
const model = `${root}examples/samples/lizard`;
const sources = ['resize.ts', 'scenes.ts', 'scene-file.ts'].map((name) =>
  fileURLToPath(new URL(name, import.meta.url)),
);

/** The triangles of the sample model, of which all others are made. */
export const sampleTriangles = 4782;
/** The sizes that are measured. */
export const sizes = [1200, sampleTriangles, 50_000, 500_000, 2_000_000];

const describe = (triangles: number, cage: 'grown' | 'fixed', isShuffled = false): BenchScene => {
  const size = triangles >= 1e6 ? `${triangles / 1e6}M` : `${+(triangles / 1e3).toFixed(1)}k`;
  const name = `${size}${cage === 'fixed' ? '-fixed-cage' : ''}${isShuffled ? '-shuffled' : ''}`;
  return { name, triangles, cage, shuffled: isShuffled, path: `${folder}/${name}.scene` };
};

/** Everything that is measured: each size with a growing cage and from the sample up with a fixed one, and one size shuffled. */
export const scenes: readonly BenchScene[] = [
  ...sizes.map((triangles) => describe(triangles, 'grown')),
  ...sizes.filter((triangles) => triangles > sampleTriangles).map((triangles) => describe(triangles, 'fixed')),
  describe(500_000, 'grown', true),
];

/** The sample model itself. */
export const sampleScene = scenes.find(({ triangles }) => triangles === sampleTriangles)!;

/** Makes the scene files that are not there yet, or were made of another model or by other code. */
export async function makeScenes(wanted: readonly BenchScene[], say: (line: string) => void): Promise<void> {
  const hash = createHash('sha256');
  const files = [...sources, `${model}/target.glb`, `${model}/cage.glb`];
  for (const file of files) hash.update(await readFile(file));
  const stamp = hash.digest('hex');
  const stampFile = `${folder}/made-of`;
  if (!existsSync(stampFile) || (await readFile(stampFile, 'utf8')) !== stamp) {
    await rm(folder, { recursive: true, force: true });
    await mkdir(folder, { recursive: true });
    await writeFile(stampFile, stamp);
  }
  const missing = wanted.filter(({ path }) => !existsSync(path));
  if (missing.length === 0) return;
  await saveScene(`${model}/target.glb`, `${model}/cage.glb`, sampleScene.path);
  const sample = readScene((await readFile(sampleScene.path)).buffer);
  for (const scene of missing) {
    if (scene === sampleScene) continue;
    say(`making ${scene.name}`);
    await writeFile(`${scene.path}.part`, writeScene(await make(sample, scene)));
    await rename(`${scene.path}.part`, scene.path);
  }
}

async function make(sample: Scene, { triangles, cage, shuffled: isShuffled }: BenchScene): Promise<Scene> {
  const cageTriangles = sample.cage.indices.length / 3;
  const resizedCage =
    cage === 'fixed'
      ? sample.cage
      : await resized(sample.cage, Math.round((triangles / sampleTriangles) * cageTriangles));
  const scene = bent({ cage: resizedCage, target: await resized(sample.target, triangles) }, 0.002);
  return isShuffled ? { ...scene, target: shuffled(scene.target, 1) } : scene;
}
