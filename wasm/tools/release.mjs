// Makes a release: tests, builds, packs, checks the package, makes the site, publishes, and tags.
//
//   npm run release                 all of it; the workflow "release" calls it, as only there the package gets its provenance
//   npm run release -- --dry-run    all but publishing and tagging
//   … --tested                      without the tests, which ran before
//
// What it makes is in build/release-files: the package, its list of parts (SBOM, CycloneDX), and the site: the page, with the documentation
// in docs/. The site works from any folder of any server, and its address is "homepage" of package.json.

import { execFileSync, spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const root = fileURLToPath(new URL('../..', import.meta.url));
const out = join(root, 'build/release-files');
const { values } = parseArgs({ options: { 'dry-run': { type: 'boolean' }, tested: { type: 'boolean' } } });
const isDry = values['dry-run'] ?? false;
const { name, version, homepage } = JSON.parse(readFileSync(join(root, 'package.json'), 'utf8'));
const tag = `v${version}`;

/** What is compiled into the WebAssembly modules: npm does not know of it. */
const kCompiled = [
  { name: 'nanoflann', version: '1.4.3', license: 'BSD-2-Clause', url: 'https://github.com/jlblancoc/nanoflann' },
  { name: 'meshoptimizer', version: '0.22', license: 'MIT', url: 'https://github.com/zeux/meshoptimizer' },
  { name: 'eigen', version: '3.4.0', license: 'MPL-2.0', url: 'https://eigen.tuxfamily.org' },
];

/** What keeps a version from being released; a dry run tells it and goes on. */
function checkVersion() {
  const faults = [];
  const changes = readFileSync(join(root, 'CHANGELOG.md'), 'utf8');
  if (!new RegExp(`^## ${version.replaceAll('.', '\\.')} \\(\\d{4}-\\d{2}-\\d{2}\\)$`, 'm').test(changes))
    faults.push(`CHANGELOG.md has no line "## ${version} (YYYY-MM-DD)"`);
  if (textOf('git', 'status', '--porcelain')) faults.push('there are changes that are not committed');
  if (textOf('git', 'tag', '--list', tag))
    faults.push(`the tag ${tag} is there already; raise "version" in package.json`);
  for (const fault of faults) console.log(`${isDry ? 'Would stop here' : 'Not released'}: ${fault}`);
  if (faults.length > 0 && !isDry) process.exit(1);
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

/** The parts that the package is made of and with, from the lock file. */
function writeParts() {
  const bom = JSON.parse(textOf('npm', 'sbom', '--sbom-format', 'cyclonedx', '--package-lock-only'));
  // The same for the same lock file: neither the time nor a random number.
  delete bom.serialNumber;
  delete bom.metadata.timestamp;
  for (const { name, version, license, url } of kCompiled)
    bom.components.push({
      type: 'library',
      'bom-ref': `${name}@${version}`,
      name,
      version,
      licenses: [{ license: { id: license } }],
      externalReferences: [{ type: 'website', url }],
    });
  writeFileSync(join(out, 'sbom.cdx.json'), `${JSON.stringify(bom, null, 2)}\n`);
  console.log(`sbom.cdx.json: ${bom.components.length} parts`);
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

function publish(file) {
  run('npm', 'publish', file, '--access', 'public', '--provenance');
  run('git', 'tag', '--annotate', tag, '--message', `${name} ${version}`);
  run('git', 'push', 'origin', tag);
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

checkVersion();
if (!values.tested) run('node', 'tests/run.mjs');
run('node', 'wasm/tools/build.mjs');
rmSync(out, { recursive: true, force: true });
mkdirSync(out, { recursive: true });
const file = pack();
run('npx', 'publint', 'run', file, '--strict');
run('node', '--import', 'tsx', '--test', '--test-reporter=dot', 'tests/release/hosts/package.test.ts');
writeParts();
makeSite();
if (isDry) console.log(`All but publishing is done: ${out}`);
else publish(file);
