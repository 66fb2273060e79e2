// The example of an edge function, in the program that edge functions of Cloudflare run in.
import assert from 'node:assert/strict';
import { type ChildProcess, spawn } from 'node:child_process';
import { once } from 'node:events';
import { cpSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { validate } from '../../support/gltf.js';
import { hostTools, installPacked, linkPackages, run } from './install.js';

const user = installPacked();
const samples = resolve('examples/samples');
let server: ChildProcess;
let address = '';

before(async () => {
  // What its README installs and copies.
  const readme = readFileSync('examples/edge/README.md', 'utf8');
  const pinned = JSON.parse(readFileSync('tests/release/hosts/package.json', 'utf8')).devDependencies.miniflare;
  assert.ok(readme.includes(`miniflare@${pinned}`), pinned);
  linkPackages(user, ['esbuild']);
  linkPackages(user, ['miniflare'], hostTools);
  const [target, around] = ['target', 'cage'].map((name) => join(samples, `lizard/${name}.glb`));
  const args = ['transfer', target!, '--cage', around!, '--compress', 'meshopt', '-o', 'compressed.glb', '--quiet'];
  run(process.execPath, [join(user, 'node_modules/cagecast/dist/cli.js'), ...args], user);
  for (const name of ['edge.js', 'serve.js']) cpSync(`examples/edge/${name}`, join(user, name));
  server = spawn(process.execPath, ['serve.js'], { cwd: user, env: { ...process.env, PORT: '0' } });
  let said = '';
  server.stderr!.on('data', (chunk) => (said += chunk));
  const [chunk] = await Promise.race([once(server.stdout!, 'data'), once(server, 'exit')]);
  address = String(chunk).trim();
  assert.match(address, /^http:/, said);
});
after(() => {
  server.kill();
  rmSync(user, { recursive: true, force: true });
});

async function painted(files: Record<string, Uint8Array>): Promise<Response> {
  const form = new FormData();
  for (const [name, bytes] of Object.entries(files)) form.set(name, new Blob([Uint8Array.from(bytes)]), name);
  return fetch(address, { method: 'POST', body: form });
}

const sample = (name: string): Uint8Array => readFileSync(join(samples, name));

async function assertPainted(response: Response): Promise<void> {
  const bytes = new Uint8Array(await response.arrayBuffer());
  assert.equal(response.status, 200, new TextDecoder().decode(bytes.subarray(0, 300)));
  assert.equal(response.headers.get('x-verdict'), 'good');
  const path = join(user, 'painted.glb');
  writeFileSync(path, bytes);
  assert.deepEqual(await validate(path), []);
}

describe('an edge function', () => {
  test('paints a model with its cage', async () => {
    const [model, cage, paint] = ['target.glb', 'cage.glb', 'paint-tiger.png'].map((name) => sample(`lizard/${name}`));
    await assertPainted(await painted({ model: model!, cage: cage!, paint: paint! }));
  });

  test('fits a template to a head', async () => {
    const [model, paint] = ['target.glb', 'paint-skull.png'].map((name) => sample(`human/${name}`));
    await assertPainted(await painted({ model: model!, paint: paint! }));
  });

  test('says what it cannot read there', async () => {
    const [cage, paint] = ['cage.glb', 'paint-tiger.png'].map((name) => sample(`lizard/${name}`));
    const compressed = readFileSync(join(user, 'compressed.glb'));
    const response = await painted({ model: compressed, cage: cage!, paint: paint! });
    assert.equal(response.status, 400);
    assert.match(await response.text(), /WebAssembly of meshopt.*decoders/);
  });
});
