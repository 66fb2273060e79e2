// Measures how well what must not be painted is left bare, and what is to be painted is painted, by the package in Node.
//
//   npm run quality [-- options]
//     --only lizard,car   only these models; the results stay as they are
//     --check             exit 1 where a goal is missed
//     --cages             only what is about made and fitted cages; the results stay as they are
//
// Over the samples, those of the folder that CAGECAST_ASSETS names (folders with target.glb, cage.glb and truth.json), and
// the models made to be difficult. Cages are made for samples and given models, and for the people in the given folder's
// subfolder `people`, whom templates are fitted to as well. Tables on the terminal and in bench/results/quality.md, all numbers beside it.

import { writeFile } from 'node:fs/promises';
import { parseArgs } from 'node:util';
import { init } from 'cagecast';
import { kMachine, writeJson } from './native.js';
import { measureCages } from './quality/cages.js';
import { missedCageGoals, missedGoals } from './quality/goals.js';
import { measure } from './quality/measure.js';
import { loadModels, NoSuchModel } from './quality/models.js';
import { cageSections, type QualityResults, qualityReport } from './quality/report.js';

const began = performance.now();
const say = (line: string): void =>
  console.error(`[${((performance.now() - began) / 1000).toFixed(0).padStart(3)} s] ${line}`);

async function main(): Promise<void> {
  const { values: options } = parseArgs({
    options: { only: { type: 'string' }, check: { type: 'boolean' }, cages: { type: 'boolean' } },
  });
  const only = options.only?.split(',');
  await init();
  const results: QualityResults = {
    date: new Date().toISOString().slice(0, 10),
    machine: kMachine,
    models: {},
    cages: { made: {}, byHand: {}, fitted: {}, given: {}, failed: [] },
  };
  for (const model of options.cages ? [] : await loadModels(only)) {
    say(model.name);
    results.models[model.name] = measure(model);
  }
  results.cages = await measureCages(only, say);
  const missed = [...missedGoals(results.models), ...missedCageGoals(results.cages)];
  const list = missed.map((line) => `- ${line}`);
  console.log(options.cages ? [...cageSections(results.cages), ...list].join('\n\n') : qualityReport(results));
  if (!only && !options.cages) {
    await writeJson('quality', results);
    await writeFile('bench/results/quality.md', qualityReport(results));
  }
  if (options.check && missed.length > 0) process.exitCode = 1;
}

await main().catch((error: Error) => {
  console.error(error.message);
  process.exit(error instanceof NoSuchModel ? 2 : 1);
});
