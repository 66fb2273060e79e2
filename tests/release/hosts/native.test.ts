import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { describe, test } from 'node:test';
import { temporaryFolder } from '../../support/temporary.js';

const { at } = temporaryFolder('native');

const call = (command: string, ...args: string[]) => spawnSync(command, args, { encoding: 'utf8' });

function run(command: string, ...args: string[]): string {
  const { status, stdout, stderr } = call(command, ...args);
  assert.equal(status, 0, `${command} ${args.join(' ')}:\n${stdout}${stderr}`);
  return stdout;
}

// The same answer as examples/node/arrays.js prints.
const expected = /^vertex 0: u = 0\.25, v = 0\.25, may be painted\nvertex 1: u = 0\.5, v = 0\.25, may be painted\n/;
const expectedOfCages = 'a cage of 600 triangles; 8 of 8 vertices may be painted\n';

/** Configures a project. Hardly optimised, and several files as one: this is about finding and linking libraries. */
const configure = (source: string, out: string, ...options: string[]) =>
  call('cmake', '-S', source, '-B', out, '-G', 'Ninja', '-DCMAKE_UNITY_BUILD=ON', ...options);

function build(source: string, out: string, ...options: string[]): string {
  const { status, stdout, stderr } = configure(source, out, '-DCMAKE_CXX_FLAGS=-O1', ...options);
  assert.equal(status, 0, `cmake -S ${source}:\n${stdout}${stderr}`);
  run('cmake', '--build', out, '-j2');
  return out;
}

/** A folder outside of the repository with the files of a program. */
function project(name: string, files: Record<string, string>): string {
  mkdirSync(at(name));
  for (const [file, text] of Object.entries(files)) writeFileSync(at(name, file), text);
  return at(name);
}

const lists = (...lines: string[]) =>
  ['cmake_minimum_required(VERSION 3.25)', 'project(user LANGUAGES CXX)', ...lines].join('\n');
const page = readFileSync('docs/cpp.md', 'utf8');
const block = (kind: string) => new RegExp(`\`\`\`${kind}\n([^]*?)\`\`\``).exec(page)![1]!;

/** Builds and runs the examples, in a folder outside of the repository, with the libraries in another. */
function useInstalled(prefix: string): void {
  const source = `${prefix}-user`;
  cpSync('examples/native', source, { recursive: true });
  const out = build(source, `${source}/build`, `-DCMAKE_PREFIX_PATH=${prefix}`);
  assert.ok(readFileSync(`${out}/CMakeCache.txt`, 'utf8').includes(`cagecast_DIR:PATH=${prefix}`));
  assert.match(run(`${out}/example`), expected);
  assert.equal(run(`${out}/cages`), expectedOfCages);
}

describe('both libraries', () => {
  // A project with flags and folders of its own. What it builds stays for the next run, and is what the next test installs.
  const fetched = resolve('build/native-fetched');

  test('come by FetchContent, as docs/cpp.md shows, into a project without exceptions and with fast-math', () => {
    const source = project('fetched', { 'CMakeLists.txt': block('cmake'), 'main.cpp': block('cpp') });
    build(
      source,
      fetched,
      '--fresh',
      `-DFETCHCONTENT_SOURCE_DIR_CAGECAST=${process.cwd()}`,
      '-DCMAKE_CXX_FLAGS=-O1 -fno-exceptions -fno-rtti -ffast-math -Wconversion',
      '-DCMAKE_INSTALL_INCLUDEDIR=headers',
    );
    assert.equal(run(`${fetched}/hello`), expectedOfCages);
    // What a consumer does not ask for is not built.
    assert.doesNotMatch(run('cmake', '--build', fetched, '--target', 'help'), /cagecast_tests|cagecast_bench/);
  });

  test('are installed, and found by find_package', () => {
    run('cmake', '--install', `${fetched}/_deps/cagecast-build`, '--component', 'cagecast', '--prefix', at('static'));
    assert.ok(readdirSync(at('static/headers/cagecast')).includes('cages.hpp'));
    useInstalled(at('static'));
  });

  test('define no names of the libraries that are compiled in', () => {
    for (const name of ['cagecast', 'cagecast_cages']) {
      const names = run('nm', '--demangle', '--defined-only', '--extern-only', at('static/lib', `lib${name}.a`));
      const foreign = names
        .split('\n')
        .filter((line) => /^[0-9a-f]+ /.test(line) && !/cagecast|std::|__gnu|DW\.ref/.test(line));
      assert.deepEqual(foreign, []);
    }
  });

  test('are installed as shared libraries; without cages, asking for these is an error that says why', () => {
    const out = resolve('build/native-shared');
    const options = ['-DCAGECAST_TESTS=OFF', '-DBUILD_SHARED_LIBS=ON'];
    build('.', out, ...options, '-DCAGECAST_CAGES=ON');
    run('cmake', '--install', out, '--prefix', at('shared'));
    useInstalled(at('shared'));

    build('.', out, ...options, '-DCAGECAST_CAGES=OFF');
    run('cmake', '--install', out, '--prefix', at('core'));
    assert.ok(!readdirSync(at('core/include/cagecast')).includes('cages.hpp'));
    const find = (components: string) =>
      configure(
        project(`find${components}`, { 'CMakeLists.txt': lists(`find_package(cagecast REQUIRED ${components})`) }),
        at(`find${components}`, 'build'),
        `-DCMAKE_PREFIX_PATH=${at('core')}`,
      );
    assert.equal(find('').status, 0);
    assert.match(find('COMPONENTS cages').stderr.replace(/\s+/g, ' '), /cagecast::cages is not installed there/);
  });
});

describe('the core', () => {
  test('is the one library of a project that adds its folder', () => {
    const source = project('added', { 'CMakeLists.txt': lists(`add_subdirectory("${process.cwd()}" cagecast)`) });
    assert.equal(configure(source, at('added/build')).status, 0);
    assert.deepEqual(run('ninja', '-C', at('added/build'), '-n').match(/\w+(?=\.a$)/gm), ['libcagecast']);
  });

  for (const compiler of ['g++', 'clang++'])
    test(`gives the same bits as two files, by ${compiler}`, { skip: call(compiler, '--version').status !== 0 }, () => {
      const folder = at(compiler);
      run(process.execPath, 'core/amalgamate.mjs', folder);
      const warnings = ['-Wall', '-Wextra', '-Wshadow', '-Wconversion', '-Werror'];
      const flags = ['-std=c++20', '-O2', '-ffp-contract=off', ...warnings];
      const files = (...names: string[]) => names.map((name) => `${folder}/${name}`);
      run(compiler, ...flags, '-c', ...files('cagecast.cpp'), '-o', ...files('cagecast.o'));

      const main = readFileSync('examples/native/main.cpp', 'utf8');
      writeFileSync(`${folder}/main.cpp`, main.replace('<cagecast/transfer.hpp>', '"cagecast.hpp"'));
      run(compiler, ...flags, ...files('main.cpp', 'cagecast.o'), '-o', ...files('main'));
      assert.match(run(`${folder}/main`), expected);

      const lane = ['tests/release/lanes/lane.cpp', 'tests/core/scenes/scenes.cpp', '-Icore/include', '-Itests/core'];
      run(compiler, ...flags, ...lane, ...files('cagecast.o'), '-o', ...files('lane'));
      const golden = ['hash', 'hash-default', 'hash-borders'].map((name) => `tests/core/golden/${name}.txt`);
      assert.equal(run(`${folder}/lane`).trim(), golden.map((file) => readFileSync(file, 'utf8').trim()).join(' '));
    });
});

describe('other languages, by the C interface', () => {
  const has = (program: string, ...args: string[]) => call(program, ...args).status === 0;
  const python = [process.env.PYTHON ?? 'python3', '/usr/bin/python3'].find((path) => has(path, '-c', 'import numpy'));

  /** What the commands of an example's README print in an empty folder, of which they get the sources and the programs from here. */
  function follow(example: string): string {
    mkdirSync(at(example));
    const commands = /```sh\n(.*?)```/s
      .exec(readFileSync(`examples/${example}/README.md`, 'utf8'))![1]!
      .replace(/^git clone .*$/m, `ln -s ${process.cwd()} cagecast`)
      .replace(/^sudo apt .*$/m, '')
      .replaceAll('python3', python ?? 'python3');
    const { status, stdout, stderr } = spawnSync('sh', ['-e', '-c', commands], { cwd: at(example), encoding: 'utf8' });
    assert.equal(status, 0, stdout + stderr);
    return stdout;
  }

  test('Python, with its standard library and with NumPy', { skip: python === undefined && 'needs NumPy' }, () => {
    assert.equal(follow('python'), '2618 of 4782 triangles may be painted\n');
    assert.equal(run(python!, 'tests/core/c/program.py', at('python/libcagecast.so')), '');
  });

  test('C#, as Unity calls it', { skip: !has('mcs', '--version') && 'needs Mono (mono-mcs)' }, () => {
    const lines = follow('unity').split('\n');
    assert.equal(lines[0], 'corner 0: u = 0.25, v = 0.25; triangles: 1 1');
    assert.equal(lines[1], 'options.threshold = 2 is not within 0..1');
  });
});
