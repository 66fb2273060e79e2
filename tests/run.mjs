// Builds everything and runs all tests; ends with how many of each suite passed, and what took how long.
//
//   node tests/run.mjs [suite …]        suites: lint, core, package, browser, lanes

import { spawn } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('..', import.meta.url));
const kMaxPerFile = 20 * 60_000; // milliseconds, until a file of tests counts as one that hangs
const kSuites = ['lint', 'core', 'package', 'browser', 'lanes'];

const phases = [];

/** Notes how long something takes. */
async function timed(name, work) {
  const began = Date.now();
  try {
    return await work();
  } finally {
    phases.push({ name, seconds: (Date.now() - began) / 1000 });
  }
}

/** Runs a command and shows its output, all at once where others run at the same time. */
function run(program, args, { env = {}, atOnce = false, timeout } = {}) {
  const title = `\n$ ${[program, ...args].join(' ')}\n`;
  if (!atOnce) process.stdout.write(title);
  return new Promise((resolve, reject) => {
    const child = spawn(program, args, {
      cwd: root,
      env: { ...process.env, ...env },
      stdio: ['ignore', 'pipe', 'pipe'],
      timeout,
      killSignal: 'SIGKILL',
    });
    let output = '';
    for (const stream of [child.stdout, child.stderr]) {
      stream.setEncoding('utf8').on('data', (text) => {
        output += text;
        if (!atOnce) process.stdout.write(text);
      });
    }
    child.on('error', reject);
    child.on('close', (status) => {
      if (atOnce) process.stdout.write(title + output);
      resolve({ status, output });
    });
  });
}

async function mustRun(program, args, options) {
  const { status } = await run(program, args, options);
  if (status !== 0) throw new Error(`${program} ${args.join(' ')} failed (exit ${status})`);
}

const matches = (text, pattern) => text.match(pattern)?.length ?? 0;

async function lint() {
  const { status, output } = await run(process.execPath, ['wasm/tools/lint/run.mjs']);
  const failed = matches(output, /^lint \w+ +FAILED/gm) || Number(status !== 0);
  return { passed: matches(output, /^lint \w+ +ok/gm), failed };
}

/** The core with all its tests, or only what the package's tests need: the reference, and what counts instructions. */
async function buildNative(withTests) {
  const only = ['--target', 'cagecast_reference', 'cagecast_bench', 'cagecast_count_instructions'];
  await mustRun('cmake', ['--preset', 'release', '-Wno-dev', '--log-level=WARNING'], { atOnce: true });
  const jobs = ['--parallel', String(availableParallelism())];
  await mustRun('cmake', ['--build', '--preset', 'release', ...jobs, ...(withTests ? [] : only)], { atOnce: true });
}

/** The package, its twin without SIMD that tests compare it with, and the sample models. */
async function buildPackage() {
  // The native build runs at the same time, with a compiler for each core: each one more makes all of them slower.
  const jobs = String(Math.max(1, Math.floor(availableParallelism() / 2)));
  const options = { env: { CMAKE_BUILD_PARALLEL_LEVEL: jobs }, atOnce: true };
  await mustRun('npm', ['run', '--silent', 'assets'], options);
  await mustRun('npm', ['run', '--silent', 'build'], options);
  await mustRun(process.execPath, ['wasm/tools/build.mjs', '--preset', 'wasm-scalar'], options);
}

async function testCore() {
  const { status, output } = await run('ctest', ['--preset', 'release', '--progress', `-j${availableParallelism()}`]);
  const [failed, all] = /(\d+) tests failed out of (\d+)/.exec(output)?.slice(1) ?? [1, 1];
  return { passed: all - failed, failed: Number(failed) || Number(status !== 0) };
}

/** Whether all builds give the same answers, as a table. */
async function compareLanes() {
  const { status, output } = await run(process.execPath, ['--import', 'tsx', 'tests/lanes/run.mjs', '--built']);
  const [equal, others] = /equal hashes: (\d+), with others: (\d+)/.exec(output)?.slice(1) ?? [0, 1];
  return { passed: Number(equal), failed: Number(others) || Number(status !== 0) };
}

/** Builds the page and serves it; what tests find it by. */
async function servePage() {
  const { build, preview } = await import('vite');
  const page = fileURLToPath(new URL('../build/web', import.meta.url));
  const options = {
    configFile: fileURLToPath(new URL('../web/vite.config.ts', import.meta.url)),
    logLevel: 'error',
    build: { outDir: page },
  };
  await build(options);
  const server = await preview({ ...options, preview: { host: '127.0.0.1', port: 0 } });
  return { close: () => server.close(), env: { CAGECAST_SITE: server.resolvedUrls.local[0], CAGECAST_PAGE: page } };
}

const times = fileURLToPath(new URL('../build/test-times.json', import.meta.url));

/** The files of some folders, the longest first: as they were the last time, or by their size. */
function testFiles(folders) {
  const last = existsSync(times) ? JSON.parse(readFileSync(times, 'utf8')) : {};
  const length = (file) => last[file] ?? statSync(`${root}${file}`).size / 1000;
  return folders
    .flatMap((folder) => readdirSync(root + folder).map((name) => `${folder}/${name}`))
    .filter((file) => file.endsWith('.test.ts'))
    .sort((a, b) => length(b) - length(a));
}

/**
 * Runs test files, as many at once as there are cores. On two cores two browsers that draw by the processor take 0.77 of the time
 * of one after the other.
 * @return What passed, by folder.
 */
async function testFolders(folders, env) {
  const waiting = testFiles(folders);
  const counts = Object.fromEntries(folders.map((folder) => [folder, { passed: 0, failed: 0, skipped: 0 }]));
  const durations = {};
  const work = async () => {
    for (let file = waiting.shift(); file; file = waiting.shift()) {
      const began = Date.now();
      const args = ['--import', 'tsx', '--test-reporter=spec', '--test-reporter-destination=stdout', file];
      const { status, output } = await run(process.execPath, args, { env, atOnce: true, timeout: kMaxPerFile });
      durations[file] = (Date.now() - began) / 1000;
      const count = (word) => Number(new RegExp(`^ℹ ${word} (\\d+)`, 'm').exec(output)?.[1] ?? 0);
      const all = counts[folders.find((folder) => file.startsWith(`${folder}/`))];
      all.passed += count('pass');
      all.failed += count('fail') + count('cancelled') || Number(status !== 0 || count('tests') === 0);
      all.skipped += count('skipped');
    }
  };
  await Promise.all(Array.from({ length: availableParallelism() }, work));
  mkdirSync(`${root}build`, { recursive: true });
  const last = existsSync(times) ? JSON.parse(readFileSync(times, 'utf8')) : {};
  writeFileSync(times, JSON.stringify({ ...last, ...durations }, null, 1));
  return counts;
}

/** Runs the tests that are written in TypeScript: those of all suites at once, as some leave a core idle. */
async function testScripts(names) {
  const folders = {
    package: [
      ...['tests/js', 'tests/bake', 'tests/properties', 'tests/mutants', 'tests/command', 'tests/package'],
      ...['tests/three', 'tests/hosts', 'tests/catalogue'],
    ],
    browser: ['tests/browser', 'tests/page', 'tests/web'],
  };
  const page = names.includes('browser') ? await timed('build the page', servePage) : undefined;
  const env = {
    ...page?.env,
    CAGECAST_SCALAR: 'build/wasm-scalar/package',
    CAGECAST_REFERENCE: 'build/release/tests/core/cagecast_reference',
  };
  try {
    const all = names.flatMap((name) => folders[name]);
    const counts = await timed('test scripts', () => testFolders(all, env));
    const sum = (name, field) => folders[name].reduce((total, folder) => total + counts[folder][field], 0);
    return names.map((name) => ({
      name,
      passed: sum(name, 'passed'),
      failed: sum(name, 'failed'),
      skipped: sum(name, 'skipped'),
    }));
  } finally {
    await page?.close();
  }
}

const rows = [];

/** Adds what some work came to; where it throws, its suites have failed. */
async function add(names, work) {
  try {
    const found = await work();
    rows.push(...(Array.isArray(found) ? found : [{ name: names[0], ...found }]));
  } catch (error) {
    console.error(error.message);
    rows.push(...names.map((name) => ({ name, passed: 0, failed: 1 })));
  }
}

const chosen = process.argv.length > 2 ? process.argv.slice(2) : kSuites;
const unknown = chosen.find((name) => !kSuites.includes(name));
if (unknown) {
  console.error(`no suite "${unknown}"; there are: ${kSuites.join(', ')}`);
  process.exit(2);
}
const scripts = chosen.filter((name) => name === 'package' || name === 'browser');
const isNative = chosen.includes('core') || chosen.includes('lanes');
if (chosen.includes('lint')) await add(['lint'], () => timed('lint', lint));
// The builds take turns at being held up by a single process, so they run at the same time.
const native = timed('build native', () => (isNative || scripts.includes('package') ? buildNative(isNative) : 0));
const wasm = timed('build package', () => (scripts.length > 0 || chosen.includes('lanes') ? buildPackage() : 0));
const built = await Promise.allSettled([native, wasm]);
if (chosen.includes('core')) await add(['core'], () => native.then(() => timed('test core', testCore)));
if (chosen.includes('lanes'))
  await add(['lanes'], () => Promise.all([native, wasm]).then(() => timed('lanes', compareLanes)));
if (scripts.length > 0) {
  await add(scripts, () => {
    for (const { reason } of built) if (reason) throw reason;
    return testScripts(scripts);
  });
}

console.log('');
for (const { name, seconds } of phases) if (seconds >= 1) console.log(`${seconds.toFixed(0).padStart(5)} s  ${name}`);
console.log('');
// A suite that ran nothing has not passed.
for (const row of rows) if (row.passed === 0 && row.failed === 0) row.failed = 1;
for (const { name, passed, failed, skipped = 0 } of rows)
  console.log(`${name.padEnd(8)} ${passed} passed, ${failed} failed, ${skipped} skipped`);
const sum = (field) => rows.reduce((total, row) => total + (row[field] ?? 0), 0);
console.log(`\nall: ${sum('passed')} passed, ${sum('failed')} failed, ${sum('skipped')} skipped`);
process.exit(sum('failed') === 0 ? 0 : 1);
