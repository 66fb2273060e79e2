import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';

const list = 'core/include/cagecast/options.def';
const line =
  'CAGECAST_OPTION(project, extraReach, length, 0.5f, 0.25f, (0, 0.75f), "How far a new option reaches, for a test.")';

describe('an option is one line in options.def', () => {
  const folder = mkdtempSync(join(tmpdir(), 'cagecast-options-'));
  const read = (path: string) => readFileSync(join(folder, path), 'utf8');
  const generate = (...args: string[]) =>
    execFileSync(process.execPath, ['wasm/tools/generate.mjs', '--root', folder, ...args], { encoding: 'utf8' });
  after(() => rmSync(folder, { recursive: true, force: true }));

  before(() => {
    cpSync('core', join(folder, 'core'), { recursive: true });
    const lines = readFileSync(list, 'utf8').split('\n');
    lines.splice(
      lines.findIndex((one) => one.startsWith('CAGECAST_OPTION(')),
      0,
      line,
    );
    writeFileSync(join(folder, list), lines.join('\n'));
    generate();
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

  test('the command has a flag for it, with its text', () => {
    const [, flag] = /(\{[^{}]*name: 'extraReach'[^{}]*\})/.exec(read('wasm/src/generated/options.ts'))!;
    assert.match(flag!, /flag: '--extra-reach'/);
    assert.match(flag!, /range: \[0, 0\.75\],\s+standard: 0\.5,\s+paper: 0\.25,/);
    assert.match(flag!, /text: 'How far a new option reaches, for a test\.'/);
  });

  test('docs/options.md has it', () => {
    const page = read('docs/options.md');
    assert.match(page, /\| `extraReach` \| 0 to 0\.75, .* \| `0\.5` \| `0\.25` \| project \| How far a new option/);
    assert.match(page, /`--extra-reach`/);
  });

  test('C++ has the field and its defaults, checks its range, and says what is wrong', () => {
    const [source, program] = [join(folder, 'main.cpp'), join(folder, 'main')];
    writeFileSync(
      source,
      `#include <cstdio>
      #include "input/validate.hpp"
      int main() {
        using namespace cagecast;
        static_assert(TransferOptions{}.extraReach == 0.5f && TransferOptions::paper().extraReach == 0.25f);
        TransferOptions options;
        options.extraReach = 0.8f;
        const Status status = checkOptions(options);
        std::printf("%s: %s\\n", codeName(status.code), describe(status, {}, {}).c_str());
      }`,
    );
    const sources = [source, ...['options', 'describe'].map((name) => join(folder, `core/src/input/${name}.cpp`))];
    const folders = ['core/include', 'core/src'].map((path) => `-I${join(folder, path)}`);
    execFileSync(process.env['CXX'] ?? 'c++', ['-std=c++20', ...folders, ...sources, '-o', program], {
      stdio: ['ignore', 'ignore', 'inherit'],
    });
    assert.equal(
      execFileSync(program, { encoding: 'utf8' }).trim(),
      'badOption: options.extraReach = 0.8 is not within 0..0.75',
    );
  });
});
