import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, test } from 'node:test';
import { validate } from '../../support/gltf.js';

const folder = mkdtempSync(join(tmpdir(), 'cagecast-examples-'));
const sample = 'examples/samples/lizard';
after(() => rmSync(folder, { recursive: true, force: true }));

function node(...args: string[]): string {
  const { status, stdout, stderr } = spawnSync(process.execPath, args, { encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return stdout;
}

describe('examples', () => {
  test('node/arrays.js prints where each vertex lies in the texture', () => {
    const lines = node('examples/node/arrays.js').trim().split('\n');
    assert.deepEqual(lines.slice(0, 2), [
      'vertex 0: u = 0.25, v = 0.25, may be painted',
      'vertex 1: u = 0.5, v = 0.25, may be painted',
    ]);
    assert.equal(lines.length, 4);
  });

  test('node/transfer.js writes a painted model', async () => {
    const out = join(folder, 'painted.glb');
    assert.match(
      node('examples/node/transfer.js', `${sample}/target.glb`, `${sample}/cage.glb`, `${sample}/paint-tiger.png`, out),
      /^\d+\.\d ms$/m,
    );
    assert.deepEqual(await validate(out), []);
  });
});
