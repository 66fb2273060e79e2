// Measures everything, and writes bench/results.
//
//   npm run bench [-- options]
//     --only native,presets,web,mobile,size   only these parts; what else is known of today stays in the results
//     --quick                         few runs, up to 50k triangles: to see whether it works, not how fast it is
//     --record                        make the instruction counts and sizes of now the budget, and stop
//     --check                         hold instruction counts and sizes against the budget, and stop
//
// With CAGECAST_ASSETS naming a folder of models (each a folder with target.glb and cage.glb) those are measured too.

import { existsSync, readdirSync } from 'node:fs';
import { readFile, writeFile } from 'node:fs/promises';
import { cpus } from 'node:os';
import { parseArgs } from 'node:util';
import { checkInstructions, checkSizes, recordBudget } from './budget.js';
import { goalsOf, isReached } from './goals.js';
import { countAarch64, countWasm, countX86, hashOnAarch64 } from './instructions.js';
import { buildNative, measureNative, root, saveScene } from './native.js';
import { writeReport } from './report.js';
import { type PresetCost, type Results, readResults, resultsFolder, writeResults } from './results.js';
import { readScene, writeScene } from './scene-file.js';
import { type BenchScene, makeScenes, sampleScene, scenes } from './scenes.js';
import { measureSizes } from './size.js';
import { median } from './statistics.js';
import { chartCount, unfolded } from './uv-charts.js';
import type { FirstUse } from './web/first-page.js';
import { buildWeb, countBundle, raceInNode, WebBench } from './web.js';

const parts = ['native', 'presets', 'web', 'mobile', 'size'] as const;

const began = Date.now();
const say = (line: string): void =>
  console.error(`[${((Date.now() - began) / 1000).toFixed(0).padStart(4)} s] ${line}`);

function fail(message: string): never {
  console.error(message);
  process.exit(2);
}

function options(): { only: readonly string[]; quick: boolean; record: boolean; check: boolean } {
  try {
    const { values } = parseArgs({
      options: {
        only: { type: 'string' },
        quick: { type: 'boolean' },
        record: { type: 'boolean' },
        check: { type: 'boolean' },
      },
    });
    const only = values.only?.split(',') ?? parts;
    const unknown = only.find((part) => !(parts as readonly string[]).includes(part));
    if (unknown !== undefined) fail(`--only ${unknown}: there are ${parts.join(', ')}`);
    return { only, quick: values.quick ?? false, record: values.record ?? false, check: values.check ?? false };
  } catch (error) {
    fail((error as Error).message);
  }
}

/** The models of the folder that CAGECAST_ASSETS names, as scenes. */
async function sharedScenes(): Promise<BenchScene[]> {
  const folder = process.env['CAGECAST_ASSETS'];
  if (folder === undefined) return [];
  const found: BenchScene[] = [];
  for (const name of readdirSync(folder).sort()) {
    const [target, cage] = [`${folder}/${name}/target.glb`, `${folder}/${name}/cage.glb`];
    if (!existsSync(target) || !existsSync(cage)) continue;
    const path = `${root}build/bench/scenes/model-${name}.scene`;
    await saveScene(target, cage, path);
    found.push({ name, triangles: 10_000, cage: 'fixed', shuffled: false, path });
  }
  return found;
}

/** More runs of what is short. */
function runsFor(triangles: number, quick: boolean): number {
  const runs = triangles <= 10_000 ? 101 : triangles <= 50_000 ? 31 : triangles <= 500_000 ? 11 : 5;
  return quick ? Math.max(3, Math.round(runs / 10)) : runs;
}

/** Makes what is measured now the budget. */
async function record(): Promise<void> {
  const { instructions, gz } = await recordBudget();
  for (const [preset, counts] of Object.entries(instructions)) {
    for (const [processor, { perRun, compiler }] of Object.entries(counts))
      say(`${preset}, ${processor}: ${perRun} instructions a transfer, compiler ${compiler}: recorded`);
  }
  for (const [name, bytes] of Object.entries(gz)) say(`${name}: ${bytes} bytes gzipped: recorded`);
}

/** Holds instruction counts and sizes against the budget; whether they are within it. */
async function check(): Promise<boolean> {
  const counts: string[] = [];
  for (const preset of ['paper', 'default'] as const) {
    for (const processor of ['x86_64', 'aarch64'] as const) counts.push(await checkInstructions(processor, preset));
  }
  const problems = [...counts, await checkSizes()].filter((problem) => problem !== '');
  for (const problem of problems) console.error(problem);
  say(problems.length === 0 ? 'within the budget' : 'over the budget');
  return problems.length === 0;
}

async function main(): Promise<void> {
  const given = options();
  say('building');
  await buildNative();
  if (given.record) return record();
  if (given.check) process.exit((await check()) ? 0 : 1);
  await measure(given.only, given.quick);
}

/** What is known of today, to be measured anew in part. */
async function resultsOfToday(): Promise<Results> {
  const date = new Date().toISOString().slice(0, 10);
  const earlier = await readResults(date);
  const [processor] = cpus();
  const machine = { processor: processor!.model, cores: cpus().length, node: process.versions.node };
  return { ...earlier, date, machine: { ...earlier?.machine, ...machine } };
}

async function measure(only: readonly string[], quick: boolean): Promise<void> {
  const wanted = scenes.filter(({ triangles }) => !quick || triangles <= 50_000);
  await makeScenes(wanted, say);
  const models = await sharedScenes();
  const results = await resultsOfToday();
  if (only.includes('native')) await measureNatively(results, wanted, models, quick);
  if (only.includes('presets')) {
    results.presets = {};
    for (const scene of [sampleScene, await manyCharts(), ...models]) {
      say(`presets: ${scene.name}`);
      results.presets[scene.name] = await measurePresets(scene, runsFor(scene.triangles, quick));
      const { ratio, default: both } = results.presets[scene.name]!;
      say(
        `  default ${ratio.toFixed(2)} of paper's time, UVs per corner ${(both.corner - both.vertex).toFixed(3)} ms more`,
      );
    }
  }
  if (only.includes('size')) results.size = await measureSizes();
  // What is known is kept, whatever happens to the rest.
  await writeResults(results);
  if (only.includes('web') || only.includes('mobile')) await measureInBrowser(results, only, wanted, models, quick);
  await writeResults(results);
  await writeReport(results);
  for (const goal of goalsOf(results)) {
    const reached = isReached(goal);
    if (reached === undefined) continue;
    console.log(
      `${reached ? 'yes' : 'NO '}  ${goal.what}: ${goal.value!.toPrecision(4)} ${goal.unit} (${goal.kind} ${goal.limit})`,
    );
  }
  say(`written to ${resultsFolder.slice(root.length)}`);
}

async function measureNatively(
  results: Results,
  wanted: readonly BenchScene[],
  models: readonly BenchScene[],
  quick: boolean,
): Promise<void> {
  results.native = {};
  delete results.shuffled;
  for (const scene of [...wanted, ...models]) {
    say(`native: ${scene.name}`);
    const result = await measureNative(scene.path, runsFor(scene.triangles, quick), ['embree', 'nanoflann']);
    results.native[scene.name] = result;
    results.machine.compiler = result.compiler;
    say(
      `  ${result.cagecast.total.median.toFixed(3)} ms, ${result.peers['embree']!.ratios.total!.toFixed(3)} of Embree's`,
    );
  }
  const [ordered, shuffled] = ['500k', '500k-shuffled'].map(
    (name) => wanted.find((scene) => scene.name === name)?.path,
  );
  if (ordered === undefined || shuffled === undefined) return;
  say('native: 500k shuffled and not, in turn');
  const total = async (path: string): Promise<number> => (await measureNative(path, 5, [])).cagecast.total.median;
  const ratios: number[] = [];
  for (let i = 0; i < 7; ++i) {
    const before = await total(ordered);
    ratios.push((await total(shuffled)) / before);
  }
  results.shuffled = median(ratios);
}

async function measureInBrowser(
  results: Results,
  only: readonly string[],
  wanted: readonly BenchScene[],
  models: readonly BenchScene[],
  quick: boolean,
): Promise<void> {
  await buildWeb();
  const bench = await WebBench.start();
  try {
    results.machine.chromium = bench.version;
    const grown = wanted.filter(({ cage, shuffled }) => cage === 'grown' && !shuffled);
    if (only.includes('web')) results.web = await measureWeb(bench, [...grown, ...models], quick);
    await writeResults(results);
    if (only.includes('mobile')) results.mobile = await measureMobile(bench, quick);
  } finally {
    await bench.stop();
  }
}

/** The sample, its cage with a texture of many UV charts. */
async function manyCharts(): Promise<BenchScene> {
  const scene = {
    ...sampleScene,
    name: `${sampleScene.name}-many-charts`,
    path: `${root}build/bench/scenes/${sampleScene.name}-many-charts.scene`,
  };
  const { cage, target } = readScene((await readFile(sampleScene.path)).buffer);
  await writeFile(scene.path, writeScene({ cage: unfolded(cage), target }));
  return scene;
}

async function measurePresets(scene: BenchScene, runs: number): Promise<PresetCost> {
  const { cage } = readScene((await readFile(scene.path)).buffer);
  const { triangles, cageTriangles, cagecast, peers } = await measureNative(
    scene.path,
    runs,
    ['paper', 'embree', 'default'],
    ['--preset', 'default', '--seams', 'vertex'],
  );
  const [paper, corner] = [peers['paper']!, peers['default']!];
  return {
    triangles,
    cageTriangles,
    charts: chartCount(cage),
    paper: paper.times.total.median,
    default: { vertex: cagecast.total.median, corner: corner.times.total.median },
    ratio: paper.ratios.total!,
    stages: {
      recheck: corner.times.recheck.median,
      holes: corner.times.holes.median,
      seams: corner.times.seams.median,
    },
    embree: peers['embree']!.times.total.median,
  };
}

async function measureWeb(
  bench: WebBench,
  wanted: readonly BenchScene[],
  quick: boolean,
): Promise<NonNullable<Results['web']>> {
  const web: NonNullable<Results['web']> = {
    node: {},
    chromium: {},
    againstNativeEmbree: { ratio: 0, cagecast: 0, embree: 0 },
  };
  for (const scene of wanted) {
    // At 2M triangles a run of three-mesh-bvh takes most of a minute.
    const withPeer = scene.triangles <= 500_000;
    const isLarge = scene.triangles > 50_000;
    const race = {
      turns: quick || isLarge ? 3 : 11,
      turnMs: 150,
      warmUp: isLarge ? 2 : scene.triangles > 10_000 ? 6 : 80,
      withPeer,
    };
    say(`Chromium and Node: ${scene.name}`);
    web.chromium[scene.name] = await bench.race(scene, race);
    web.node[scene.name] = await raceInNode(scene, race);
    const { cagecast, peer } = web.chromium[scene.name]!;
    say(
      `  ${cagecast.median.toFixed(3)} ms in Chromium${peer ? `, three-mesh-bvh ${peer.ratio.toFixed(1)} times that` : ''}`,
    );
  }
  say('Chromium against native Embree');
  web.againstNativeEmbree = await bench.againstNativeEmbree(sampleScene, quick ? 3 : 11);
  return web;
}

async function measureMobile(bench: WebBench, quick: boolean): Promise<NonNullable<Results['mobile']>> {
  say('counting instructions');
  const x86 = await countX86(sampleScene.path);
  const aarch64 = await countAarch64(sampleScene.path);
  const native = await measureNative(sampleScene.path, 1, []);
  const firstUseAtRest: Record<string, FirstUse> = {};
  const firstUseOfPaper: Record<string, FirstUse> = {};
  const embree: Record<string, number> = {};
  const launches = quick ? 3 : 9;
  const mobile: NonNullable<Results['mobile']> = {
    aarch64: { ...aarch64, sameAnswer: (await hashOnAarch64(sampleScene.path)) === native.hash },
    x86_64: x86,
    wasm: {
      paper: await countWasm(countBundle, sampleScene.path, 'paper'),
      default: await countWasm(countBundle, sampleScene.path, 'default'),
    },
    warm: {},
    firstUse: {},
    firstUseAtRest,
    firstUseOfPaper,
    embree,
  };
  for (const rate of [1, 4, 6]) {
    say(`Chromium slowed ${rate}×`);
    const beside: number[] = [];
    const besideEmbree = async <T>(measure: Promise<T>): Promise<T> => {
      const measured = await measure;
      beside.push((await measureNative(sampleScene.path, 21, ['embree'])).peers['embree']!.times.total.median);
      return measured;
    };
    mobile.warm[rate] = await besideEmbree(bench.throttled(sampleScene, rate, quick ? 1 : 5, 101));
    mobile.firstUse[rate] = await besideEmbree(bench.firstUse(sampleScene, rate, launches, 'default', 'at once'));
    firstUseAtRest[rate] = await besideEmbree(bench.firstUse(sampleScene, rate, launches, 'default', 'at rest'));
    firstUseOfPaper[rate] = await besideEmbree(bench.firstUse(sampleScene, rate, launches, 'paper', 'at rest'));
    embree[rate] = median(beside);
  }
  return mobile;
}

await main().catch((error: Error) => {
  console.error(error.message);
  process.exit(1);
});
