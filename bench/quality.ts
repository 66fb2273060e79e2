// Measures how well what must not be painted is left bare, and what is to be painted is painted, by the package in Node.
//
//   npm run quality [-- options]
//     --only lizard,car   only these models; the results stay as they are
//     --check             exit 1 where a goal is missed
//     --cages             only what is about made and fitted cages; the results stay as they are
//
// Over the samples, those of the folder that CAGECAST_ASSETS names (folders with target.glb, cage.glb and truth.json), and
// the models made to be difficult. Cages are made for samples and given models, and for the people in the given folder's
// subfolder `people`, whom templates are fitted to as well. Tables on the terminal and in bench/results/quality.md, a plot and
// all numbers beside it; the samples in pictures, docs/pictures/quality.jpg and failures.jpg, and the given models in another,
// build/bench/quality.jpg.

import { cpus } from 'node:os';
import { parseArgs } from 'node:util';
import { init } from 'cagecast';
import { root } from './native.js';
import { cageSections } from './quality/cage-report.js';
import { measureCages } from './quality/cages.js';
import { missedCageGoals, missedGoals } from './quality/goals.js';
import { measure, measureLargeTimes, measureTimes } from './quality/measure.js';
import { loadModels, type Model, NoSuchModel } from './quality/models.js';
import { type QualityResults, qualityReport, writeQuality } from './quality/report.js';
import { drawSheet } from './quality/sheet.js';

const began = performance.now();
const say = (line: string): void =>
  console.error(`[${((performance.now() - began) / 1000).toFixed(0).padStart(3)} s] ${line}`);

/** How often each way is timed. */
const runs = 31;
const largeRuns = 7;

async function main(): Promise<void> {
  const { values: options } = parseArgs({
    options: { only: { type: 'string' }, check: { type: 'boolean' }, cages: { type: 'boolean' } },
  });
  const only = options.only?.split(',');
  await init();
  if (options.cages) {
    const cages = await measureCages(only, say);
    const missed = missedCageGoals(cages);
    console.log([...cageSections(cages), ...missed.map((line) => `- ${line}`)].join('\n\n'));
    if (options.check && missed.length > 0) process.exitCode = 1;
    return;
  }
  say('reading the models');
  const models = await loadModels(only);
  const results: QualityResults = {
    date: new Date().toISOString().slice(0, 10),
    machine: { processor: cpus()[0]!.model, cores: cpus().length, node: process.versions.node },
    models: {},
    times: {},
    largeTimes: { naive: 0, 'step 2': 0, 'step 3': 0, paper: 0, default: 0 },
    cages: { made: {}, fitted: {}, given: {}, failed: [] },
  };
  for (const model of models) {
    say(model.name);
    try {
      results.models[model.name] = await measure(model);
    } catch (error) {
      throw new Error(`${model.folder ?? model.name}: ${(error as Error).message}`, { cause: error });
    }
  }
  // After all else, which has warmed up the engine.
  say('times');
  for (const model of models) results.times[model.name] = measureTimes(model, runs);
  results.largeTimes = await measureLargeTimes(models[0]!, largeRuns);
  results.cages = await measureCages(only, say);
  console.log(qualityReport(results));
  if (options.only === undefined) {
    await writeQuality(results);
    say('drawing the samples');
    const are = (kind: Model['kind']): Model[] => models.filter((model) => model.kind === kind);
    await drawSheet(are('sample'), ['cage', 'naive', 'removed', 'default'], `${root}docs/pictures/quality.jpg`);
    await drawSheet(are('spoiled'), ['cage', 'naive', 'paper', 'default'], `${root}docs/pictures/failures.jpg`);
    if (are('asset').length > 0)
      await drawSheet(are('asset'), ['cage', 'naive', 'paper', 'default'], `${root}build/bench/quality.jpg`);
  }
  say('done');
  const missed = [...missedGoals(results.models), ...missedCageGoals(results.cages)];
  if (options.check && missed.length > 0) process.exitCode = 1;
}

await main().catch((error: Error) => {
  console.error(error.message);
  process.exit(error instanceof NoSuchModel ? 2 : 1);
});
