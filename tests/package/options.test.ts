import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, readFileSync, writeFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { temporaryFolder } from '../support/temporary.js';

const list = 'core/include/cagecast/options.def';
const line =
  'CAGECAST_OPTION(project, extraReach, length, 0.5f, 0.25f, (0, 0.75f), "How far a new option reaches, for a test.")';

describe('an option is one line in options.def', () => {
  const { folder, at } = temporaryFolder('options');
  const read = (path: string) => readFileSync(at(path), 'utf8');

  before(() => {
    cpSync('core', at('core'), { recursive: true });
    const lines = readFileSync(list, 'utf8').split('\n');
    lines.splice(
      lines.findIndex((one) => one.startsWith('CAGECAST_OPTION(')),
      0,
      line,
    );
    writeFileSync(at(list), lines.join('\n'));
    execFileSync(process.execPath, ['wasm/tools/generate.mjs', '--root', folder]);
  });

  test('TypeScript has the option with its text, for the function that reads it', () => {
    const types = read('wasm/src/generated/options.ts');
    const [, stage] = /export interface ProjectStage \{([^}]*)\}/.exec(types)!;
    assert.match(
      stage!.replace(/\s*\n\s*\*?\s*/g, ' '),
      /How far a new option reaches, for a test\. 0 to 0\.75, as a share of the target's diagonal\. Default: `0\.5`; in the preset `paper`: `0\.25`\. \/? ?extraReach\?: number \| undefined;/,
    );
    assert.match(types, /extraReach: \{ stage: 'project', isStep: false, kind: 'length' \}/);
  });

  test('the command knows it, and its values', () => {
    const [, values] = /(\{[^{}]*name: 'extraReach'[^{}]*\})/.exec(read('wasm/src/generated/options.ts'))!;
    assert.match(values!, /range: \[0, 0\.75\],\s+standard: 0\.5,\s+paper: 0\.25,/);
    assert.match(values!, /text: 'How far a new option reaches, for a test\.'/);
  });

  test('docs/options.md has it', () => {
    const page = read('docs/options.md');
    assert.match(page, /\| `extraReach` \| 0 to 0\.75, .* \| `0\.5` \| `0\.25` \| project \| How far a new option/);
  });

  test('C++ has the field and its defaults', () => {
    // That its range is checked, and what is said then, tests/core/errors.test.cpp asks of every line.
    const program = `#include "cagecast/options.hpp"
      using cagecast::TransferOptions;
      static_assert(TransferOptions{}.extraReach == 0.5f && TransferOptions::paper().extraReach == 0.25f);`;
    writeFileSync(at('main.cpp'), program);
    const flags = ['-std=c++20', '-fsyntax-only', `-I${at('core/include')}`, at('main.cpp')];
    execFileSync(process.env['CXX'] ?? 'c++', flags, { stdio: ['ignore', 'ignore', 'inherit'] });
  });
});
