// Makes what a release consists of, from a commit whose tests are all green. Publishing and tagging is left to the workflow "release", whose
// jobs with permissions run none of this.
//
//   npm run release                 tests, builds, packs, checks the package, and makes the site; ends at what keeps this version back
//   npm run release -- --dry-run    tells that, and goes on
//   … --tested COMMIT               without the tests: all of them were green on this commit, which must be the one that is here
//
// What it makes is in build/release-files: the package, its list of parts (SBOM, CycloneDX), the hashes of both, and the site: the page, with
// the documentation in docs/. The site works from any folder of any server, and its address is "homepage" of package.json.

import { execFileSync, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { sbomOf } from './sbom.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
const out = join(root, 'build/release-files');
const { values } = parseArgs({ options: { 'dry-run': { type: 'boolean' }, tested: { type: 'string' } } });
const isDry = values['dry-run'] ?? false;
const manifest = JSON.parse(readFileSync(join(root, 'package.json'), 'utf8'));
const { version, homepage } = manifest;
const tag = `v${version}`;
const commitOf = (name) => textOf('git', 'rev-parse', '--verify', `${name}^{commit}`);

/** Ends with what keeps this version back; a dry run tells it and goes on. */
function stopAt(faults) {
  for (const fault of faults) console.log(`${isDry ? 'Would stop here' : 'Not released'}: ${fault}`);
  if (faults.length > 0 && !isDry) process.exit(1);
}

/** What keeps the version from being released. */
function faultsOfVersion() {
  const faults = [];
  const changes = readFileSync(join(root, 'CHANGELOG.md'), 'utf8');
  if (!new RegExp(`^## ${version.replaceAll('.', '\\.')} \\(\\d{4}-\\d{2}-\\d{2}\\)$`, 'm').test(changes))
    faults.push(`CHANGELOG.md has no line "## ${version} (YYYY-MM-DD)"`);
  if (!readFileSync(join(root, 'CMakeLists.txt'), 'utf8').includes(`project(cagecast VERSION ${version} `))
    faults.push(`CMakeLists.txt has another version than package.json, ${version}`);
  // A tag of this very commit is that of a run that did not come to its end.
  if (textOf('git', 'tag', '--list', tag) && commitOf(tag) !== commitOf('HEAD'))
    faults.push(`the tag ${tag} is there already; raise "version" in package.json and CMakeLists.txt`);
  return faults;
}

/** Whether what is here is the commit whose tests were green. */
function faultsOfCommit(tested) {
  const faults = [];
  if (commitOf('HEAD') !== tested) faults.push(`the tests were of ${tested}, and this is ${commitOf('HEAD')}`);
  if (textOf('git', 'status', '--porcelain')) faults.push('there are changes that are not committed');
  return faults;
}

/** Packs the package. @returns its file. */
function pack() {
  const [{ filename, size, unpackedSize, entryCount }] = JSON.parse(
    textOf('npm', 'pack', '--json', '--pack-destination', out),
  );
  const kilobytes = (bytes) => `${Math.round(bytes / 1024).toLocaleString('en')} KB`;
  console.log(`${filename}: ${kilobytes(size)}, ${kilobytes(unpackedSize)} unpacked, ${entryCount} files`);
  return join(out, filename);
}

/** The list of what the package contains, which the build knows, and the hashes of it and of the package. */
function describe(file) {
  const parts = JSON.parse(readFileSync(join(root, 'build/wasm/parts.json'), 'utf8'));
  const list = join(out, 'sbom.cdx.json');
  writeFileSync(list, `${JSON.stringify(sbomOf(manifest, parts, readFileSync(file)), null, 2)}\n`);
  console.log(`sbom.cdx.json: ${parts.length} parts`);
  const hash = (path) => createHash('sha256').update(readFileSync(path)).digest('hex');
  writeFileSync(join(out, 'SHA256SUMS'), [file, list].map((path) => `${hash(path)}  ${basename(path)}\n`).join(''));
}

/** The page, with the documentation in docs/. */
function makeSite() {
  const site = join(out, 'site');
  run('npx', 'vite', 'build', 'web', '--outDir', site, '--emptyOutDir', '--logLevel', 'warn');
  run('npm', 'run', '--silent', 'docs');
  cpSync(join(root, 'build/docs'), join(site, 'docs'), { recursive: true });
  const files = readdirSync(site, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  const bytes = files.reduce(
    (sum, { parentPath, path, name }) => sum + statSync(join(parentPath ?? path, name)).size,
    0,
  );
  console.log(`site: ${files.length} files, ${(bytes / 1e6).toFixed(1)} MB, for ${homepage}`);
}

const environment = { ...process.env, CAGECAST_URL: homepage };

function run(program, ...args) {
  console.log(`$ ${[program, ...args].join(' ')}`);
  const { status } = spawnSync(program, args, { cwd: root, stdio: 'inherit', env: environment });
  if (status !== 0) process.exit(status ?? 1);
}

const textOf = (program, ...args) =>
  execFileSync(program, args, {
    cwd: root,
    encoding: 'utf8',
    maxBuffer: 2 ** 28,
    stdio: ['ignore', 'pipe', 'inherit'],
  }).trim();

const tested = commitOf(values.tested ?? 'HEAD');
stopAt([...faultsOfVersion(), ...faultsOfCommit(tested)]);
if (!values.tested) {
  run('npm', 'run', 'test:all');
  stopAt(faultsOfCommit(tested)); // which may have changed in that hour
}
run('node', 'wasm/tools/build.mjs');
rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
const file = pack();
run('npx', 'publint', 'run', file, '--strict');
run('node', '--import', 'tsx', '--test', '--test-reporter=dot', 'tests/release/hosts/package.test.ts');
describe(file);
makeSite();
console.log(`All is made: ${out}`);
