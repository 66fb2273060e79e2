// The choice of a cage for a model that came alone, and its reasons.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { init, inspect } from 'cagecast';
import { type CageModel, cageGlb, chooseCage, terminate as endCages, loadTemplate } from 'cagecast/cages';
import { cageModel, paintGlb } from 'cagecast/gltf';
import { terminate as endWorker } from 'cagecast/worker';
import { ok, run } from '../../support/command.js';
import { glbOf } from '../../support/gltf.js';
import { ball } from '../scenes.js';
import { inRepository, png, workplace, write } from './workplace.js';

workplace('choose');
const human = inRepository('examples/samples/human/target.glb');
const texture = png(200);
const read = (name: string) => readFileSync(name);

after(() => {
  endWorker();
  endCages();
});

describe('the cage of a model that came alone', () => {
  let head: CageModel;
  before(async () => {
    await init();
    head = await cageModel(await new NodeIO().read(human));
  });
  test('is a template that fits, with the verdict that inspect gives', async () => {
    const { template, cage, fit, verdict, findings, tried } = await chooseCage(head);
    assert.deepEqual([template, verdict], ['human-head', 'good']);
    assert.deepEqual(tried, [{ template: 'human-head', verdict: 'good', reason: '' }]);
    assert.equal(fit!.cage, cage);
    assert.deepEqual(inspect(cage, head, { landmarks: cage.landmarks }).findings, findings);
  });

  test('is made where no template fits, and has landmarks; what was tried says why', async () => {
    const lump = ball([0, 0, 0], () => 1, 16, 32);
    const { template, cage, fit, tried } = await chooseCage(lump);
    assert.deepEqual([template, fit], ['made', undefined]);
    assert.deepEqual(
      tried.map((one) => one.template),
      ['human-head', 'made'],
    );
    assert.match(tried[0]!.reason, /^too little was found to fit it by; give eye_centre_left, /);
    assert.ok(cage.indices.length > 0);
    assert.equal((await chooseCage(head, { templates: [] })).template, 'made');
  });

  test('is not a template whose holes lie where nothing is, if another cage is no worse', async () => {
    const { landmarks } = (await chooseCage(head)).cage;
    const onForehead = ['eye_centre_left', 'eye_centre_right'].map((name) => {
      const [x, y, z] = landmarks[name]!;
      return [name, [x, y + 0.15 * (landmarks['forehead']![1] - landmarks['chin']![1]), z] as const] as const;
    });
    const { template, tried } = await chooseCage(head, { landmarks: Object.fromEntries(onForehead) });
    assert.equal(template, 'made');
    assert.deepEqual(
      tried.map(({ verdict }) => verdict),
      ['usable', 'usable'],
    );
    assert.match(tried[0]!.reason, /^2 holes of the cage have only "skin" behind them/);
  });

  test('is the same on this thread; progress never falls, and a signal ends it', async () => {
    const shares: number[] = [];
    const here = await chooseCage(head, { worker: false, onProgress: (share) => void shares.push(share) });
    assert.deepEqual(here.cage, (await chooseCage(head)).cage);
    assert.deepEqual(
      shares,
      [...shares].sort((a, b) => a - b),
    );
    assert.equal(shares.at(-1), 1);
    await assert.rejects(chooseCage(head, { signal: AbortSignal.abort(new Error('stop')) }), /^Error: stop$/);
  });
});

test('a figure that the template of bodies does not fit gets a cage of its own, not that of a head', async () => {
  const tried = async (part: string, joints: ReturnType<typeof jointOf>[] = []) => {
    const shape = ball([0, 0, 0], () => 1, 8, 16);
    const groups = new Uint32Array(shape.positions.length / 3);
    const model = { ...shape, groups, names: ['body', part], joints };
    return (await chooseCage(model)).tried.map(({ template }) => template);
  };
  assert.deepEqual(await tried('wheel'), ['car', 'human-head', 'made']);
  const names = ['upperarm_l', 'lowerleg_l'];
  assert.deepEqual(
    await tried(
      'hips',
      names.map((name) => jointOf(name)),
    ),
    ['human-body', 'made'],
  );
  // A bust on the skeleton of a whole figure.
  assert.deepEqual(
    await tried(
      'bust',
      names.map((name) => jointOf(name, -1.2)),
    ),
    ['human-head', 'made'],
  );
});

const jointOf = (name: string, y = 0) => ({ name, position: [0, y, 0] as const });

test('paintGlb asks for the paint of what was chosen, tells the verdict, and refuses one that is worse than demanded', async () => {
  const asked: string[] = [];
  const paintFor = (name: string) => {
    asked.push(name);
    return texture;
  };
  const options = { template: 'auto', texture: paintFor } as const;
  const { template, verdict, cage, tried } = await paintGlb(new Uint8Array(readFileSync(human)), options);
  assert.deepEqual([asked, template, verdict, tried!.length], [['human-head'], 'human-head', 'good', 1]);
  assert.ok(cage!.landmarks['nose_tip']);
  const small = { ...(await loadTemplate('human-head')) };
  small.positions = small.positions.map((x) => x / 2);
  const around = { cage: cageGlb(small), texture };
  assert.equal((await paintGlb(new Uint8Array(readFileSync(human)), around)).verdict, 'unfit');
  await assert.rejects(paintGlb(new Uint8Array(readFileSync(human)), { ...around, atLeast: 'usable' }), {
    code: 'badModel',
    message: /^paintGlb: the cage is unfit, not usable: /,
  });
});

test('transfer, inspect, bake, fit and batch take templates, and a texture for each', async () => {
  write('human.glb', readFileSync(human));
  const lump = ball([0, 0, 0], () => 1, 16, 32);
  write('lump.glb', glbOf(lump));
  for (const name of ['human-head', 'made']) write(`${name}.png`, texture);
  const summary = await ok('transfer human.glb --template auto --texture {template}.png -o out.glb --report r.json');
  assert.match(summary, /^the template human-head was fitted\nthe cage is good$/m);
  const report = JSON.parse(String(read('r.json')));
  assert.deepEqual([report.verdict, report.cage.template, report.cage.tried.length], ['good', 'human-head', 1]);
  await ok('fit human.glb --template auto -o auto.glb');
  await ok('fit human.glb --template human-head -o named.glb');
  assert.deepEqual(read('auto.glb'), read('named.glb'));
  await ok('transfer human.glb --cage named.glb --texture human-head.png -o same.glb');
  const images = (name: string) => Buffer.compare(read('same.glb'), read(name));
  assert.equal(images('out.glb'), 0);
  assert.match(
    await ok('inspect lump.glb --template auto'),
    /^a cage was made for this model\n {2}human-head: too little was found/m,
  );
  assert.match(
    await ok('bake human.glb --template human-head --texture {template}.png -o paint.png'),
    /^the template human-head was fitted\nthe cage is good\nwrote paint\.png/m,
  );
  const { stdout } = await run('batch human.glb lump.glb --template auto --texture {template}.png -o {name}-out.glb');
  const lines = stdout
    .trim()
    .split('\n')
    .map((line) => JSON.parse(line));
  assert.deepEqual(lines.map(({ target, status, template }) => [target, status, template]).sort(), [
    ['human.glb', 'done', 'human-head'],
    ['lump.glb', 'done', 'made'],
  ]);
  for (const { verdict } of lines) assert.match(verdict, /^(good|usable|unfit)$/);
  const wrong = await run('transfer human.glb --cage named.glb --texture {template}.png -o out.glb');
  assert.deepEqual(
    [wrong.status, wrong.stderr],
    [1, 'cagecast: {template}.png: {template} stands for what --template comes to; give that, or a file\n'],
  );
  await assertUsage('transfer human.glb --cage same.glb --template auto', /give either --cage or --template/);
});

async function assertUsage(line: string, message: RegExp): Promise<void> {
  const { status, stderr } = await run(line);
  assert.equal(status, 2);
  assert.match(stderr, message);
}
