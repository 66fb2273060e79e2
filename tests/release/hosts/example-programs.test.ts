import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, describe, test } from 'node:test';
import { validate } from '../../support/gltf.js';
import { installPacked, run } from './install.js';

const folder = mkdtempSync(join(tmpdir(), 'cagecast-examples-'));
const sample = 'examples/samples/lizard';
after(() => rmSync(folder, { recursive: true, force: true }));

const node = (...args: string[]): string => nodeIn('.', ...args);

function nodeIn(cwd: string, ...args: string[]): string {
  const { status, stdout, stderr } = spawnSync(process.execPath, args, { cwd, encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return stdout;
}

const blocks = (page: string, kind: string): string[] =>
  [...readFileSync(page, 'utf8').matchAll(new RegExp(`\`\`\`${kind}\n([^]*?)\`\`\``, 'g'))].map(([, text]) => text!);

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

  test('node/README.md paints one texture on many faces, with the packed package, in an empty folder', async () => {
    const user = installPacked();
    try {
      const lines = blocks('examples/node/README.md', 'sh')[0]!.trim().split('\n');
      const [, install, ...others] = lines;
      assert.deepEqual([lines[0], install], ['npm init -y', 'npm install path/to/cagecast/cagecast-0.1.0.tgz']);
      for (const line of others) run('sh', ['-c', line.replaceAll('path/to/cagecast', resolve('.'))], user);
      const results = readFileSync(join(user, 'results.jsonl'), 'utf8').trim().split('\n');
      const verdicts = results.map((line) => JSON.parse(line)).map(({ target, verdict }) => [target, verdict]);
      const names = ['avatar', 'body', 'human'];
      assert.deepEqual(
        verdicts.sort(),
        names.map((name) => [`faces/${name}.glb`, 'good']),
      );
      for (const name of names) {
        assert.deepEqual(await validate(join(user, `painted/${name}.glb`)), []);
        assert.equal(readFileSync(join(user, `pictures/${name}.png`)).toString('latin1', 1, 4), 'PNG');
      }
    } finally {
      rmSync(user, { recursive: true, force: true });
    }
  });
});

describe('the quick start', () => {
  test('of docs/three.md is the example three', () => {
    assert.equal(blocks('docs/three.md', 'js')[0], readFileSync('examples/three/main.js', 'utf8'));
  });

  test('of docs/tooling.md inspects, paints and draws a sample, by the command and in code', async () => {
    const user = join(folder, 'tooling');
    mkdirSync(join(user, 'node_modules'), { recursive: true });
    symlinkSync(resolve('.'), join(user, 'node_modules/cagecast'));
    for (const file of ['target.glb', 'cage.glb', 'paint-tiger.png']) cpSync(join(sample, file), join(user, file));
    const commands = [...blocks('docs/tooling.md', 'sh')[0]!.matchAll(/^npx cagecast ([^#\n]*)/gm)];
    assert.equal(commands.length, 3);
    for (const [, line] of commands) nodeIn(user, resolve('dist/cli.js'), ...line!.trim().split(/\s+/));
    assert.deepEqual(await validate(join(user, 'painted.glb')), []);
    assert.equal(readFileSync(join(user, 'painted.png')).toString('latin1', 1, 4), 'PNG');

    writeFileSync(join(user, 'paint.mjs'), blocks('docs/tooling.md', 'js')[0]!);
    nodeIn(user, 'paint.mjs');
    assert.deepEqual(await validate(join(user, 'painted-by-code.glb')), []);
  });
});
