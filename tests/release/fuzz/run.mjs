// Builds the fuzz targets and runs each for some time; ends with how many inputs each took and what it found.
//
//   node tests/release/fuzz/run.mjs [--seconds N] [target …]        default: 60 seconds each, all targets
//
// Inputs that reach new code are kept in build/fuzz/corpus-TARGET, for the next run; those that break a promise in
// build/fuzz/found. Once it is mended, such an input belongs into tests/release/fuzz/corpus/TARGET, which `npm run test:all` replays.

import { spawnSync } from 'node:child_process';
import { mkdirSync, readdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const root = fileURLToPath(new URL('../../..', import.meta.url));
/** Seconds that one input may take, and its most bytes. */
const kTargets = {
  transfer: [10, 1200],
  classify: [10, 1200],
  split: [10, 1200],
  clip: [20, 1200],
  glb: [10, 4000],
  cages: [60, 1200],
  cage_steps: [20, 1200],
  landmarks: [20, 1200],
};

/** Little memory that waits to be used again, and short stacks of where it was allocated: a third less time for each input. */
const { ASAN_OPTIONS = 'quarantine_size_mb=8:malloc_context_size=4' } = process.env;

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { seconds: { type: 'string', default: '60' } },
});
const seconds = Number(values.seconds);
const targets = positionals.length > 0 ? positionals : Object.keys(kTargets);
const unknown = targets.find((target) => !(target in kTargets));
if (unknown !== undefined || !(seconds > 0)) {
  console.error(`usage: npm run fuzz -- [--seconds N] [${Object.keys(kTargets).join('|')} …]`);
  process.exit(2);
}

mustRun('cmake', ['--preset', 'fuzz', '-Wno-dev', '--log-level=WARNING']);
mustRun('cmake', ['--build', '--preset', 'fuzz', '--target', ...targets.map((target) => `cagecast_fuzz_${target}`)]);
const found = `${root}build/fuzz/found`;
mkdirSync(found, { recursive: true });
let failed = false;
for (const target of targets) {
  const [mostSeconds, mostBytes] = kTargets[target];
  const corpus = `${root}build/fuzz/corpus-${target}`;
  mkdirSync(corpus, { recursive: true });
  const { status, stderr } = spawnSync(
    `${root}build/fuzz/tests/release/fuzz/cagecast_fuzz_${target}`,
    [
      `-max_total_time=${seconds}`,
      `-timeout=${mostSeconds}`,
      `-max_len=${mostBytes}`,
      '-print_final_stats=1',
      '-entropic_scale_per_exec_time=1', // Quick inputs are varied more often.
      '-len_control=0', // Else inputs stay a few bytes long for minutes.
      `-artifact_prefix=${found}/${target}-`,
      corpus,
      `${root}tests/release/fuzz/corpus/${target}`,
    ],
    { encoding: 'utf8', maxBuffer: 2 ** 30, env: { ...process.env, ASAN_OPTIONS } },
  );
  const last = (pattern) => [...stderr.matchAll(pattern)].at(-1)?.[1] ?? '?';
  const runs = Number(last(/number_of_executed_units: (\d+)/g));
  console.log(
    `${target.padEnd(10)} ${runs.toLocaleString('en')} inputs, ${last(/cov: (\d+)/g)} edges, ${status === 0 ? 'nothing found' : 'FAILED'}`,
  );
  if (status === 0) continue;
  failed = true;
  console.log(stderr.split('\n').slice(-40).join('\n'));
}
if (failed) console.log(`inputs: ${readdirSync(found).join(', ')} in build/fuzz/found`);
process.exit(failed ? 1 : 0);

function mustRun(program, args) {
  const { status } = spawnSync(program, args, { cwd: root, stdio: 'inherit' });
  if (status !== 0) process.exit(1);
}
