// Runs methods that find zones over labelled models: README.md. What the command line may say is in kHelp.

import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { parseArgs } from 'node:util';
import { kMachine, root } from '../native.js';
import { score } from '../quality/score.js';
import { median } from '../statistics.js';
import { kIncluded, type Method, methodOf, run, writeArrays } from './methods.js';
import { Misuse } from './misuse.js';
import { findModels, nameFor, readModel } from './models.js';
import { draw } from './pictures.js';
import { markdown, page, type Results, type Row, summaryOf } from './report.js';

const kSamples = ['lizard', 'human', 'car', 'human-fused'].map((name) => `${root}examples/samples/${name}`);

/** The picture that is not of a method. */
const kTruth = 'truth';

const kHelp = `npm run bench:public -- [FOLDER …] [options]
  FOLDER                a model, or a folder of models; default: the labelled samples of the project
  --method a,./b.py     names of methods that are included, and files or programs of others; default: ${kIncluded.join(',')}
  --runs N              timed runs, after one that is not; default: 5
  --timeout SECONDS     for a method and a model; default: 300
  --output FOLDER       for results.html, results.md and results.json, which are overwritten; default: build/bench/public`;

function readOptions() {
  const text = { type: 'string' } as const;
  const help = { type: 'boolean' } as const;
  const options = { method: { ...text, multiple: true }, runs: text, timeout: text, output: text, help } as const;
  try {
    return parseArgs({ allowPositionals: true, options });
  } catch (error) {
    throw new Misuse(`${(error as Error).message}\n${kHelp}`);
  }
}

function positive(option: string, text: string): number {
  const value = Number(text);
  if (Number.isInteger(value) && value > 0) return value;
  throw new Misuse(`--${option} is ${JSON.stringify(text)}; a whole number above 0 is expected`);
}

async function main(): Promise<void> {
  const { values, positionals } = readOptions();
  if (values.help) return console.log(kHelp);
  // npm runs scripts in the folder of the project, wherever it is called.
  const here = process.env['INIT_CWD'] ?? process.cwd();
  const [runs, timeout] = [positive('runs', values.runs ?? '5'), positive('timeout', values.timeout ?? '300')];
  const methods: Method[] = [];
  for (const text of (values.method ?? kIncluded).flatMap((list) => list.split(',')).filter(Boolean)) {
    const method = methodOf(text, here);
    methods.push({ ...method, name: nameFor(method.name, [{ name: kTruth }, ...methods]) });
  }
  const folders = positionals.map((folder) => resolve(here, folder));
  const { models, skipped } = findModels(folders.length > 0 ? folders : kSamples);
  for (const line of skipped) console.error(`skipped ${line}`);
  const results: Results = {
    date: new Date().toISOString().slice(0, 10),
    machine: kMachine,
    runs,
    models: {},
    skipped,
  };
  const say = (text: string): void => void process.stderr.write(text);
  const pictures: Record<string, Record<string, Buffer>> = {};
  const folder = mkdtempSync(join(tmpdir(), 'cagecast-bench-'));
  process.on('exit', () => rmSync(folder, { recursive: true }));
  process.on('SIGINT', () => process.exit(130)); // which ends the method, too
  for (const files of models) {
    const model = await readModel(files).catch((error: Error) => void skipped.push(error.message));
    if (!model) {
      console.error(`skipped ${skipped.at(-1)}`);
      continue;
    }
    const { name, scene, labels } = model;
    const vertices = scene.target.positions.length / 3;
    writeArrays(folder, scene);
    const rows: Record<string, Row> = {};
    pictures[name] = {};
    const show = async (what: string, zones?: Uint8Array): Promise<void> => {
      try {
        pictures[name]![what] = await draw(scene.target, labels, zones);
      } catch (error) {
        console.error(`${name}: no picture of ${what}: ${(error as Error).message}`);
      }
    };
    await show(kTruth);
    for (const method of methods) {
      console.error(`${name}: ${method.name}`);
      const outcome = await run(method, folder, vertices, { runs, timeout, say });
      if ('failed' in outcome) {
        rows[method.name] = outcome;
        console.error(`${name}: ${method.name} failed: ${outcome.failed}`);
        continue;
      }
      const { zones, seconds, ...memory } = outcome;
      rows[method.name] = { ...score(scene.target, labels, zones), seconds: median(seconds), ...memory };
      await show(method.name, zones);
    }
    results.models[name] = { vertices, triangles: scene.target.indices.length / 3, methods: rows };
  }
  if (Object.keys(results.models).length === 0) throw new Error('no model was measured');
  const output = resolve(here, values.output ?? `${root}build/bench/public`);
  mkdirSync(output, { recursive: true });
  const summary = summaryOf(results);
  writeFileSync(`${output}/results.json`, `${JSON.stringify({ ...results, summary }, null, 1)}\n`);
  writeFileSync(`${output}/results.md`, markdown(results));
  writeFileSync(`${output}/results.html`, page(results, pictures));
  console.log(markdown(results));
  console.error(`${output}/results.html shows pictures; results.json and results.md are beside it`);
  if (Object.values(summary).some(({ failed }) => failed > 0)) process.exitCode = 1;
}

await main().catch((error: Error) => {
  console.error(error.message);
  process.exit(error instanceof Misuse ? 2 : 1);
});
