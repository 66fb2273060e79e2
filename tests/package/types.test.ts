import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';

const kProjects = {
  'the package, the command and these tests': 'wasm',
  'the measurements': 'bench',
};
for (const [what, project] of Object.entries(kProjects)) {
  test(`${what}: all types are right`, () => {
    const { status, stdout } = spawnSync(process.execPath, ['node_modules/@typescript/native/bin/tsc', '-p', project], {
      encoding: 'utf8',
    });
    assert.equal(status, 0, stdout);
  });
}
