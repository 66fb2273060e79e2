import assert from 'node:assert/strict';
import { test } from 'node:test';
import { begin, paintOf, quiet, refusal, sceneOf } from './harness';

test('of several requests the last one comes, and the first gives way at once', async () => {
  const page = await begin();
  page.loader.gate.hold();
  page.open('a.glb', 'cage.glb');
  page.open('b.glb');
  page.open('c.glb');
  page.loader.gate.open();
  await page.ready();
  assert.deepEqual(page.shown, ['c.glb', 'cage.glb', 'UV checker']);
  assert.deepEqual(page.transferer.asked, ['project default c.glb']);
  assert.deepEqual(page.said, ['transfer', 'zones', 'paint']);

  page.transferer.gate.hold();
  page.open('d.glb');
  await quiet();
  page.open('e.glb');
  page.transferer.gate.open();
  await page.ready();
  assert.equal(page.shown[0], 'e.glb');
});

test('files wait for each other, and those that are missing are named', async () => {
  const page = await begin();
  page.session.request({ target: page.load('a.glb') });
  await quiet();
  assert.equal(page.state, 'waiting');
  page.session.request({ cage: page.load('cage.glb', 4) });
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['a.glb', 'cage.glb']);
  page.session.swap();
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['cage.glb', 'a.glb']);
});

test('cancelling keeps what is shown, and its preset; what comes late is of no effect', async () => {
  const page = await begin();
  page.open('a.glb', 'cage.glb');
  await page.ready();
  page.transferer.gate.hold();
  page.session.setRules({ preset: 'paper' });
  page.open('b.glb');
  await quiet();
  page.said.length = 0;
  page.session.cancel();
  assert.equal(page.state, 'ready');
  page.transferer.gate.open();
  await quiet();
  assert.deepEqual([page.shown[0], page.session.rules.preset, page.said], ['a.glb', 'default', ['rules']]);
  page.session.setRules({ preset: 'paper' });
  await page.ready();
  assert.equal(page.session.shown!.projection.preset, 'paper');
  page.open('c.glb');
  await page.ready();
  assert.equal(page.shown[0], 'c.glb');
});

test('cancelling is too late once the model is shown: its paint comes with it', async () => {
  const page = await begin();
  page.open('a.glb', 'cage.glb');
  await page.ready();
  page.session.on('zones', () => page.session.cancel());
  page.session.request({ target: page.load('b.glb'), paint: Promise.resolve(paintOf('own.png')) });
  await page.ready();
  assert.deepEqual(page.shown, ['b.glb', 'cage.glb', 'own.png']);
});

test('of files that belong together none comes if one fails; a file that waits for one that failed is dropped by the next request', async () => {
  const page = await begin();
  page.open('a.glb', 'cage.glb');
  await page.ready();
  page.session.request({ target: page.load('broken.glb'), cage: page.load('other-cage.glb', 4) }, {}, true);
  assert.equal(await page.failed(), 'broken.glb: it is broken');
  page.session.swap();
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['cage.glb', 'a.glb']);
  page.session.swap();
  page.session.setRules({ preset: 'paper' });
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['a.glb', 'cage.glb']);

  page.session.request({ target: page.load('broken.glb'), cage: page.load('other-cage.glb', 4) });
  await page.failed();
  page.session.setRules({ preset: 'default' });
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['a.glb', 'cage.glb']);

  // What comes with another model is not for the one that is opened meanwhile.
  page.loader.gate.hold();
  page.session.request({ target: page.load('sample.glb'), cage: page.load('sample-cage.glb', 4) }, {}, true);
  page.open('own.glb');
  page.loader.gate.open();
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['own.glb', 'cage.glb']);
});

test('a transfer that fails names what is to blame, and what was accepted before stays', async () => {
  const page = await begin();
  page.open('a.glb', 'cage.glb');
  await page.ready();
  page.transferer.failure = refusal('target');
  page.open('bad.glb');
  assert.equal(await page.failed(), 'bad.glb: it does not fit');
  page.transferer.failure = refusal();
  page.open('bad.glb', 'worse.glb');
  assert.equal(await page.failed(), 'bad.glb with worse.glb: it does not fit');
  page.transferer.failure = new Error('the transfer could not be started');
  page.session.setRules({ preset: 'paper' });
  await page.failed();
  assert.equal(page.session.rules.preset, 'default');
  page.open('b.glb');
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['b.glb', 'cage.glb']);
});

test('choices are for the model that they were made for, as far as it has such parts; marks come back with it', async () => {
  const page = await begin();
  const first = page.load('a.glb');
  page.session.request({ target: first, cage: page.load('cage.glb', 4) }, { 0: 'exclude', 9: 'keep' });
  await page.ready();
  assert.deepEqual(page.session.locks, { 0: 'exclude' });
  assert.ok(page.session.classification!.zones.every((zone) => zone !== 0));
  page.session.request({ cage: page.load('other.glb', 5, 1) });
  await page.ready();
  assert.deepEqual(page.session.locks, { 0: 'exclude' });
  page.session.setLocks({});
  page.session.setBare(Uint8Array.of(1, 0, 0, 0));
  page.session.setBare(Uint8Array.of(1, 1)); // of another model
  assert.equal(
    page.session.classification!.cosmeticTriangles.reduce((sum, one) => sum + one, 0),
    3,
  );
  page.open('b.glb');
  await page.ready();
  assert.deepEqual([page.session.locks, page.session.bare], [{}, undefined]);
  page.session.request({ target: first });
  await page.ready();
  assert.deepEqual(page.session.bare, Uint8Array.of(1, 0, 0, 0));
});

test('the threshold takes effect without a transfer, and a paint without a classification', async () => {
  const page = await begin();
  page.open('a.glb', 'cage.glb');
  await page.ready();
  const { length } = page.transferer.asked;
  page.said.length = 0;
  page.session.setRules({ threshold: 1 });
  page.session.request({ paint: Promise.resolve(paintOf('own.png')) });
  await page.ready();
  assert.deepEqual(page.said, ['rules', 'zones', 'paint']);
  assert.equal(page.transferer.asked.length, length);
});

test('a sample’s paint does not lie on the cage of another; it stays on one with the same UVs', async () => {
  const page = await begin();
  const sample = { name: 'one', title: 'One', target: '', cage: '', paints: [] };
  const ofSample = async (name: string, size: number) => ({ ...(await page.load(name, size)), sample });
  const paint = Promise.resolve(paintOf('sample.png', sample));
  page.session.request({ target: ofSample('a.glb', 1), cage: ofSample('cage.glb', 4), paint });
  await page.ready();
  assert.equal(page.shown[2], 'sample.png');
  page.session.request({ cage: page.load('moved.glb', 5) });
  await page.ready();
  assert.equal(page.shown[2], 'sample.png');
  page.session.request({ cage: page.load('own.glb', 4, 1) });
  await page.ready();
  assert.equal(page.shown[2], 'UV checker');
});

test('what is not drawn is part of a cage alone; accessories stay bare until the user decides', async () => {
  const page = await begin();
  const file = sceneOf('figure.glb', { head: 1, '(outfit)': 2, StrawHat: 0.2, Head_InnerCage: 3 });
  page.session.request({ target: page.loader.load(file), cage: page.load('cage.glb', 4) });
  await page.ready();
  const { mesh } = page.session.shown!.target;
  assert.deepEqual(
    mesh.primitives.map(({ name }) => name),
    ['head', 'StrawHat'],
  );
  assert.deepEqual(mesh.leftOut, ['(outfit)', 'Head_InnerCage']);
  const fate = () => page.session.classification!.segmentStats[1]!.culledBy;
  assert.equal(fate(), 'lock');
  page.session.lock([1], 'keep');
  assert.notEqual(fate(), 'lock');
  // So does what the cage was made without.
  const head = () => page.session.classification!.segmentStats[0]!.culledBy;
  assert.notEqual(head(), 'lock');
  page.session.shown!.cage.mesh.bare.push('head');
  page.session.setLocks({});
  assert.equal(head(), 'lock');
  page.session.swap();
  await page.ready();
  assert.equal(page.session.shown!.cage.mesh.primitives.length, 4);
  page.session.swap();
  await page.ready();
  assert.equal(page.session.shown!.target.mesh.primitives.length, 2);
  page.session.request({ target: page.loader.load(sceneOf('hidden.glb', { '(outfit)': 1 })) });
  assert.match(await page.failed(), /^hidden\.glb: nothing of it is drawn but cages, markers and collision shapes;/);
});

test('a model that is opened alone brings its own cage, each of the part of its name', async () => {
  const page = await begin();
  page.open('a.glb', 'cage.glb');
  await page.ready();
  const figure = (cages: Record<string, number>) =>
    page.loader.load(sceneOf('figure.glb', { Head_Geo: 1, Hand_Geo: 0.5, ...cages }));
  page.session.request({ target: figure({ Head_OuterCage: 4, Hand_OuterCage: 3 }) });
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['figure.glb', 'figure.glb']);
  const { target, cage, projection } = page.session.shown!;
  const names = [target, cage].map(({ mesh }) => mesh.primitives.map(({ name }) => name));
  assert.deepEqual(names, [
    ['Head_Geo', 'Hand_Geo'],
    ['Head_OuterCage', 'Hand_OuterCage'],
  ]);
  // The smaller cage is the nearer one to both.
  assert.deepEqual(
    [...projection.triangles].map((t) => Math.floor(t / 4)),
    [0, 0, 0, 0, 1, 1, 1, 1],
  );
  page.session.request({ target: figure({ Head_OuterCage: 4, Foot_OuterCage: 3 }) });
  assert.match(await page.failed(), /"Hand_Geo" has no cage: none is named Hand_OuterCage/);
  page.open('b.glb', 'other.glb');
  await page.ready();
  page.session.request({ cage: figure({ Head_OuterCage: 4 }) });
  await page.ready();
  assert.deepEqual(page.shown.slice(0, 2), ['b.glb', 'figure.glb']);
});

test('work ends once: done, cancelled, superseded by other work or by a request', async () => {
  const page = await begin();
  page.open('a.glb', 'cage.glb');
  await page.ready();
  const ends: string[] = [];
  const work = (name: string) => page.session.work(name, 0, { abort: (why) => ends.push(`${name} ${why}`) });
  work('first')();
  assert.equal(page.state, 'ready');
  const late = work('second');
  work('third');
  late();
  assert.equal(page.state, 'working');
  page.session.cancel();
  work('fourth');
  page.open('b.glb');
  await page.ready();
  assert.deepEqual(ends, ['second superseded', 'third cancelled', 'fourth superseded']);
});

test('rules that are chosen while a cage is made wait for it, and go when it is cancelled', async () => {
  const page = await begin();
  page.open('a.glb', 'cage.glb');
  await page.ready();
  const making = { abort: () => {}, makesCage: true };
  const done = page.session.work('Making', 0, making);
  page.session.setRules({ preset: 'paper' });
  await quiet();
  assert.ok(page.session.isMakingCage);
  assert.equal(page.session.shown!.projection.preset, 'default');
  done();
  await page.ready();
  assert.equal(page.session.shown!.projection.preset, 'paper');

  for (const end of [() => page.session.cancel(), () => page.session.fail(new Error('no cage'))]) {
    page.session.work('Making', 0, making);
    page.session.setRules({ preset: 'default' });
    end();
    assert.equal(page.session.rules.preset, 'paper');
  }
});
