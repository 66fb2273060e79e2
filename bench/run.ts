// Measures everything, and writes bench/results.
//
//   npm run bench [-- options]
//     --only native,web,count,size,waits   only these parts; what else is known stays in the results
//     --avatars FOLDER               waits: with open avatars, of those that bench/avatars names, beside the samples
//     --quick                        few runs, up to 50k triangles: to see whether it works, not how fast it is
//     --record                       make the instruction counts and sizes of now the budget, and stop
//     --check                        hold instruction counts and sizes against the budget, and stop
//
// With CAGECAST_ASSETS naming a folder of models (each a folder with target.glb and cage.glb) those are measured too.

import { readFileSync } from 'node:fs';
import { writeFile } from 'node:fs/promises';
import { resolve } from 'node:path';
import { parseArgs } from 'node:util';
import { checkInstructions, checkSizes, countInstructions, measureSizes, recordBudget } from './budget.js';
import { buildNative, kMachine, kStages, measureNative, ratioOf, resultsFolder, timeOf, writeJson } from './native.js';
import { goalsOf, type Results, speedReport } from './report.js';
import { type BenchScene, givenScenes, kScenes, makeScenes, sampleScene } from './scenes.js';
import { median } from './statistics.js';
import { measurePage } from './waits/page.js';
import { measureGrowth, measureWaits, modelsOf } from './waits.js';
import type { FirstUse } from './web/page.js';
import { WebBench } from './web.js';

const kParts = ['native', 'web', 'count', 'size', 'waits'];
const kPresets = ['paper', 'default'] as const;
const kProcessors = ['x86_64', 'aarch64'] as const;

const began = Date.now();
const say = (line: string): void =>
  console.error(`[${((Date.now() - began) / 1000).toFixed(0).padStart(4)} s] ${line}`);

async function main(): Promise<void> {
  const { values } = parseArgs({
    options: {
      only: { type: 'string' },
      avatars: { type: 'string' },
      quick: { type: 'boolean', default: false },
      record: { type: 'boolean' },
      check: { type: 'boolean' },
    },
  });
  const only = values.only?.split(',') ?? kParts;
  const unknown = only.find((part) => !kParts.includes(part));
  if (unknown !== undefined) throw new Error(`--only ${unknown}: there are ${kParts.join(', ')}`);
  if (values.record) return void console.log(JSON.stringify(await recordBudget(), null, 2));
  if (values.check) return check();
  const avatars = values.avatars && resolve(process.env['INIT_CWD'] ?? '.', values.avatars);
  await measure(only, values.quick, avatars);
}

/** Holds instruction counts and sizes against the budget. */
async function check(): Promise<void> {
  const problems = [await checkSizes()];
  for (const preset of kPresets)
    for (const processor of kProcessors) problems.push(await checkInstructions(processor, preset));
  const found = problems.filter((problem) => problem !== '');
  for (const problem of found) console.error(problem);
  say(found.length === 0 ? 'within the budget' : 'over the budget');
  if (found.length > 0) process.exitCode = 1;
}

async function measure(only: readonly string[], quick: boolean, avatars: string | undefined): Promise<void> {
  const needsScenes = only.some((part) => part !== 'waits' && part !== 'size');
  const all = needsScenes ? await scenesFor(quick) : [];
  const results: Results = { ...earlier(), date: new Date().toISOString().slice(0, 10), machine: kMachine };
  if (only.includes('size')) results.sizes = await measureSizes();
  if (only.includes('native')) results.native = await measureNatively(all, quick);
  if (only.includes('web')) results.web = await measureWeb(all, quick);
  if (only.includes('count')) {
    results.instructions = {};
    for (const preset of kPresets)
      for (const processor of kProcessors)
        results.instructions[`${preset}, ${processor}`] = (await countInstructions(processor, preset)).perRun;
  }
  if (only.includes('waits')) {
    results.waits = measureWaits(avatars, quick ? 1 : 3, say);
    results.page = await measurePage(modelsOf(avatars), say);
    results.growth = await measureGrowth(quick ? 1 : 3, say);
  }
  await writeJson('speed', results);
  await writeFile(`${resultsFolder}/README.md`, speedReport(results));
  for (const { what, text, isReached } of goalsOf(results))
    console.log(`${isReached ? 'yes' : 'NO '}  ${what}: ${text}`);
}

/** Builds what measures, and makes the scenes. */
async function scenesFor(quick: boolean): Promise<BenchScene[]> {
  say('building');
  await buildNative();
  const chosen = kScenes.filter(({ triangles }) => !quick || triangles <= 50_000);
  await makeScenes(chosen, say);
  return [...chosen, ...(await givenScenes())];
}

/** What was measured before. */
function earlier(): Partial<Results> {
  try {
    return JSON.parse(readFileSync(`${resultsFolder}/speed.json`, 'utf8')) as Results;
  } catch {
    return {};
  }
}

/** More runs of what is short. */
const runsFor = (triangles: number, quick: boolean): number =>
  quick ? 3 : triangles <= 10_000 ? 101 : triangles <= 50_000 ? 31 : triangles <= 500_000 ? 11 : 5;

async function measureNatively(all: readonly BenchScene[], quick: boolean): Promise<NonNullable<Results['native']>> {
  const native: NonNullable<Results['native']> = {};
  const isBuilt = await measureNative(sampleScene.path, 1, ['embree']).catch(() => undefined);
  const contestants = ['paper', 'default', ...(isBuilt ? ['embree'] : []), 'nanoflann'];
  if (!isBuilt) say('without Embree, which this machine lacks');
  for (const { name, path, triangles } of all) {
    say(`native: ${name}`);
    const result = await measureNative(path, runsFor(triangles, quick), contestants);
    const { paper, embree } = result.contestants;
    const ratio = (name: string, by: string): number => ratioOf(result, name, by);
    native[name] = {
      triangles: result.triangles,
      cageTriangles: result.cageTriangles,
      times: Object.fromEntries(contestants.map((one) => [one, timeOf(result, one)])),
      ratios: {
        nanoflann: ratio('paper', 'nanoflann'),
        default: ratio('default', 'paper'),
        ...(embree && { embree: ratio('paper', 'embree') }),
      },
      stages: Object.fromEntries(
        kStages.map((stage) => [
          stage,
          Object.fromEntries(contestants.map((one) => [one, timeOf(result, one, stage)])),
        ]),
      ),
      peakBytes: paper!.peakBytes!,
      ...(embree && { otherZones: embree.otherZones! / result.vertices }),
    };
  }
  return native;
}

async function measureWeb(all: readonly BenchScene[], quick: boolean): Promise<NonNullable<Results['web']>> {
  const bench = await WebBench.start();
  try {
    const web: NonNullable<Results['web']> = { chromium: '', races: {}, firstUse: {} };
    for (const scene of all.filter(({ isCageGrown, triangles }) => isCageGrown || triangles < 50_000)) {
      say(`Chromium: ${scene.name}`);
      // At 2M triangles a run of three-mesh-bvh takes most of a minute.
      const withPeer = scene.triangles <= 500_000;
      const isLarge = scene.triangles > 50_000;
      const warmUp = isLarge ? 2 : scene.triangles > 10_000 ? 6 : 80;
      const race = await bench.race(scene, { turns: quick || isLarge ? 3 : 11, turnMs: 500, warmUp, withPeer });
      web.races[scene.name] = {
        cagecast: median(race.cagecast),
        ...(withPeer && {
          peer: median(race.peer),
          ratio: median(race.cagecast.map((time, i) => race.peer[i]! / time)),
          otherZones: race.otherZones,
        }),
      };
    }
    for (const rate of [1, 4]) {
      say(`Chromium slowed ${rate}×`);
      const uses: FirstUse[] = [];
      for (let i = 0; i < (quick ? 3 : 9); ++i) uses.push(await bench.firstUse(sampleScene, rate));
      const of = (field: keyof FirstUse): number => median(uses.map((use) => use[field]));
      web.firstUse[rate] = { import: of('import'), init: of('init'), transfer: of('transfer'), total: of('total') };
    }
    return { ...web, chromium: bench.version };
  } finally {
    await bench.stop();
  }
}

await main().catch((error: Error) => {
  console.error(error.message);
  process.exit(1);
});
