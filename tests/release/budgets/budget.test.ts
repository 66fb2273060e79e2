import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { describe, test } from 'node:test';
import { checkInstructions, checkSizes } from '../../../bench/budget.js';

const lacks = (...commands: string[]): string | false =>
  commands.find((command) => spawnSync('sh', ['-c', `command -v ${command}`]).status !== 0) ?? false;
const skipWithout = (missing: string | false): string | false => missing && `${missing} is not installed`;

// On 64-bit ARM they are counted by `npm run bench -- --check`, which builds the core for it.
describe('budget', () => {
  for (const preset of ['paper', 'default'] as const) {
    test(`a transfer of the sample with the preset ${preset} takes no more x86-64 instructions than the budget allows`, {
      skip: process.arch === 'x64' ? skipWithout(lacks('valgrind')) : `this is ${process.arch}`,
    }, async () => {
      assert.equal(await checkInstructions('x86_64', preset), '');
    });
  }

  test('the gzipped package is within its budget', async () => {
    assert.equal(await checkSizes(), '');
  });
});
