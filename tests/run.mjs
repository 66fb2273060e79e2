// Builds what tests need and runs them. Ends with how many of each suite passed, and what took how long.
//
//   npm test [-- options]        the suites lint, core, package and page
//   npm run test:all             those, and all others
//
//   SUITE …                      only these, by name; the table below has them
//   --others                     only those beyond npm test
//   --changed                    only those of the folders with changes that are not committed
//   --record                     notes the files on which the longest suites passed; commit the record
//   --unless-recorded            without suites whose record is of the files as they are

import { spawn, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { join } from 'node:path';
import { run as runTests } from 'node:test';
import { spec } from 'node:test/reporters';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const root = fileURLToPath(new URL('..', import.meta.url));
// Files of tests are TypeScript; the processes that run them get the options of this one.
if (!process.execArgv.includes('tsx')) process.execArgv.push('--import', 'tsx');
/** Milliseconds until a file of tests counts as one that hangs. */
const kMaxPerFile = 20 * 60_000;

/**
 * The suites. `always`: `npm test` runs it. `setup`: its purpose in setup.mjs, by default `test`. `needs`: the builds it uses. `of`: the folders whose changes ask for it. `tests`: a folder of tests for Node; else `run` returns how many passed and failed.
 * `record`: where it is noted on which files of which `folders` the suite has passed.
 */
const kSuites = {
  lint: {
    always: true,
    setup: 'lint',
    needs: [],
    of: [''],
    run: () => lint(['arrows', 'limits', 'patterns', 'pins', 'scale', 'generated', 'docs', 'format', 'biome']),
  },
  core: { always: true, needs: ['native'], of: ['core', 'tests/core'], run: () => ctest('release') },
  package: {
    always: true,
    needs: ['native', 'wasm'],
    of: ['core', 'wasm', 'tests/package', 'tests/support'],
    tests: 'tests/package',
  },
  page: {
    always: true,
    needs: ['wasm', 'site'],
    of: ['wasm', 'web', 'tests/page', 'tests/support'],
    tests: 'tests/page',
  },
  tidy: { setup: 'tidy', needs: [], of: ['core', 'wasm'], run: () => lint(['tidy']) },
  docs: { setup: 'docs', needs: ['wasm'], of: ['core/include', 'wasm', 'docs'], run: makeDocs },
  twins: { needs: ['twins'], of: ['core', 'tests/core'], run: () => ctest('twins') },
  lanes: { needs: ['twins', 'scalar'], of: ['core', 'tests/release/lanes'], run: compareLanes },
  budgets: { setup: 'budgets', needs: ['bench', 'wasm'], of: ['core', 'wasm', 'web'], tests: 'tests/release/budgets' },
  hosts: {
    setup: 'hosts',
    needs: ['wasm'],
    of: ['wasm', 'examples', 'tests/release/hosts'],
    tests: 'tests/release/hosts',
  },
  cages: { needs: ['wasm'], of: ['core', 'wasm', 'tests/release/cages'], tests: 'tests/release/cages' },
  quality: {
    setup: 'quality',
    needs: ['wasm'],
    of: ['core', 'wasm', 'bench', 'tests/release/quality'],
    tests: 'tests/release/quality',
  },
  catalogue: { setup: 'catalogue', needs: ['wasm'], of: ['wasm', 'examples'], tests: 'tests/release/catalogue' },
  visits: {
    needs: ['wasm', 'site'],
    of: ['wasm', 'web', 'tests/release/page'],
    tests: 'tests/release/page',
    record: 'tests/release/page/passed.json',
    folders: ['web', 'wasm/src/three', 'tests/release/page', 'tests/support'],
  },
};

/** What suites need, and how it is built. Different ones are built at the same time. */
const kBuilds = {
  native: () => cmake('release'),
  bench: async () => {
    await built('native'); // in the same folder
    await cmake('release', '--target', 'cagecast_bench', 'cagecast_count_instructions');
  },
  twins: () => cmake('twins'),
  wasm: () => mustRun(process.execPath, ['wasm/tools/build.mjs']),
  scalar: () => mustRun(process.execPath, ['wasm/tools/build.mjs', '--preset', 'wasm-scalar']),
  site: async () => {
    await built('wasm');
    await buildSite();
  },
};

const phases = [];

/** Notes how long something takes. */
async function timed(name, work) {
  const began = Date.now();
  console.log(`${name} …`);
  try {
    return await work();
  } finally {
    phases.push({ name, seconds: (Date.now() - began) / 1000 });
  }
}

/** Runs a command. What it prints is shown when it has ended, as others may run at the same time. */
function run(program, args) {
  return new Promise((resolve, reject) => {
    const child = spawn(program, args, { cwd: root, stdio: ['ignore', 'pipe', 'pipe'] });
    let output = '';
    for (const stream of [child.stdout, child.stderr])
      stream.setEncoding('utf8').on('data', (text) => (output += text));
    child.on('error', reject);
    child.on('close', (status) => {
      process.stdout.write(`\n$ ${[program, ...args].join(' ')}\n${output}`);
      resolve({ status, output });
    });
  });
}

async function mustRun(program, args) {
  const { status } = await run(program, args);
  if (status !== 0) throw new Error(`${program} ${args.join(' ')} failed (exit ${status})`);
}

const builds = {};
/** Builds something that suites need, once. */
const built = (name) => (builds[name] ??= timed(`build ${name}`, kBuilds[name]));

async function cmake(preset, ...targets) {
  await mustRun('cmake', ['--preset', preset, '-Wno-dev', '--log-level=WARNING']);
  await mustRun('cmake', ['--build', '--preset', preset, ...targets]);
}

/** Builds the page and serves it; tests find it by the environment. */
async function buildSite() {
  const { build, preview } = await import('vite');
  const outDir = join(root, 'build/web');
  const options = { configFile: join(root, 'web/vite.config.ts'), logLevel: 'error', build: { outDir } };
  await build(options);
  const server = await preview({ ...options, preview: { host: '127.0.0.1', port: 0 } });
  process.env.CAGECAST_SITE = server.resolvedUrls.local[0];
  process.env.CAGECAST_PAGE = outDir;
  // One browser for all files of tests: it ends with this process.
  const { tsImport } = await import('tsx/esm/api');
  const { serveChromium } = await tsImport('./support/chromium.ts', import.meta.url);
  process.env.CAGECAST_BROWSER = (await serveChromium()).wsEndpoint();
}

const matches = (text, pattern) => text.match(pattern)?.length ?? 0;

async function lint(steps) {
  const { status, output } = await run(process.execPath, ['wasm/tools/lint/run.mjs', ...steps]);
  const failed = matches(output, /^lint \w+ +FAILED/gm) || Number(status !== 0);
  return { passed: matches(output, /^lint \w+ +ok/gm), failed };
}

async function makeDocs() {
  const { status } = await run('npm', ['run', '--silent', 'docs']);
  return { passed: Number(status === 0), failed: Number(status !== 0) };
}

async function ctest(preset) {
  const { status, output } = await run('ctest', ['--preset', preset, `-j${availableParallelism()}`, '--progress']);
  const [failed, all] = /(\d+) tests failed out of (\d+)/.exec(output)?.slice(1) ?? [1, 1];
  return { passed: all - failed, failed: Number(failed) || Number(status !== 0) };
}

/** Whether all builds give the same answers, as a table. */
async function compareLanes() {
  const { status, output } = await run(process.execPath, ['--import', 'tsx', 'tests/release/lanes/run.mjs', '--built']);
  const [equal, others] = /equal hashes: (\d+), with others: (\d+)/.exec(output)?.slice(1) ?? [0, 1];
  return { passed: Number(equal), failed: Number(others) || Number(status !== 0) };
}

/** Runs the files of tests in some folders, as many at once as there are cores, the largest first. @return Counts by folder. */
async function testFolders(folders) {
  const files = folders
    .flatMap((folder) => readdirSync(join(root, folder), { recursive: true }).map((name) => join(root, folder, name)))
    .filter((file) => file.endsWith('.test.ts') && !file.includes('node_modules'))
    .sort((a, b) => statSync(b).size - statSync(a).size);
  const counts = Object.fromEntries(folders.map((folder) => [folder, { passed: 0, failed: 0, skipped: 0 }]));
  const count = (outcome) => (test) => {
    if (test.details.type === 'suite') return;
    // A test may come from a file that a file of another folder imports.
    const of = counts[folders.find((folder) => test.file.startsWith(join(root, folder, '/'))) ?? folders[0]];
    // A file that passes as a whole has no test in it.
    ++of[test.name === test.file ? 'failed' : test.skip !== undefined ? 'skipped' : outcome];
  };
  const tests = runTests({ files, concurrency: availableParallelism(), timeout: kMaxPerFile });
  tests.on('test:pass', count('passed')).on('test:fail', count('failed'));
  await new Promise((resolve) => tests.compose(new spec()).on('end', resolve).pipe(process.stdout, { end: false }));
  return counts;
}

/** A hash of the files of some folders that git knows or would add, but for the record itself. */
function hashOf({ folders, record }) {
  const list = spawnSync('git', ['ls-files', '--cached', '--others', '--exclude-standard', '--', ...folders], {
    cwd: root,
    encoding: 'utf8',
  });
  const hash = createHash('sha256');
  for (const name of [...new Set(list.stdout.split('\n'))].sort())
    if (name !== '' && name !== record && existsSync(join(root, name)))
      hash.update(`${name}\0`).update(readFileSync(join(root, name)));
  return hash.digest('hex');
}

/** Whether a suite has passed on the files that are here. */
function isRecorded(suite) {
  if (suite.record === undefined || !existsSync(join(root, suite.record))) return false;
  return JSON.parse(readFileSync(join(root, suite.record), 'utf8')).files === hashOf(suite);
}

/** What the command line asks for. */
function readArguments() {
  const flag = { type: 'boolean' };
  const options = { all: flag, others: flag, changed: flag, record: flag, 'unless-recorded': flag };
  const { values, positionals } = parseArgs({ options, allowPositionals: true });
  const unknown = positionals.find((name) => !(name in kSuites));
  if (unknown) {
    console.error(`no suite "${unknown}"; there are: ${Object.keys(kSuites).join(', ')}`);
    process.exit(2);
  }
  return { values, positionals };
}

/** The suites that the arguments ask for. */
function chosenSuites({ values, positionals }) {
  const names = Object.keys(kSuites);
  if (positionals.length > 0) return names.filter((name) => positionals.includes(name));
  let suites = names.filter((name) => values.all || Boolean(kSuites[name].always) !== Boolean(values.others));
  if (values['unless-recorded']) {
    const recorded = suites.filter((name) => isRecorded(kSuites[name]));
    for (const name of recorded)
      console.log(`${name}: left out, as ${kSuites[name].record} says that it passed on just these files`);
    suites = suites.filter((name) => !recorded.includes(name));
  }
  if (!values.changed) return suites;
  const { stdout } = spawnSync('git', ['status', '--porcelain', '--untracked-files=all'], {
    cwd: root,
    encoding: 'utf8',
  });
  const changed = stdout
    .split('\n')
    .flatMap((line) => line.slice(3).split(' -> '))
    .filter(Boolean);
  return suites.filter((name) => kSuites[name].of.some((folder) => changed.some((file) => file.startsWith(folder))));
}

const given = readArguments();
const chosen = chosenSuites(given);
const rows = [];
const setup = new Set(chosen.map((name) => kSuites[name].setup ?? 'test'));
if (
  setup.size > 0 &&
  spawnSync(process.execPath, ['wasm/tools/setup.mjs', ...setup], { cwd: root, stdio: 'inherit' }).status !== 0
)
  process.exit(1);

/** Adds what some work came to; where it throws, its suites have failed. */
async function add(names, work) {
  try {
    rows.push(...(await work()));
  } catch (error) {
    console.error(error.message);
    rows.push(...names.map((name) => ({ name, passed: 0, failed: 1 })));
  }
}

const isScript = (name) => kSuites[name].tests !== undefined;
const ready = (names) => Promise.all(names.flatMap((name) => kSuites[name].needs).map(built));
// Different builds take turns at being held up by a single process, so they run at the same time, each with its share of the cores.
const count = new Set(chosen.flatMap((name) => kSuites[name].needs)).size;
process.env.CMAKE_BUILD_PARALLEL_LEVEL ??= String(
  Math.max(1, Math.floor(availableParallelism() / (count > 1 ? 2 : 1))),
);
const scripts = chosen.filter(isScript);
const others = chosen.filter((name) => !isScript(name));
if (others.some((name) => kSuites[name].needs.includes('native'))) built('native').catch(() => {});
await Promise.all([
  add(scripts, async () => {
    if (scripts.length === 0) return [];
    await ready(scripts);
    process.env.CAGECAST_REFERENCE = 'build/release/tests/core/cagecast_reference';
    const folders = scripts.map((name) => kSuites[name].tests);
    const counts = await timed(`test ${scripts.join(', ')}`, () => testFolders(folders));
    return scripts.map((name, i) => ({ name, ...counts[folders[i]] }));
  }),
  (async () => {
    for (const name of others) {
      await add([name], async () => {
        await ready([name]);
        return [{ name, ...(await timed(`test ${name}`, kSuites[name].run)) }];
      });
    }
  })(),
]);

console.log('');
for (const { name, seconds } of phases) if (seconds >= 1) console.log(`${seconds.toFixed(0).padStart(5)} s  ${name}`);
console.log('');
// A suite that ran nothing has not passed.
for (const row of rows) if (row.passed === 0 && row.failed === 0) row.failed = 1;
rows.sort((a, b) => chosen.indexOf(a.name) - chosen.indexOf(b.name));
for (const { name, passed, failed, skipped = 0 } of rows) {
  const suite = kSuites[name];
  if (given.values.record && failed === 0 && suite.record !== undefined)
    writeFileSync(join(root, suite.record), `${JSON.stringify({ files: hashOf(suite) })}\n`);
  console.log(`${name.padEnd(9)} ${passed} passed, ${failed} failed, ${skipped} skipped`);
}
const sum = (field) => rows.reduce((total, row) => total + (row[field] ?? 0), 0);
console.log(`\nall: ${sum('passed')} passed, ${sum('failed')} failed, ${sum('skipped')} skipped`);
process.exit(sum('failed') === 0 ? 0 : 1);
