// Changes the core in one small place at a time and runs its tests: what none of them notices, a mistake there could be.
//
//   node tests/release/mutants/run.mjs [--sample N] [--seed N] [--part I/N] [--again] [--sanitize] [folder | file …]
//     --sample     how many mutants, 400 if not given, chosen by the seed
//     --part       every Nth of these, from the Ith: to share the work with other machines, whose verdicts are put together
//     --again      tries those once more that survived earlier, for after a test was added
//     --sanitize   tries those once more, the short tests only, with AddressSanitizer and UBSan
//     folder       of core/src, without its headers, or a file in it; default: steps search geometry seams cage
//
// Works on a copy in build/mutants. Verdicts are kept in build/mutants/verdicts.jsonl, and a run that is ended goes on there.
// Some survivors change nothing that a test could notice, such as a bound that only saves work: read each.

import { spawnSync } from 'node:child_process';
import { appendFileSync, existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { mutantsOf, mutated, shuffled } from './mutations.mjs';

const root = fileURLToPath(new URL('../../..', import.meta.url));
const work = join(root, 'build/mutants');
const tree = join(work, 'tree');
const verdictFile = join(work, 'verdicts.jsonl');
const kCopied = ['CMakeLists.txt', 'CMakePresets.json', 'core', 'tests/core'];
const kFolders = ['steps', 'search', 'geometry', 'seams', 'cage'];

/** The tests in the order they are tried: those of the same length at once, by processor seconds at most. */
const kStages = [
  { name: 'golden', most: 0, limit: 20 },
  { name: 'short', most: 0.25, limit: 60 },
  { name: 'medium', most: 2.5, limit: 200 },
  { name: 'long', most: Infinity, limit: 600 },
  // What reads or writes outside its memory shows here only, as in the suite `twins`.
  { name: 'sanitized', most: 0.25, limit: 300, build: 'sanitized' },
];

/** How the copy is compiled; the sanitized tests are those of the preset `dev`. */
const kBuilds = {
  plain: ['-O1', 'OFF'],
  sanitized: ['-O1 -g1', 'ON'],
};

function run(program, args, options = {}) {
  return spawnSync(program, args, { cwd: tree, encoding: 'utf8', maxBuffer: 2 ** 28, ...options });
}

function mustRun(program, args, options) {
  const { status, stdout, stderr, error } = run(program, args, options);
  if (status === 0) return stdout;
  console.error(`${program} ${args.join(' ')} failed\n${error ?? ''}${stdout}${stderr}`.slice(-4000));
  process.exit(1);
}

/** Writes a file if its content is new, so that compiled objects stay. */
function put(file, text) {
  if (existsSync(file) && readFileSync(file).equals(text)) return;
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, text);
}

function filesBelow(folder) {
  return readdirSync(folder, { withFileTypes: true, recursive: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath ?? entry.path, entry.name).slice(folder.length + 1));
}

/** Makes the copy equal to the sources, which also undoes the mutant of a run that was ended. */
function copySources() {
  const wanted = new Set();
  for (const name of kCopied) {
    const files = /\.\w+$/.test(name) ? [name] : filesBelow(join(root, name)).map((file) => join(name, file));
    for (const file of files) {
      wanted.add(file);
      put(join(tree, file), readFileSync(join(root, file)));
    }
  }
  for (const file of filesBelow(tree)) if (!wanted.has(file)) rmSync(join(tree, file));
}

const programOf = (build) => join(work, build, 'tests/core/cagecast_tests');
const compile = (build) => run('nice', ['-n', '19', 'ninja', '-C', join(work, build), 'cagecast_tests']);

function configure(build) {
  const [flags, sanitize] = kBuilds[build];
  mustRun('cmake', [
    ...['-S', tree, '-B', join(work, build), '-G', 'Ninja', '-Wno-dev', '--log-level=WARNING'],
    ...['-DCMAKE_BUILD_TYPE=Debug', `-DCMAKE_CXX_FLAGS_DEBUG=${flags}`, `-DCAGECAST_SANITIZE=${sanitize}`],
    // A mutant may well compare what is never negative with zero.
    ...['-DCMAKE_CXX_COMPILER=clang++', '-DCMAKE_CXX_FLAGS=-w -Wno-error -fuse-ld=lld', '-DCAGECAST_CAGES=OFF'],
  ]);
  const { status, stdout } = compile(build);
  if (status !== 0) {
    console.error(stdout.slice(-4000));
    process.exit(1);
  }
}

/** Runs tests to the first that fails. Without a limit of memory a mutant may take all there is. */
function runTests({ name, limit, build = 'plain' }, more = []) {
  const shell = `ulimit -t ${limit}; ${build === 'plain' ? 'ulimit -v 4000000; ' : ''}exec nice -n 19 "$0" "$@"`;
  const tests = name === 'golden' ? ['[golden]'] : ['-f', join(work, `${name}.txt`)];
  return run('sh', ['-c', shell, programOf(build), '--abort', ...tests, ...more]);
}

/** What chooses a test by its name. Even within quotes, a comma would end it. */
const filterOf = (test) => `"${test.replaceAll(',', '\\,')}"`;
const testNames = (filter = []) =>
  run(programOf('plain'), ['--list-test-names-only', ...filter])
    .stdout.split('\n')
    .filter(Boolean);

/** Whether it is known to which stage each test belongs. */
function areStagesWritten() {
  const files = kStages.slice(1).map(({ name }) => join(work, `${name}.txt`));
  if (!files.every((file) => existsSync(file))) return false;
  const known = new Set(files.flatMap((file) => readFileSync(file, 'utf8').split('\n')));
  return testNames().every((test) => known.has(filterOf(test)));
}

/** Runs all tests as they are, and notes which belong to which stage. */
function writeStages(stages) {
  const names = testNames();
  const output = mustRun(programOf('plain'), ['-d', 'yes']);
  const seconds = new Map([...output.matchAll(/^([\d.]+) s: (.*)$/gm)].map(([, time, name]) => [name, Number(time)]));
  let least = -1;
  for (const { name, most, build } of kStages) {
    const inStage = names.filter((test) => {
      const time = seconds.get(test) ?? 0;
      return time <= most && (build !== undefined || time > least);
    });
    const file = join(work, `${name}.txt`);
    writeFileSync(file, inStage.map((test) => `${filterOf(test)}\n`).join(''));
    if (inStage.length > 0 && testNames(['-f', file]).length !== inStage.length) {
      console.error(`${file} does not choose the tests that it names`);
      process.exit(1);
    }
    if (name !== 'golden') least = Math.max(least, most);
  }
  for (const stage of stages.filter(({ build }) => build !== undefined)) {
    const { status, stdout } = runTests(stage);
    if (status === 0) continue;
    console.error(`without a mutant, the tests of the stage "${stage.name}" fail\n${stdout.slice(-3000)}`);
    process.exit(1);
  }
}

/** Which test failed, of what Catch prints. */
function failedTest({ stdout, signal, status }) {
  const title = /-{79}\n(.+)\n(?:.*\n)*?-{79}\n\S+:\d+/.exec(stdout)?.[1];
  return title ?? (signal || status > 128 ? 'ended by a signal or a limit' : 'ended');
}

/** Tries one mutant by the tests of one stage. */
function verdictOf(text, mutant, stage) {
  const file = join(tree, 'core/src', mutant.file);
  writeFileSync(file, mutated(text, mutant));
  try {
    if (compile(stage.build ?? 'plain').status !== 0) return { verdict: 'invalid' };
    const result = runTests(stage);
    if (result.status !== 0) return { verdict: 'caught', stage: stage.name, by: failedTest(result) };
    return { verdict: stage === stages.at(-1) ? 'survived' : 'open', stage: stage.name };
  } finally {
    writeFileSync(file, text);
  }
}

const keyOf = ({ file, line, mutant }) => `${file}\t${line}\t${mutant}`;

function readVerdicts() {
  const lines = existsSync(verdictFile) ? readFileSync(verdictFile, 'utf8').split('\n').filter(Boolean) : [];
  return new Map(lines.map((line) => JSON.parse(line)).map((entry) => [keyOf(entry), entry]));
}

function chosenMutants(places, sample, seed) {
  // A mutant of a header compiles every file that includes it: only by name.
  const isChosen = (file) =>
    places.some((place) => file === place || (file.startsWith(`${place}/`) && file.endsWith('.cpp')));
  const files = filesBelow(join(root, 'core/src')).filter(isChosen).sort();
  const texts = new Map(files.map((file) => [file, readFileSync(join(root, 'core/src', file), 'utf8')]));
  const all = files.flatMap((file) => mutantsOf(file, texts.get(file)));
  // The same line twice in a file: one of them speaks for both.
  const different = [...new Map(all.map((mutant) => [keyOf(mutant), mutant])).values()];
  return { texts, mutants: shuffled(different, seed).slice(0, sample) };
}

/** Says what became of the mutants. @return Whether all were tried and caught. */
function report(mutants, verdicts) {
  const outcomes = { caught: [], survived: [], invalid: [], open: [] };
  for (const mutant of mutants) outcomes[verdicts.get(keyOf(mutant))?.verdict ?? 'open'].push(mutant);
  const { caught, survived, invalid, open } = outcomes;
  for (const { file, number, line, mutant } of survived) console.log(`${file}:${number}\n  - ${line}\n  + ${mutant}`);
  const share = (100 * caught.length) / (caught.length + survived.length);
  console.log(
    `${caught.length} caught, ${survived.length} survived (${share.toFixed(1)} % caught), ` +
      `${invalid.length} did not compile, ${open.length} not tried to the end`,
  );
  return survived.length === 0 && open.length === 0;
}

function readOptions() {
  const options = {
    sample: { type: 'string', default: '400' },
    seed: { type: 'string', default: '1' },
    part: { type: 'string', default: '1/1' },
    again: { type: 'boolean', default: false },
    sanitize: { type: 'boolean', default: false },
  };
  const { values, positionals } = parseArgs({ allowPositionals: true, options });
  const places = positionals.length > 0 ? positionals : kFolders;
  const sample = Number(values.sample);
  const [number, of] = values.part.split('/').map(Number);
  const unknown = places.find((place) => !existsSync(join(root, 'core/src', place)));
  if (unknown !== undefined || !(sample > 0) || !(number >= 1 && number <= of)) {
    console.error(
      unknown
        ? `no core/src/${unknown}`
        : 'usage: npm run mutants -- [--sample N] [--seed N] [--part I/N] [--again] [--sanitize] [folder …]',
    );
    process.exit(2);
  }
  return {
    places,
    sample,
    seed: Number(values.seed),
    part: { number, of },
    again: values.again,
    sanitize: values.sanitize,
  };
}

const { places, sample, seed, part, again, sanitize } = readOptions();
const stages = kStages.filter(({ build }) => (build !== undefined) === sanitize);
const { texts, mutants } = chosenMutants(places, sample, seed);
const verdicts = readVerdicts();
const verdictIn = (mutant) => verdicts.get(keyOf(mutant))?.verdict ?? 'open';
const isOpen = (mutant) => verdictIn(mutant) === 'open' || ((again || sanitize) && verdictIn(mutant) === 'survived');
// File by file: each change of the file costs that the one before is compiled again.
const open = mutants
  .filter((mutant, i) => i % part.of === part.number - 1 && isOpen(mutant))
  .sort((a, b) => (a.file === b.file ? a.start - b.start : a.file < b.file ? -1 : 1));
if (open.length > 0) {
  copySources();
  configure('plain');
  if (sanitize) configure('sanitized');
  if (!areStagesWritten()) writeStages(stages);
}
const tried = new Set();
// All by the quickest tests first: most are caught by these.
for (const stage of stages) {
  const passed = (mutant) => stages.findIndex(({ name }) => name === verdicts.get(keyOf(mutant))?.stage);
  const isTried = (mutant) => !again && !sanitize && passed(mutant) >= stages.indexOf(stage);
  const waiting = open.filter((mutant) => !tried.has(keyOf(mutant)) && !isTried(mutant));
  for (const [i, mutant] of waiting.entries()) {
    const { file, number, line, mutant: after } = mutant;
    const entry = { file, line, mutant: after, ...verdictOf(texts.get(file), mutant, stage) };
    if (entry.verdict !== 'open') tried.add(keyOf(mutant));
    verdicts.set(keyOf(mutant), entry);
    appendFileSync(verdictFile, `${JSON.stringify(entry)}\n`);
    console.log(`${stage.name} ${i + 1}/${waiting.length} ${entry.verdict}: ${file}:${number} ${after}`);
  }
}
process.exit(report(mutants, verdicts) ? 0 : 1);
