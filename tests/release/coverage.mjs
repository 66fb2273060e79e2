// Builds the core's tests with Clang's counters, runs them, and prints which share of the core they run.
//
//   node tests/release/coverage.mjs [--lines]        with --lines: also the lines that no test runs

import { spawnSync } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../..', import.meta.url));
const folder = `${root}build/coverage`;
const program = `${folder}/tests/core/cagecast_tests`;

function run(command, args, options = {}) {
  const { status, stdout, error } = spawnSync(command, args, {
    cwd: root,
    stdio: ['ignore', 'pipe', 'inherit'],
    encoding: 'utf8',
    maxBuffer: 2 ** 30,
    ...options,
  });
  if (error || status !== 0) {
    console.error(`${command} failed: ${error?.message ?? `exit ${status}`}\n${stdout?.slice(-2000) ?? ''}`);
    process.exit(1);
  }
  return stdout;
}

/** A tool of LLVM, which Debian names with its version. */
function toolOf(name) {
  const found = (process.env.PATH ?? '')
    .split(':')
    .flatMap((path) => {
      try {
        return readdirSync(path);
      } catch {
        return [];
      }
    })
    .filter((file) => file === name || new RegExp(`^${name}-\\d+$`).test(file));
  // That of the compiler: data of one version cannot be read by another.
  const version = /version (\d+)/.exec(run('clang++', ['--version']))?.[1];
  return found.find((file) => file === `${name}-${version}`) ?? found[0] ?? name;
}

run('cmake', ['--preset', 'coverage', '-Wno-dev', '--log-level=WARNING']);
run('cmake', ['--build', '--preset', 'coverage', '--target', 'cagecast_tests']);
run(program, [], { env: { ...process.env, LLVM_PROFILE_FILE: `${folder}/tests.profraw` } });
run(toolOf('llvm-profdata'), ['merge', '-sparse', `${folder}/tests.profraw`, '-o', `${folder}/tests.profdata`]);
const sources = ['core/src', 'core/include'].map((path) => `${root}${path}`);
const data = [program, `-instr-profile=${folder}/tests.profdata`, ...sources];
const { data: found } = JSON.parse(run(toolOf('llvm-cov'), ['export', '-summary-only', ...data]));
const percent = ({ percent }) => `${percent.toFixed(1)} %`;
const rows = found[0].files
  .map(({ filename, summary }) => ({ name: filename.slice(root.length), summary }))
  .sort((a, b) => a.summary.branches.percent - b.summary.branches.percent);
for (const { name, summary } of [...rows, { name: 'all', summary: found[0].totals }])
  console.log(
    `${percent(summary.lines).padStart(8)} of lines ${percent(summary.branches).padStart(8)} of branches  ${name}`,
  );
if (process.argv.includes('--lines')) {
  const shown = run(toolOf('llvm-cov'), ['show', '-show-line-counts', '-use-color=false', ...data]);
  for (const line of shown.split('\n')) if (/^\S+:$/.test(line) || /^ *\d+\| +0\|/.test(line)) console.log(line);
}
