// The lint fails where it should. Each test gives it a small tree of files with things wrong in it.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { appendFileSync, cpSync, mkdirSync, symlinkSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { temporaryFolder } from '../support/temporary.js';

const repository = fileURLToPath(new URL('../..', import.meta.url));
const { at } = temporaryFolder('lint');

/** A Git work tree with these files. */
function treeOf(name: string, files: Record<string, string>): string {
  const root = at(name);
  mkdirSync(root);
  spawnSync('git', ['init', '--quiet'], { cwd: root });
  for (const [path, text] of Object.entries(files)) {
    mkdirSync(dirname(join(root, path)), { recursive: true });
    writeFileSync(join(root, path), text);
  }
  for (const settings of ['.clang-format', 'biome.json']) cpSync(join(repository, settings), join(root, settings));
  symlinkSync(join(repository, 'node_modules'), join(root, 'node_modules'));
  return root;
}

/** Runs a step. @returns what it says is wrong; nothing if it passes. */
function faultsIn(step: string, root: string): string {
  const program = join(repository, 'wasm/tools/lint/run.mjs');
  const { status, stdout, stderr } = spawnSync(process.execPath, [program, step, '--root', root], { encoding: 'utf8' });
  assert.equal(status === 0, /^lint \w+ +ok/m.test(stdout), stdout + stderr);
  return status === 0 ? '' : stdout + stderr;
}

const lower = {
  'core/src/base/arena.hpp': '#pragma once\n',
  'core/include/cagecast/mesh.hpp': '#pragma once\n',
  'core/src/steps/holes.hpp': '#pragma once\n',
  'core/src/transfer.hpp': '#pragma once\n',
  'core/cages/make/wrap.hpp': '#pragma once\n',
  'core/cages/hull/hull.hpp': '#pragma once\n',
  'wasm/names.hpp': '',
};

test('includes and imports point down', () => {
  const root = treeOf('down', {
    ...lower,
    'core/src/steps/holes.cpp': '#include "base/arena.hpp"\n#include "cagecast/mesh.hpp"\n#include <vector>\n',
    'wasm/src/index.ts': "import { error } from './core/error.js';\n",
    'wasm/src/three/apply.ts': "import { CagecastError } from '../index.js';\n",
    'web/src/app.ts': "import { transfer } from 'cagecast';\nimport './view/viewer';\n",
    'web/src/view/viewer.ts': "import type { Store } from '../platform/store';\n",
    'core/cages/make/make.cpp': '#include "hull/hull.hpp"\n#include "base/arena.hpp"\n',
    'tests/package/deep.test.ts': "import { blend } from '../../wasm/src/blend.js';\n",
  });
  assert.equal(faultsIn('arrows', root), '');
});

test('none points up: each that does is named', () => {
  const upward: Record<string, [path: string, text: string]> = {
    'a lower folder of the core includes a higher one': ['core/src/base/list.hpp', '#include "steps/holes.hpp"\n'],
    'a step includes transfer.cpp’s header': ['core/src/steps/holes.cpp', '#include "transfer.hpp"\n'],
    'the core includes the bindings': ['core/src/clip/clip.cpp', '#include "../../../wasm/names.hpp"\n'],
    'a public header includes an inner one': ['core/include/cagecast/split.hpp', '#include "base/arena.hpp"\n'],
    'the bindings include an inner header': ['wasm/bindings.cpp', '#include "base/arena.hpp"\n'],
    'a folder of the core has no place in the order': ['core/src/misc/a.cpp', '#include "base/arena.hpp"\n'],
    'a lower folder of the cages includes a higher one': ['core/cages/hull/hull.cpp', '#include "make/wrap.hpp"\n'],
    'the package imports the page': ['wasm/src/index.ts', "import { Viewer } from '../../web/src/view/viewer.js';\n"],
    'a lower folder of the package imports a higher one': ['wasm/src/core/a.ts', "import { b } from '../api/b.js';\n"],
    'a folder below the package’s index imports it': ['wasm/src/api/a.ts', "import { b } from '../index.js';\n"],
    'the page imports the package by its path': ['web/src/app.ts', "import { run } from '../../wasm/src/index.js';\n"],
    'a lower folder of the page imports a higher one': [
      'web/src/platform/a.ts',
      "import type { B } from '../view/b';\n",
    ],
    'a folder of the page imports a file above it': ['web/src/panels/a.ts', "const app = await import('../app');\n"],
    'a folder of the page has no place in the order': ['web/src/misc/a.ts', "import { b } from '../platform/b';\n"],
    'the state of the page uses the browser': ['web/src/state/a.ts', 'document.title = location.hash;\n'],
    'the page loads the package by its path': ['web/src/late.ts', "const it = import('../../dist/index.js');\n"],
    'an example imports a test': ['examples/node/one.js', "import { glb } from '../../tests/support/glb.js';\n"],
  };
  const found = faultsIn('arrows', treeOf('up', { ...lower, ...Object.fromEntries(Object.values(upward)) }));
  for (const [what, [path]] of Object.entries(upward)) assert.ok(found.includes(`${path}:1: `), `${what}\n${found}`);
});

test('files are formatted, functions short, folders small', () => {
  const root = treeOf('forms', {
    ...Object.fromEntries(Array.from({ length: 26 }, (_, i) => [`web/src/${i}.ts`, ''])),
    'core/src/base/one.cpp': 'int  one( ){return 1 ;}\n',
    'core/src/base/list.cpp': '\n'.repeat(451),
    'wasm/src/one.ts': 'export const one = "1"\n',
    'wasm/src/long.ts': `export function long(): void {\n${'  console.log(1);\n'.repeat(81)}}\n`,
    'wasm/src/wide.ts': 'export const wide = (a: 1, b: 1, c: 1, d: 1, e: 1, f: 1): number => a + b + c + d + e + f;\n',
  });
  const faults = { format: faultsIn('format', root), biome: faultsIn('biome', root), limits: faultsIn('limits', root) };
  assert.match(faults.format, /core\/src\/base\/one\.cpp:1:/);
  for (const fault of [/wasm\/src\/one\.ts/, /noExcessiveLinesPerFunction/, /useMaxParams/])
    assert.match(faults.biome, fault);
  for (const fault of [/web\/src\/ has 26 files/, /list\.cpp has 451 lines/]) assert.match(faults.limits, fault);
});

test('no pattern repeats what repeats itself', () => {
  const bad = ['/(a+)*/', '/^(\\s*(#[^\\n]*|v [^\\n]*))*x/', "new RegExp('(?:x|[)]y{2,})+')"];
  const good = ['/(a{2})*/', '/([*+])+/', '/(\\(+)?/', '/(?<=x+)y*/', "new RegExp('a+b+')"];
  const faults = faultsIn(
    'patterns',
    treeOf('patterns', {
      'wasm/src/bad.ts': `export const all = [\n${bad.join(',\n')},\n];\n`,
      'web/src/good.ts': `export const all = [${good}];\n`,
      'examples/page.js': 'export const one = /(.*,)*/;\n',
    }),
  );
  for (const [line, pattern] of bad.entries()) assert.ok(faults.includes(`wasm/src/bad.ts:${line + 2} `), pattern);
  assert.match(faults, /examples\/page\.js:1 /);
  assert.doesNotMatch(faults, /good/);
});

test('pages name and link to what is there, in the words of the project', () => {
  const text = '# Here\n[gone](gone.md)\n[there](#there)\nSee `core/src/steps/gone.cpp`.\nThe rims of the cage.\n';
  const found = faultsIn('docs', treeOf('pages', { 'README.md': text + '\n'.repeat(151) }));
  for (const fault of [
    /links to gone\.md/,
    /no such heading/,
    /names core\/src\/steps\/gone\.cpp/,
    /says "rims"; say boundary loop/,
    /README\.md has \d+ lines/,
  ])
    assert.match(found, fault);
});

test('workflows and examples take from elsewhere what they name by its content', () => {
  const [commit, digest] = ['0'.repeat(40), `sha256:${'0'.repeat(64)}`];
  const good = {
    '.github/workflows/good.yml': `uses: ./.github/workflows/ci.yml\nuses: a/b@${commit} # v1\ncontainer: debian:12@${digest}\n`,
    'examples/catalogue/deploy/good.yaml': `image: redis:7@${digest}\n- image: catalogue\n# image: redis:7\n`,
    'examples/Dockerfile': `FROM --platform=linux/amd64 node:22@${digest} AS base\n`,
  };
  assert.equal(faultsIn('pins', treeOf('pinned', good)), '');
  const bad = {
    '.github/workflows/bad.yml':
      'uses: a/b@v1\n- uses: a/b@main\ncontainer: debian:12\ncontainer: { image: debian:12 }\nrun: git clone https://a/b\n',
    'examples/a/compose.yaml': `image: redis:7-bookworm\nimage: redis@sha256:abc\n`,
    'examples/a/Dockerfile': 'FROM node:22\n',
    'examples/a/get.sh': 'git clone --branch v1 https://a/b\n',
  };
  const found = faultsIn('pins', treeOf('floating', bad));
  for (const [path, text] of Object.entries(bad))
    for (const i of text.trimEnd().split('\n').keys()) assert.ok(found.includes(`${path}:${i + 1}: `), found);
});

test('generated files are fresh', () => {
  const root = treeOf('generated', {});
  const listed = spawnSync('git', ['ls-files', 'core/include', 'wasm', 'docs'], { cwd: repository, encoding: 'utf8' });
  for (const path of listed.stdout.split('\n').filter((file) => /\.(def|hpp|mjs|ts|md|json)$/.test(file)))
    cpSync(join(repository, path), join(root, path));
  assert.equal(faultsIn('generated', root), '');
  appendFileSync(join(root, 'wasm/src/generated/options.ts'), '// edited by hand\n');
  assert.match(faultsIn('generated', root), /options\.ts/);
});

test('the project weighs no more than its budget says', () => {
  const flag = (name: string) => `| \`--${name}\` | It is a flag. |\n`;
  const tree = {
    'package.json': JSON.stringify({
      exports: { '.': { types: './dist/index.d.ts', default: './dist/index.js' }, './x': { default: './dist/x.wasm' } },
    }),
    'wasm/src/index.ts': "// A comment.\n\nexport const a = 1;\nexport { b, type C } from './b.js';\n",
    'docs/cli.md': `## cagecast batch\n\n${flag('own')}\nAlso: [what is shared](#what-is-shared).\n\n## What is shared\n\n${flag('other')}`,
  };
  const counts = { 'lines of code': 2, 'exported values': 2, 'flags of batch': 2, 'entries of the package': 1 };
  const faultsWith = (scale: Record<string, number>, name: string): string =>
    faultsIn('scale', treeOf(name, { ...tree, 'bench/budget.json': JSON.stringify({ scale }) }));
  assert.equal(faultsWith(counts, 'as heavy'), '');
  for (const [name, count] of Object.entries(counts))
    assert.match(
      faultsWith({ ...counts, [name]: count - 1 }, `${name}, heavier`),
      new RegExp(`  ${name}: ${count}, more`),
    );
});
