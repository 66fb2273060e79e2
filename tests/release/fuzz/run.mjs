// Looks for inputs that break a promise: builds the fuzz targets, runs each for some time, and ends with a table of what they tried
// and found.
//
//   npm run fuzz -- [options] [target …]       all targets, or these; or files of `formats`, such as text.fbx
//     --list         what there is
//     --seconds N    of the processor for each target; 60 if not given. What else the machine does changes nothing but how long it takes
//     --seed N       of `formats`; 1 if not given. The same seed gives the same files
//     --files N      at most as many versions of each file of `formats`
//
// Inputs that break a promise are in build/fuzz/found. Once it is mended, such an input belongs into
// tests/release/fuzz/corpus/TARGET, which tests replay. Inputs that reach new code are kept in build/fuzz/corpus-TARGET, for the next
// run. To repeat one: build/fuzz/tests/release/fuzz/cagecast_fuzz_TARGET FILE.

import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { mkdirSync, readdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { fuzzFormats } from './formats/run.ts';
import { samples } from './formats/samples.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));
const found = `${root}build/fuzz/found`;
/** The subject of each target; seconds for one input, on a busy machine; its most bytes. */
const kTargets = {
  transfer: ['any scene, options and masks, against the reference: regions, motion', 60, 1200],
  classify: ['any projection that is consistent in itself', 60, 1200],
  split: ['any UVs of corners', 60, 1200],
  clip: ['borders of any scene, options and masks', 120, 1200],
  glb: ['any bytes, by the native reader of glTF', 60, 4000],
  cages: ['cages that are made, fitted and refined for any model', 300, 1200],
  cage_steps: ['their steps, each by itself, on any mesh', 120, 1200],
  landmarks: ['landmarks of any model', 300, 1200],
};
const kFormats = 'formats';

/** Little memory that waits to be used again, and short stacks of where it was allocated: a third less time for each input. */
const { ASAN_OPTIONS = 'quarantine_size_mb=8:malloc_context_size=4' } = process.env;

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    list: { type: 'boolean', default: false },
    seconds: { type: 'string', default: '60' },
    seed: { type: 'string', default: '1' },
    files: { type: 'string', default: 'Infinity' },
  },
});
const [seconds, seed, files] = [values.seconds, values.seed, values.files].map(Number);
const isKnown = (name) => name in kTargets || name in samples || name === kFormats;
const unknown = positionals.find((name) => !isKnown(name));
if (unknown !== undefined || !(seconds > 0 && files > 0 && Number.isInteger(seed))) {
  console.error('usage: npm run fuzz -- [--list] [--seconds N] [--seed N] [--files N] [target …]');
  if (unknown !== undefined) console.error(`${unknown} is no target; --list shows all`);
  process.exit(2);
}
if (values.list) {
  for (const [name, [text]] of Object.entries(kTargets)) console.log(`${name.padEnd(11)} ${text}`);
  console.log(`${kFormats.padEnd(11)} any version of: ${Object.keys(samples).join(', ')}`);
  process.exit(0);
}

const isAll = positionals.length === 0;
const targets = Object.keys(kTargets).filter((name) => isAll || positionals.includes(name));
const formats = positionals.filter((name) => name in samples);
const hasFormats = isAll || formats.length > 0 || positionals.includes(kFormats);
mkdirSync(found, { recursive: true });
if (targets.length > 0) {
  mustRun('cmake', ['--preset', 'fuzz', '-Wno-dev', '--log-level=WARNING']);
  mustRun('cmake', ['--build', '--preset', 'fuzz', '--target', ...targets.map((name) => `cagecast_fuzz_${name}`)]);
}
if (hasFormats) mustRun(process.execPath, ['wasm/tools/build.mjs']);

/** The rows of the table. */
const rows = [];
let isFound = false;
for (const target of targets) {
  console.log(`${target} …`);
  const { status, seconds: spent, output } = await fuzz(target);
  const last = (pattern) => Number([...output.matchAll(pattern)].at(-1)?.[1] ?? 0).toLocaleString('en');
  rows.push({
    target,
    inputs: last(/number_of_executed_units: (\d+)/g),
    'CPU s': Math.round(spent),
    reached: `${last(/cov: (\d+)/g)} edges`,
    slowest: `${last(/slowest_unit_time_sec: (\d+)/g)} s`,
    found: status === 0 ? 'nothing' : `FAILED: ${/^SUMMARY: (.*)$/m.exec(output)?.[1] ?? `exit ${status}`}`,
  });
  if (status === 0) continue;
  isFound = true;
  console.log(output.split('\n').slice(-40).join('\n'));
}
if (hasFormats) {
  console.log(`${kFormats} …`);
  for (const row of await fuzzFormats(positionals.includes(kFormats) ? [] : formats, { seconds, files, seed, found })) {
    const [milliseconds, megabytes] = row.worst.map(Math.round);
    rows.push({
      target: row.name,
      inputs: row.inputs.toLocaleString('en'),
      'CPU s': Math.round(row.seconds),
      reached: `${Math.round((100 * row.read) / Math.max(1, row.inputs))} % read`,
      slowest: `${milliseconds} ms, ${megabytes} MB`,
      found: row.faults.length === 0 ? 'nothing' : `FAILED: ${row.faults.length} kinds`,
    });
    isFound ||= row.faults.length > 0;
  }
}
printTable(rows);
if (isFound) console.log(`in build/fuzz/found: ${readdirSync(found).join(', ')}`);
process.exit(isFound ? 1 : 0);

/** Runs a target until it has had its seconds of the processor. */
async function fuzz(target) {
  const [, mostSeconds, mostBytes] = kTargets[target];
  const corpus = `${root}build/fuzz/corpus-${target}`;
  mkdirSync(corpus, { recursive: true });
  const child = spawn(
    `${root}build/fuzz/tests/release/fuzz/cagecast_fuzz_${target}`,
    [
      `-timeout=${mostSeconds}`,
      `-report_slow_units=${mostSeconds}`, // Else it keeps what took ten seconds beside other programs.
      `-max_len=${mostBytes}`,
      '-print_final_stats=1',
      '-entropic_scale_per_exec_time=1', // Quick inputs are varied more often.
      '-len_control=0', // Else inputs stay a few bytes long for minutes.
      `-artifact_prefix=${found}/${target}-`,
      corpus,
      `${root}tests/release/fuzz/corpus/${target}`,
    ],
    { stdio: ['ignore', 'ignore', 'pipe'], env: { ...process.env, ASAN_OPTIONS } },
  );
  let [output, spent] = ['', 0];
  child.stderr.setEncoding('utf8').on('data', (text) => (output += text));
  const timer = setInterval(() => {
    spent = secondsOf(child.pid) ?? spent;
    if (spent >= seconds) child.kill('SIGUSR1'); // It ends after the input that it has, with its figures.
  }, 500);
  const status = await new Promise((resolve) => child.on('close', (code, signal) => resolve(code ?? signal)));
  clearInterval(timer);
  return { status, seconds: spent, output };
}

/** Of the processor, that a process has had; nothing if it has ended. */
function secondsOf(pid) {
  try {
    const [, days = 0, hours = 0, minutes, rest] = /^(?:(?:(\d+)-)?(\d+):)?(\d+):([\d.]+)$/.exec(
      execFileSync('ps', ['-o', 'time=', '-p', pid], { encoding: 'utf8' }).trim(),
    );
    return 60 * (60 * (24 * Number(days) + Number(hours)) + Number(minutes)) + Number(rest);
  } catch {
    return undefined;
  }
}

function printTable(rows) {
  const names = Object.keys(rows[0]);
  const widths = names.map((name) => Math.max(name.length, ...rows.map((row) => String(row[name]).length)));
  const line = (cells) =>
    cells
      .map((cell, i) => String(cell).padEnd(widths[i]))
      .join('  ')
      .trimEnd();
  console.log(`\n${[names, ...rows.map(Object.values)].map(line).join('\n')}`);
}

function mustRun(program, args) {
  const { status } = spawnSync(program, args, { cwd: root, stdio: 'inherit' });
  if (status !== 0) process.exit(1);
}
