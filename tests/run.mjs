// Builds everything and runs all tests; ends with how many of each suite passed.
//
//   node tests/run.mjs [suite …]        suites: lint, core, package, browser

import { spawn } from 'node:child_process';
import { readdirSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('..', import.meta.url));

/** Runs a command, shows its output, and returns it. */
function run(program, args, env = {}) {
  console.log(`\n$ ${[program, ...args].join(' ')}`);
  return new Promise((resolve, reject) => {
    const child = spawn(program, args, {
      cwd: root,
      env: { ...process.env, ...env },
      stdio: ['ignore', 'pipe', 'inherit'],
    });
    let output = '';
    child.stdout.on('data', (data) => {
      output += data;
      process.stdout.write(data);
    });
    child.on('error', reject);
    child.on('close', (status) => resolve({ status, output }));
  });
}

async function mustRun(...args) {
  const { status } = await run(...args);
  if (status !== 0) throw new Error(`${args[0]} ${args[1].join(' ')} failed (exit ${status})`);
}

async function ctest(preset) {
  await mustRun('cmake', ['--preset', preset, '-Wno-dev', '--log-level=WARNING']);
  await mustRun('cmake', ['--build', '--preset', preset]);
  const { status, output } = await run('ctest', ['--preset', preset, '--progress', '-j2']);
  const [failed, all] = /(\d+) tests failed out of (\d+)/.exec(output)?.slice(1) ?? [1, 1];
  return { passed: all - failed, failed: Number(failed) || Number(status !== 0) };
}

async function nodeTests(folder, { atOnce = 1, env } = {}) {
  const files = readdirSync(new URL(folder, import.meta.url)).filter((name) => name.endsWith('.test.ts'));
  const { status, output } = await run(
    process.execPath,
    [
      '--import',
      'tsx',
      '--test',
      '--test-reporter=spec',
      `--test-concurrency=${atOnce}`,
      ...files.map((name) => `tests/${folder}/${name}`),
    ],
    env,
  );
  const count = (word) => Number(new RegExp(`^ℹ ${word} (\\d+)`, 'm').exec(output)?.[1] ?? 0);
  return {
    passed: count('pass'),
    failed: count('fail') + count('cancelled') || Number(status !== 0),
    skipped: count('skipped'),
  };
}

/** Each suite builds what it needs. In the order in which a mistake is cheapest to find. */
const kSuites = {
  lint: async () => {
    const { status, output } = await run(process.execPath, ['wasm/tools/lint/run.mjs']);
    const count = (word) => output.match(new RegExp(`^lint \\w+ +${word}`, 'gm'))?.length ?? 0;
    return { passed: count('ok'), failed: count('FAILED') || Number(status !== 0) };
  },
  core: async () => {
    const lanes = [await ctest('release'), await ctest('scalar'), await ctest('dev')];
    return {
      passed: lanes.reduce((sum, lane) => sum + lane.passed, 0),
      failed: lanes.reduce((sum, lane) => sum + lane.failed, 0),
    };
  },
  package: async () => {
    await mustRun('npm', ['run', '--silent', 'assets']);
    await mustRun('npm', ['run', '--silent', 'build']);
    // What several files need is built before: two that build it at once get in each other's way.
    await mustRun(process.execPath, ['wasm/tools/build.mjs', '--preset', 'wasm-scalar']);
    await mustRun('cmake', ['--preset', 'release', '-Wno-dev', '--log-level=WARNING']);
    await mustRun('cmake', ['--build', '--preset', 'release', '--target', 'cagecast_reference']);
    const env = {
      CAGECAST_SCALAR: 'build/wasm-scalar/package',
      CAGECAST_REFERENCE: 'build/release/tests/core/cagecast_reference',
    };
    const js = await nodeTests('js', { atOnce: 2, env });
    const packed = await nodeTests('package');
    return {
      passed: js.passed + packed.passed,
      failed: js.failed + packed.failed,
      skipped: js.skipped + packed.skipped,
    };
  },
  browser: async () => {
    await mustRun('npm', ['run', '--silent', 'assets']);
    await mustRun('npm', ['run', '--silent', 'build']);
    const { build, preview } = await import('vite');
    const page = fileURLToPath(new URL('../build/web', import.meta.url));
    const options = {
      configFile: fileURLToPath(new URL('../web/vite.config.ts', import.meta.url)),
      logLevel: 'error',
      build: { outDir: page },
    };
    await build(options);
    const server = await preview({ ...options, preview: { host: '127.0.0.1', port: 0 } });
    try {
      // On two cores two browsers that draw by the processor take 0.77 of the time of one after the other.
      const env = { CAGECAST_SITE: server.resolvedUrls.local[0], CAGECAST_PAGE: page };
      const browser = await nodeTests('browser', { atOnce: 2, env });
      const web = await nodeTests('web', { atOnce: 2, env });
      return {
        passed: browser.passed + web.passed,
        failed: browser.failed + web.failed,
        skipped: browser.skipped + web.skipped,
      };
    } finally {
      await server.close();
    }
  },
};

const chosen = process.argv.length > 2 ? process.argv.slice(2) : Object.keys(kSuites);
const unknown = chosen.find((name) => !(name in kSuites));
if (unknown) {
  console.error(`no suite "${unknown}"; there are: ${Object.keys(kSuites).join(', ')}`);
  process.exit(2);
}
const rows = [];
for (const name of chosen) {
  try {
    rows.push({ name, skipped: 0, ...(await kSuites[name]()) });
  } catch (error) {
    console.error(error.message);
    rows.push({ name, passed: 0, failed: 1, skipped: 0 });
  }
}
console.log('');
// A suite that ran nothing has not passed.
for (const row of rows) if (row.passed === 0 && row.failed === 0) row.failed = 1;
for (const { name, passed, failed, skipped } of rows)
  console.log(`${name.padEnd(8)} ${passed} passed, ${failed} failed, ${skipped} skipped`);
const sum = (field) => rows.reduce((total, row) => total + row[field], 0);
console.log(`\nall: ${sum('passed')} passed, ${sum('failed')} failed, ${sum('skipped')} skipped`);
process.exit(sum('failed') === 0 ? 0 : 1);
