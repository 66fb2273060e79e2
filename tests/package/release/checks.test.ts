// What keeps a version from being released. Each test asks for a release of a small repository; one that nothing keeps back comes as far as
// the build, which is not there.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { test } from 'node:test';
import { temporaryFolder } from '../../support/temporary.js';

const { at } = temporaryFolder('release');

interface Repository {
  root: string;
  git(...args: string[]): string;
}

/** A repository whose version 1.2.3 could be released. */
function repository(name: string): Repository {
  const root = at(name);
  const git = (...args: string[]): string => {
    const who = ['-c', 'user.name=a', '-c', 'user.email=a@b.c'];
    const { status, stdout, stderr } = spawnSync('git', [...who, ...args], { cwd: root, encoding: 'utf8' });
    assert.equal(status, 0, stderr);
    return stdout.trim();
  };
  mkdirSync(join(root, 'wasm/tools'), { recursive: true });
  for (const file of ['release.mjs', 'sbom.mjs']) cpSync(resolve('wasm/tools', file), join(root, 'wasm/tools', file));
  writeFileSync(join(root, 'package.json'), '{ "name": "cagecast", "version": "1.2.3", "homepage": "https://a.b" }');
  writeFileSync(join(root, 'CMakeLists.txt'), 'project(cagecast VERSION 1.2.3 LANGUAGES CXX)\n');
  writeFileSync(join(root, 'CHANGELOG.md'), '# Changelog\n\n## 1.2.3 (2030-01-02)\n');
  git('init', '--quiet');
  git('add', '.');
  git('commit', '--quiet', '-m', 'one');
  return { root, git };
}

/** Asks for a release whose tests ran. @returns what keeps it back. */
function faultsIn({ root }: Repository, tested = 'HEAD'): string[] {
  const args = ['wasm/tools/release.mjs', '--tested', tested];
  const { status, stdout } = spawnSync(process.execPath, args, { cwd: root, encoding: 'utf8' });
  assert.notEqual(status, 0);
  const faults = stdout.split('\n').filter((line) => line.startsWith('Not released: '));
  assert.equal(faults.length === 0, stdout.includes('wasm/tools/build.mjs'), stdout);
  return faults.map((line) => line.replace('Not released: ', ''));
}

test('nothing keeps back a dated version of the tested commit, nor one that a run tagged and did not publish', () => {
  const good = repository('good');
  assert.deepEqual(faultsIn(good), []);
  good.git('tag', 'v1.2.3');
  assert.deepEqual(faultsIn(good), []);
});

test('a version without a day, or that CMake does not know', () => {
  const bad = repository('undated');
  writeFileSync(join(bad.root, 'CHANGELOG.md'), '## Unreleased: 1.2.3\n');
  writeFileSync(join(bad.root, 'CMakeLists.txt'), 'project(cagecast VERSION 1.2.4 LANGUAGES CXX)\n');
  bad.git('commit', '--quiet', '-am', 'two');
  const [day, cmake, ...others] = faultsIn(bad);
  assert.match(day ?? '', /CHANGELOG\.md has no line "## 1\.2\.3 \(YYYY-MM-DD\)"/);
  assert.match(cmake ?? '', /CMakeLists\.txt/);
  assert.deepEqual(others, []);
});

test('another commit than the one that was tested, or changes on it', () => {
  const bad = repository('untested');
  const tested = bad.git('rev-parse', 'HEAD');
  bad.git('commit', '--quiet', '--allow-empty', '-m', 'two');
  assert.deepEqual(faultsIn(bad, tested), [`the tests were of ${tested}, and this is ${bad.git('rev-parse', 'HEAD')}`]);
  writeFileSync(join(bad.root, 'new.txt'), '');
  assert.deepEqual(faultsIn(bad), ['there are changes that are not committed']);
});

test('a version that another commit was tagged as', () => {
  const bad = repository('tagged');
  bad.git('tag', '--annotate', 'v1.2.3', '-m', 'v1.2.3');
  assert.deepEqual(faultsIn(bad), []);
  bad.git('commit', '--quiet', '--allow-empty', '-m', 'two');
  assert.match(faultsIn(bad).join(), /^the tag v1\.2\.3 is there already/);
});
