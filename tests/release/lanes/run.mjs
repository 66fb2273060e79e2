// Asks every kind of build that this machine has for the answers on fixed scenes, and prints their hashes as one table.
//
//   node --import tsx tests/release/lanes/run.mjs [--built]
//     --built   only what `npm run test:all` has built: the native program with AVX2, without SIMD and with sanitizers, and the package
//
// Other native builds are made in build/lanes. A lane whose tools are not here is left out, and the table says so.

import { execFile, execFileSync, spawn, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import {
  copyFileSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  rmSync,
  writeFileSync,
} from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { promisify } from 'node:util';
import { build } from 'esbuild';
import { hashesOf } from '../../support/golden.ts';
import { nativeCommand } from '../../support/native.ts';

const root = fileURLToPath(new URL('../../..', import.meta.url));
const work = join(root, 'build/lanes');
const release = join(root, 'build/twins/tests/release/lanes');
const isQuick = process.argv.includes('--built');
const scenes = mkdtempSync(join(tmpdir(), 'cagecast-lanes-'));
const call = promisify(execFile);

const has = (name) => spawnSync('sh', ['-c', `command -v ${name}`]).status === 0;
const read = (name) =>
  existsSync(join(scenes, name)) ? Uint8Array.from(readFileSync(join(scenes, name))).buffer : new ArrayBuffer(0);

/** Thrown by a lane that this machine cannot have. */
class LeftOut extends Error {}

/** What keeps this machine from running a program, if anything does. */
function need(...programs) {
  const missing = programs.filter((name) => !has(name));
  if (missing.length > 0) throw new LeftOut(`no ${missing.join(', no ')}`);
}

/** What writes the scenes for those in JavaScript. */
const writer = () => (isQuick ? join(root, 'build/twins/tests/core/cagecast_reference') : nativeCommand());

const printed = async (program, args = []) => (await call(program, args)).stdout.trim();

/** The core's files in groups of eight, as CMake puts them together: a quarter of the time that each alone would take. */
function sourceGroups() {
  const list = /set\(CAGECAST_SOURCES\n([\s\S]*?)\)/.exec(readFileSync(join(root, 'core/CMakeLists.txt'), 'utf8'))[1];
  const files = list
    .trim()
    .split(/\s+/)
    .map((file) => join(root, 'core', file));
  const groups = Array.from({ length: Math.ceil(files.length / 8) }, (_, i) => files.slice(8 * i, 8 * i + 8));
  return [...groups, [join(root, 'tests/core/scenes/scenes.cpp')], [join(root, 'tests/release/lanes/lane.cpp')]];
}

/** Compiles the core another way; kept until a source changes. */
async function compiled(compiler, flags) {
  const folders = ['core', 'tests/release/lanes', 'tests/core'].map((folder) => join(root, folder));
  const texts = folders.flatMap((folder) =>
    readdirSync(folder, { recursive: true })
      .filter((name) => /\.([ch]pp|def|txt)$/.test(name))
      .map((name) => readFileSync(join(folder, name))),
  );
  const { stdout: version } = await call(compiler, ['--version']);
  const hash = createHash('sha256').update(version + flags);
  for (const text of texts) hash.update(text);
  const program = join(work, hash.digest('hex').slice(0, 16));
  if (existsSync(program)) return program;
  mkdirSync(join(work, 'include'), { recursive: true });
  copyFileSync('/usr/include/nanoflann.hpp', join(work, 'include/nanoflann.hpp'));
  const includes = ['core/src', 'core/include', 'tests/core', 'build/lanes/include'].map(
    (path) => `-I${join(root, path)}`,
  );
  const objects = [];
  for (const [i, files] of sourceGroups().entries()) {
    const source = `${program}-${i}.cpp`;
    writeFileSync(source, files.map((file) => `#include "${file}"\n`).join(''));
    objects.push(`${program}-${i}.o`);
    await call(compiler, [
      '-std=c++20',
      '-ffp-contract=off',
      '-w',
      ...flags,
      ...includes,
      '-c',
      source,
      '-o',
      objects.at(-1),
    ]);
  }
  await call(compiler, [...flags, ...objects, '-o', program]);
  for (const [i, object] of objects.entries()) for (const file of [object, `${program}-${i}.cpp`]) rmSync(file);
  return program;
}

/** A native build of its own. */
const native =
  (compiler, ...flags) =>
  async () => {
    need(compiler);
    return printed(await compiled(compiler, flags));
  };

/** What is missing is an error with `--built`; else its lane is left out. */
const notBuilt = (text) => (isQuick ? new Error(text) : new LeftOut(text));

/** A native build that `npm run test:all` has made anyway. */
const built = (name) => async () => {
  const program = join(release, name);
  if (!existsSync(program)) throw notBuilt(`build/twins has no ${name}`);
  return printed(program);
};

/** A build of the package, in Node. */
const inNode = (path) => async () => {
  const file = join(root, path);
  if (!existsSync(file)) throw notBuilt(`no ${path}`);
  const module = await import(pathToFileURL(file).href);
  await module.init();
  return hashesOf(module, read);
};

/** Serves the page of this folder; what it answers. */
async function servePage() {
  const { outputFiles } = await build({
    entryPoints: [join(root, 'tests/release/lanes/page.ts')],
    alias: { cagecast: join(root, 'dist/index.js') },
    ...{ bundle: true, write: false, format: 'esm', logLevel: 'error' },
  });
  let settle;
  const answer = new Promise((resolve) => (settle = resolve));
  const files = {
    '/': ['text/html', '<!doctype html><script type="module" src="page.js"></script>'],
    '/page.js': ['text/javascript', outputFiles[0].contents],
    ...Object.fromEntries(
      readdirSync(scenes)
        .filter((name) => name.endsWith('.scene'))
        .map((name) => [`/${name}`, ['application/octet-stream', readFileSync(join(scenes, name))]]),
    ),
  };
  const server = createServer((request, response) => {
    if (request.method === 'POST') {
      let body = '';
      request.on('data', (data) => (body += data)).on('end', () => settle(body));
    }
    const [type, text] = files[request.url] ?? ['text/plain', ''];
    response.writeHead(200, { 'Content-Type': type }).end(text);
  });
  await new Promise((ready) => server.listen(0, '127.0.0.1', ready));
  return { answer, url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}

/** A browser without a window, with a profile of its own. */
const inBrowser =
  (program, ...args) =>
  async () => {
    need(program);
    const page = await servePage();
    const profile = mkdtempSync(join(scenes, 'profile-'));
    const options = { stdio: 'ignore', detached: true, env: { ...process.env, HOME: profile } };
    const browser = spawn(program, args.map((text) => text.replace('PROFILE', profile)).concat(page.url), options);
    const ended = new Promise((resolve) => browser.on('close', resolve));
    let timer;
    const tooLong = new Promise((resolve) => (timer = setTimeout(resolve, 180_000, 'no answer in three minutes')));
    try {
      return await Promise.race([page.answer, ended.then((code) => `ended with ${code}`), tooLong]);
    } finally {
      clearTimeout(timer);
      try {
        // Of the group, with the processes that it started.
        process.kill(-browser.pid, 'SIGKILL');
      } catch {}
      await ended;
      page.close();
    }
  };

async function onAarch64() {
  need('aarch64-linux-gnu-g++', 'qemu-aarch64');
  return printed('qemu-aarch64', [await compiled('aarch64-linux-gnu-g++', ['-O2', '-static'])]);
}

const quick = [
  ['g++ -O3, AVX2 if there is', built('cagecast_lane')],
  ['g++ -O3, without SIMD', built('cagecast_lane_scalar')],
  ['g++ -O1, with sanitizers', built('cagecast_lane_sanitized')],
];
const own = [
  ['g++ -O0', native('g++', '-O0')],
  ['g++ -O2', native('g++', '-O2')],
  ['g++ -O3', native('g++', '-O3')],
  ['g++ -O3 -march=native', native('g++', '-O3', '-march=native')],
  ['clang++ -O0', native('clang++', '-O0')],
  ['clang++ -O3', native('clang++', '-O3')],
  ['clang++ -O3 -march=native', native('clang++', '-O3', '-march=native')],
  ['clang++ -O2, without SIMD', native('clang++', '-O2', '-DCAGECAST_SCALAR')],
  ['aarch64 -O2, NEON, by QEMU', onAarch64],
];
const wasm = [
  ['WebAssembly, Node', inNode('dist/index.js')],
  ['WebAssembly in a file, Node', inNode('dist/slim.js')],
  ['WebAssembly, no SIMD, Node', inNode('build/wasm-scalar/package/index.js')],
];
const browsers = [
  [
    'WebAssembly, Chromium',
    inBrowser('chromium', '--headless', '--no-sandbox', '--disable-gpu', '--no-first-run', '--user-data-dir=PROFILE'),
  ],
  ['WebAssembly, Firefox', inBrowser('firefox-esr', '--headless', '--no-remote', '--profile', 'PROFILE')],
];

/** The lanes to run; those too slow for `npm test` are named as such. */
function chosenLanes() {
  const later = async () => {
    throw new LeftOut('npm run lanes');
  };
  if (isQuick) return [...quick, ...wasm, browsers[0], ...[...own, browsers[1]].map(([name]) => [name, later])];
  return [...quick, ...own, ...wasm, ...browsers];
}

/** Of cages there is no golden hash, as sines and powers differ between machines: the lanes of this one agree. */
const ofCages = [
  ['cages: g++ -O3, AVX2 if there is', built('cagecast_cage_lane')],
  ['cages: without SIMD', built('cagecast_cage_lane_scalar')],
];

const golden = (name) => readFileSync(join(root, `tests/core/golden/${name}.txt`), 'utf8').trim();
let equal = 0;
let failed = 0;

/** Prints the hashes of some lanes. @param expected  By default those of the first. */
async function compare(lanes, expected) {
  for (const [name, lane] of lanes) {
    let line;
    try {
      const hashes = await lane();
      expected ??= hashes;
      if (hashes === expected) ++equal;
      else ++failed;
      line = hashes === expected ? hashes : `${hashes}  DIFFERS`;
    } catch (error) {
      if (!(error instanceof LeftOut)) ++failed;
      line = error instanceof LeftOut ? `left out: ${error.message}` : `FAILED: ${error.message.trim()}`;
    }
    console.log(`${name.padEnd(32)} ${line}`);
  }
}

const row = (name, ...columns) =>
  console.log([name.padEnd(32), ...columns.map((text) => text.padEnd(16))].join(' ').trimEnd());
row('lane', 'paper', 'default', 'cut borders');
try {
  execFileSync(writer(), ['--golden', scenes]);
  await compare(chosenLanes(), ['hash', 'hash-default', 'hash-borders'].map(golden).join(' '));
  row('', 'made', 'fitted', 'refined', 'landmarks');
  await compare(ofCages);
} finally {
  // Chromium's processes may still be ending.
  rmSync(scenes, { recursive: true, force: true, maxRetries: 20, retryDelay: 100 });
}
console.log(`lanes with equal hashes: ${equal}, with others: ${failed}`);
process.exit(failed === 0 && equal > 0 ? 0 : 1);
