import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, test } from 'node:test';

const prefix = mkdtempSync(join(tmpdir(), 'cagecast-native-'));
after(() => rmSync(prefix, { recursive: true, force: true }));

function run(command: string, ...args: string[]): string {
  const { status, stdout, stderr } = spawnSync(command, args, { encoding: 'utf8' });
  assert.equal(status, 0, `${command} ${args.join(' ')}:\n${stdout}${stderr}`);
  return stdout;
}

// The same answer as examples/node/arrays.js prints.
const expected = /^vertex 0: u = 0\.25, v = 0\.25, may be painted\nvertex 1: u = 0\.5, v = 0\.25, may be painted\n/;

/** Configures and builds a project in a folder below build/, which the next run finds again. */
function build(source: string, folder: string, ...options: string[]): string {
  const out = join('build', folder);
  // Unoptimised, and several files as one: this is about finding and linking the library.
  const quick = ['-DCMAKE_BUILD_TYPE=Debug', '-DCMAKE_UNITY_BUILD=ON'];
  run('cmake', '-S', source, '-B', out, '-G', 'Ninja', '--log-level=WARNING', ...quick, ...options);
  run('cmake', '--build', out, '-j2');
  return out;
}

/** Builds the example with the sources, as a project with flags and folders of its own would. */
const buildWithSources = () =>
  build(
    'examples/native',
    'example-sources',
    '-DCMAKE_DISABLE_FIND_PACKAGE_cagecast=ON',
    '-DCMAKE_CXX_FLAGS=-fno-exceptions -fno-rtti -ffast-math -Wconversion',
    '-DCMAKE_INSTALL_INCLUDEDIR=headers',
  );

describe('examples/native', () => {
  test('uses the sources, by add_subdirectory, in a project without exceptions and with fast-math', () => {
    const out = buildWithSources();
    assert.match(run(join(out, 'example')), expected);
    // What a consumer does not ask for is not built.
    const targets = run('cmake', '--build', out, '--target', 'help');
    assert.doesNotMatch(targets, /cagecast_tests|cagecast_bench/);
  });

  test('builds one library, the core, in a project that adds its folder as the README says', () => {
    const lines = [
      'cmake_minimum_required(VERSION 3.25)',
      'project(user LANGUAGES CXX)',
      `add_subdirectory("${process.cwd()}" cagecast)`,
    ];
    writeFileSync(join(prefix, 'CMakeLists.txt'), lines.join('\n'));
    const out = join(prefix, 'build');
    run('cmake', '-S', prefix, '-B', out, '-G', 'Ninja', '--log-level=WARNING');
    assert.deepEqual(run('ninja', '-C', out, '-n').match(/\w+(?=\.a$)/gm), ['libcagecast']);
  });

  test('uses the installed library, by find_package', () => {
    const sources = buildWithSources();
    run('cmake', '--install', join(sources, 'cagecast'), '--component', 'cagecast', '--prefix', prefix);
    const headers = readdirSync(join(prefix, 'headers', 'cagecast'));
    assert.ok(headers.includes('transfer.hpp'));
    // Of a library that is not installed.
    assert.ok(!headers.includes('cages.hpp'));
    const out = build('examples/native', 'example-installed', `-DCMAKE_PREFIX_PATH=${prefix}`, '--fresh');
    assert.ok(readFileSync(join(out, 'CMakeCache.txt'), 'utf8').includes(`cagecast_DIR:PATH=${prefix}`));
    assert.match(run(join(out, 'example')), expected);
  });
});
