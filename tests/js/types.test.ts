import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';

test('the package, the command and these tests type-check, strictly', () => {
  const { status, stdout } = spawnSync(process.execPath, ['node_modules/typescript/bin/tsc', '-p', 'wasm/tsconfig.json'], { encoding: 'utf8' });
  assert.equal(status, 0, stdout);
});
