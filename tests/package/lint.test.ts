// The lint fails where it should. Each test gives it a small tree of files with one thing wrong in it.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import {
  appendFileSync,
  cpSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  rmSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';

const repository = fileURLToPath(new URL('../..', import.meta.url));
let folder: string;

before(() => {
  folder = mkdtempSync(join(tmpdir(), 'cagecast-lint-'));
});
after(() => rmSync(folder, { recursive: true, force: true }));

/** A Git work tree with these files. */
function treeOf(name: string, files: Record<string, string>): string {
  const root = join(folder, name);
  mkdirSync(root);
  spawnSync('git', ['init', '--quiet'], { cwd: root });
  for (const [path, text] of Object.entries(files)) {
    mkdirSync(dirname(join(root, path)), { recursive: true });
    writeFileSync(join(root, path), text);
  }
  for (const settings of ['.clang-format', 'biome.json'].filter((name) => existsSync(join(repository, name))))
    cpSync(join(repository, settings), join(root, settings));
  symlinkSync(join(repository, 'node_modules'), join(root, 'node_modules'));
  return root;
}

function lint(step: string, root: string): { passed: boolean; output: string } {
  const program = join(repository, 'wasm/tools/lint/run.mjs');
  const { status, stdout, stderr } = spawnSync(process.execPath, [program, step, '--root', root], { encoding: 'utf8' });
  return { passed: status === 0, output: stdout + stderr };
}

function assertFails(step: string, root: string, message: RegExp): void {
  const { passed, output } = lint(step, root);
  assert.ok(!passed, output);
  assert.match(output, message);
}

describe('lint', () => {
  const lower = { 'core/src/base/arena.hpp': '#pragma once\n', 'core/include/cagecast/mesh.hpp': '#pragma once\n' };

  test('lets includes and imports point down', () => {
    const root = treeOf('down', {
      ...lower,
      'core/src/steps/holes.cpp': '#include "base/arena.hpp"\n#include "cagecast/mesh.hpp"\n#include <vector>\n',
      'wasm/src/index.ts': "import { error } from './core/error.js';\n",
      'wasm/src/three/apply.ts': "import { CagecastError } from '../index.js';\n",
      'web/src/app.ts': "import { transfer } from 'cagecast';\nimport './view/viewer';\n",
      'web/src/view/viewer.ts': "import type { Session } from '../scene/session';\n",
      'core/cages/make/make.cpp': '#include "hull/hull.hpp"\n#include "base/arena.hpp"\n',
      'core/cages/hull/hull.hpp': '#pragma once\n',
      'tests/package/deep.test.ts': "import { blend } from '../../wasm/src/blend.js';\n",
    });
    const { passed, output } = lint('arrows', root);
    assert.ok(passed, output);
  });

  const upward: Record<string, [path: string, text: string]> = {
    'a lower folder of the core includes a higher one': ['core/src/base/list.hpp', '#include "steps/holes.hpp"\n'],
    'a step includes transfer.cpp’s header': ['core/src/steps/holes.cpp', '#include "transfer.hpp"\n'],
    'the core includes the bindings': ['core/src/clip/clip.cpp', '#include "../../../wasm/names.hpp"\n'],
    'a public header includes an inner one': ['core/include/cagecast/split.hpp', '#include "base/arena.hpp"\n'],
    'the bindings include an inner header': ['wasm/bindings.cpp', '#include "base/arena.hpp"\n'],
    'a file lies in a folder that has no place in the order': [
      'core/src/misc/other.cpp',
      '#include "base/arena.hpp"\n',
    ],
    'a lower folder of the cages includes a higher one': ['core/cages/hull/hull.cpp', '#include "make/wrap.hpp"\n'],
    'the package imports the page': ['wasm/src/index.ts', "import { Viewer } from '../../web/src/view/viewer.js';\n"],
    'a lower folder of the package imports a higher one': ['wasm/src/core/a.ts', "import { b } from '../api/b.js';\n"],
    'a folder below the package’s index imports it': ['wasm/src/api/a.ts', "import { b } from '../index.js';\n"],
    'the page imports the package by its path': ['web/src/app.ts', "import { run } from '../../wasm/src/index.js';\n"],
    'a lower folder of the page imports a higher one': ['web/src/scene/a.ts', "import type { B } from '../view/b';\n"],
    'a folder of the page imports a file above it': ['web/src/project/a.ts', "const app = await import('../app');\n"],
    'a folder of the page has no place in the order': ['web/src/misc/a.ts', "import { b } from '../platform/b';\n"],
    'the page loads the package by its path': ['web/src/app.ts', "const it = import('../../dist/index.js');\n"],
    'an example imports a test': ['examples/node/one.js', "import { glb } from '../../tests/support/glb.js';\n"],
  };
  for (const [what, [path, text]] of Object.entries(upward)) {
    test(`fails where ${what}`, () => {
      const higher = {
        'core/src/steps/holes.hpp': '#pragma once\n',
        'core/src/transfer.hpp': '#pragma once\n',
        'core/cages/make/wrap.hpp': '#pragma once\n',
        'wasm/names.hpp': '',
      };
      const root = treeOf(what.replace(/\W/g, '-'), { ...lower, ...higher, [path]: text });
      assertFails('arrows', root, new RegExp(`${path}:1: `));
    });
  }

  test('fails where a C++ file is not formatted', () => {
    const root = treeOf('cpp', { 'core/src/base/list.cpp': 'int  one( ){return 1 ;}\n' });
    assertFails('format', root, /core\/src\/base\/list\.cpp:1:/);
  });

  test('fails where a TypeScript file is not formatted', () => {
    const root = treeOf('ts', { 'wasm/src/one.ts': 'export const one = "1"\n' });
    assertFails('biome', root, /wasm\/src\/one\.ts/);
  });

  test('fails where a function has too many lines or parameters', () => {
    const lines = '  console.log(1);\n'.repeat(81);
    const root = treeOf('functions', {
      'wasm/src/long.ts': `export function long(): void {\n${lines}}\n`,
      'wasm/src/wide.ts':
        'export const wide = (a: 1, b: 1, c: 1, d: 1, e: 1, f: 1): number => a + b + c + d + e + f;\n',
    });
    assertFails('biome', root, /noExcessiveLinesPerFunction/);
    assertFails('biome', root, /useMaxParams/);
  });

  test('fails where a file has too many lines or a folder too many files', () => {
    const many = Object.fromEntries(Array.from({ length: 26 }, (_, i) => [`web/src/${i}.ts`, '']));
    const root = treeOf('limits', { ...many, 'core/src/base/list.cpp': '\n'.repeat(451) });
    assertFails('limits', root, /web\/src\/ has 26 files/);
    assertFails('limits', root, /list\.cpp has 451 lines/);
  });

  const pages: Record<string, [text: string, message: RegExp]> = {
    'links to a page that is not there': ['[gone](gone.md)\n', /links to gone\.md/],
    'links to a heading that is not there': ['# Here\n\n[there](#there)\n', /no such heading/],
    'names a file that is not there': ['See `core/src/steps/gone.cpp`.\n', /names core\/src\/steps\/gone\.cpp/],
    'uses a word that was given up': ['The rims of the cage.\n', /says "rims"; say boundary loop/],
    'is too long': ['\n'.repeat(151), /README\.md has 151 lines/],
  };
  for (const [what, [text, message]] of Object.entries(pages)) {
    test(`fails where the README ${what}`, () => {
      assertFails('docs', treeOf(what.replace(/\W/g, '-'), { 'README.md': text }), message);
    });
  }

  const generator = 'wasm/tools/generate.mjs';
  test('fails where a generated file is stale', {
    skip: !existsSync(join(repository, generator)) && 'no generator',
  }, () => {
    const root = treeOf('generated', {});
    const listed = spawnSync('git', ['ls-files', 'core/include', 'wasm', 'docs'], {
      cwd: repository,
      encoding: 'utf8',
    });
    for (const path of listed.stdout.split('\n').filter((file) => /\.(def|hpp|mjs|ts|md|json)$/.test(file)))
      cpSync(join(repository, path), join(root, path));
    const { passed, output } = lint('generated', root);
    assert.ok(passed, output);
    appendFileSync(join(root, 'wasm/src/generated/options.ts'), '// edited by hand\n');
    assertFails('generated', root, /options\.ts/);
  });
});
