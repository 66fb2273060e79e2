// Installs what the project needs and this machine lacks: Debian packages by apt, npm packages by the lock file.
// Uses nothing but Node, because it is the first thing that runs. A second run finds everything there and says nothing.
//
//   node wasm/tools/setup.mjs PURPOSE …      a suite of tests, or what `kPurposes` has

import { execFileSync, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, lstatSync, readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../..', import.meta.url));
/** As Vite asks for: the least minor version of each major one that has such; the package itself runs on 20.16. */
const kOldestNode = { 20: 19, 22: 12 };
const kNodes = '20.19, or 22.12 and newer';
/** Seconds to wait for another program that uses apt. */
const kMaxWait = 600;

const command = (name) => () => spawnSync('sh', ['-c', `command -v ${name}`]).status === 0;
const header = (path) => () =>
  ['/usr/include', '/usr/local/include', '/opt/homebrew/include', '/usr/include/eigen3'].some((folder) =>
    existsSync(`${folder}/${path}`),
  );

function linksFuzzTarget() {
  const input = 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }';
  const args = ['-fsanitize=fuzzer,address,undefined', '-x', 'c++', '-', '-o', '/dev/null'];
  return spawnSync('clang++', args, { input }).status === 0;
}

/** Programs beyond Node: how to find each, and its Debian package. */
const kNeeds = {
  emscripten: { what: 'Emscripten 3.1.6 or newer (emcc)', there: command('emcc') },
  cmake: { what: 'CMake 3.25 or newer', there: command('cmake') },
  'ninja-build': { what: 'Ninja', there: command('ninja') },
  'libnanoflann-dev': { what: 'nanoflann 1.4 or newer (nanoflann.hpp)', there: header('nanoflann.hpp') },
  'libeigen3-dev': { what: 'Eigen 3.4 (Eigen/SparseCholesky)', there: header('Eigen/SparseCholesky') },
  'g++': { what: 'a C++20 compiler', there: () => Boolean(process.env.CXX) || command('c++')() },
  'libtinygltf-dev': { what: 'tinygltf 2.7 or newer (tiny_gltf.h)', there: header('tiny_gltf.h') },
  'nlohmann-json3-dev': { what: 'nlohmann/json 3 (nlohmann/json.hpp)', there: header('nlohmann/json.hpp') },
  catch2: { what: 'Catch2 2.13 (catch2/catch.hpp)', there: header('catch2/catch.hpp') },
  chromium: { what: 'Chromium', there: () => Boolean(process.env.CHROMIUM) || command('chromium')() },
  libegl1: {
    what: "EGL with Mesa's software renderer",
    there: () => process.platform !== 'linux' || existsSync('/usr/share/glvnd/egl_vendor.d/50_mesa.json'),
  },
  'libembree-dev': { what: 'Embree 3 (embree3/rtcore.h)', there: header('embree3/rtcore.h') },
  valgrind: { what: 'Valgrind', there: command('valgrind') },
  'qemu-user': { what: 'QEMU user emulation (qemu-aarch64)', there: command('qemu-aarch64') },
  'g++-aarch64-linux-gnu': { what: 'a C++20 cross compiler for aarch64', there: command('aarch64-linux-gnu-g++') },
  'clang-format': { what: 'clang-format 14', there: command('clang-format') },
  doxygen: { what: 'Doxygen 1.9', there: command('doxygen') },
  'redis-server': { what: 'Redis 6.2 or newer (redis-server)', there: command('redis-server') },
  'clang-tidy': { what: 'clang-tidy 14', there: command('clang-tidy') },
  clang: { what: 'Clang 14 or newer (clang++)', there: command('clang++') },
  'libclang-rt-dev': { what: "Clang's sanitizers and libFuzzer", there: linksFuzzTarget },
  lld: { what: 'LLD (ld.lld)', there: command('ld.lld') },
  'mono-mcs': { what: 'Mono (mcs, mono)', there: command('mcs') },
  'python3-numpy': {
    what: 'Python 3 with NumPy (or the path of one in the environment variable PYTHON)',
    there: () =>
      [process.env.PYTHON, 'python3', 'python', '/usr/bin/python3'].some(
        (program) => program && spawnSync(program, ['-c', 'import numpy']).status === 0,
      ),
  },
};
const kPage = ['emscripten', 'cmake', 'ninja-build', 'libnanoflann-dev', 'libeigen3-dev'];
const kTests = [
  ...kPage,
  'g++',
  'libtinygltf-dev',
  'nlohmann-json3-dev',
  'catch2',
  'chromium',
  'libegl1',
  'clang-format',
];
const kClang = ['clang', 'libclang-rt-dev', 'lld'];
/** Folders with npm packages of their own. */
const kHosts = 'tests/release/hosts/';
const kCatalogue = 'examples/catalogue/';

/** What each purpose needs: system packages, and folders of npm packages beside the project's own. */
const kPurposes = {
  start: kPage,
  format: ['clang-format'],
  lint: ['clang-format'],
  test: kTests,
  tidy: [...kTests, 'clang-tidy'],
  docs: [...kPage, 'doxygen'],
  budgets: [...kTests, 'valgrind'], // which counts instructions
  hosts: [...kTests, 'python3-numpy', 'mono-mcs', kHosts],
  quality: [...kTests, 'python3-numpy'],
  catalogue: [...kPage, 'redis-server', kCatalogue],
  fuzz: [...kTests, ...kClang],
  mutants: [...kTests, ...kClang],
  bench: [...kTests, 'valgrind', 'libembree-dev', 'qemu-user', 'g++-aarch64-linux-gnu'],
  'bench:public': [...kPage, 'python3-numpy'],
  pictures: [...kPage, 'chromium'],
  release: [...kTests, 'doxygen', kHosts],
};

function fail(message) {
  console.error(message);
  process.exit(1);
}

/** @param {string} version  As `node --version` prints it. */
function isNewEnough(version) {
  const [major, minor] = version.replace('v', '').split('.').map(Number);
  return major > 22 || minor >= (kOldestNode[major] ?? Infinity);
}

const lineOf = (name) => `  ${kNeeds[name].what}  (Debian: ${name})`;

/** What runs apt-get with the right to install; null where nothing does. */
function installer() {
  const asRoot = process.getuid?.() === 0 ? [] : command('sudo')() ? ['sudo'] : null;
  return command('apt-get')() ? asRoot : null;
}

function installSystemPackages(missing, asRoot) {
  const apt = (...args) => {
    const [program, ...rest] = [...asRoot, 'env', 'DEBIAN_FRONTEND=noninteractive', 'apt-get', ...args];
    const { status, stderr } = spawnSync(program, rest, { stdio: ['ignore', 'inherit', 'pipe'], encoding: 'utf8' });
    return { failed: status !== 0, isLocked: /Unable to lock|Could not get lock/.test(stderr), stderr };
  };
  // Another program may hold the package manager's lock. `install` waits by itself, `update` cannot.
  let update = apt('update', '-qq');
  for (let waited = 0; update.isLocked && waited < kMaxWait; waited += 5) {
    if (waited === 0) console.log('Another program uses apt: waiting for it, for 10 minutes at most …');
    Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, 5000);
    update = apt('update', '-qq');
  }
  const install = ['install', '-y', '-qq', '--no-install-recommends', '-o', `DPkg::Lock::Timeout=${kMaxWait}`];
  const { failed, stderr } = update.failed ? update : apt(...install, ...missing);
  if (failed) fail(`${stderr.trim()}\napt-get could not install: ${missing.join(' ')}`);
  const still = missing.filter((name) => !kNeeds[name].there());
  if (still.length > 0) fail(`Installed, but still not found: ${still.map((name) => kNeeds[name].what).join(', ')}`);
  // Emscripten brings Debian's own Node along, which replaces one that was put into /usr/bin by hand.
  const node = spawnSync('node', ['--version'], { encoding: 'utf8' }).stdout?.trim() ?? 'none';
  if (!isNewEnough(node))
    fail(
      `The node in your PATH is now ${node}, from a Debian package; Cagecast needs ${kNodes}. Put yours before it, in /usr/local/bin say, and run this again.`,
    );
}

const lockOf = (folder) =>
  createHash('sha256')
    .update(readFileSync(`${root}${folder}package-lock.json`))
    .digest('hex');
const stampOf = (folder) => `${root}${folder}node_modules/.installed-lock`;

/** Whether a folder of the repository has the packages of its lock file, or those of another checkout by a link, as worktrees do. */
const hasPackages = (folder) =>
  lstatSync(`${root}${folder}node_modules`, { throwIfNoEntry: false })?.isSymbolicLink() ||
  (existsSync(stampOf(folder)) && readFileSync(stampOf(folder), 'utf8') === lockOf(folder));

/**
 * Installs the packages of a folder as its lock file says. `npm ci` refuses a lock file that lacks a package's builds for other systems,
 * which not every registry has, as that of the hosts; `npm install --no-save` does not, and leaves the file as it is.
 */
function installNpmPackages(folder) {
  const args = folder === kHosts ? ['install', '--no-save'] : ['ci'];
  execFileSync('npm', [...args, '--no-audit', '--no-fund', '--loglevel=error'], {
    cwd: `${root}${folder}`,
    stdio: ['ignore', 'inherit', 'inherit'],
  });
  writeFileSync(stampOf(folder), lockOf(folder));
}

const purposes = process.argv.slice(2);
const unknown = purposes.find((purpose) => !(purpose in kPurposes));
if (purposes.length === 0 || unknown !== undefined)
  fail(`usage: node wasm/tools/setup.mjs ${Object.keys(kPurposes).join(' | ')}`);
if (!isNewEnough(process.version)) fail(`Cagecast needs Node ${kNodes}; this is ${process.versions.node}.`);
const needs = [...new Set(purposes.flatMap((purpose) => kPurposes[purpose]))];
const missing = needs.filter((name) => name in kNeeds && !kNeeds[name].there());
const folders = ['', kHosts, kCatalogue].filter((one) => (one === '' || needs.includes(one)) && !hasPackages(one));
const asRoot = installer();
if (missing.length > 0 && asRoot === null)
  fail(
    `Cagecast needs, and this machine lacks:\n${missing.map(lineOf).join('\n')}\nPlease install them (apt-get, as root or with sudo, would do it), then run this again.`,
  );
const list = [...missing.map(lineOf), ...folders.map((folder) => `  the npm packages of ${folder}package-lock.json`)];
if (list.length > 0) console.log(`Missing here, and to be installed now:\n${list.join('\n')}`);
if (missing.length > 0) installSystemPackages(missing, asRoot);
for (const folder of folders) installNpmPackages(folder);
