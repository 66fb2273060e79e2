import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Cage } from 'cagecast/cages';
import { Edits, History, LayerStack, maxLayers } from '#three';
import { CageMaker, type Engine } from '../../../web/src/state/cage-maker';
import { followPaints } from '../../../web/src/state/follow-paints';
import { type Fitting, madeOf, sampleOf } from '../../../web/src/state/made-cages';
import { landmarksOf } from '../../../web/src/state/model';
import { PutAwayLayers } from '../../../web/src/state/put-away-layers';
import { remedyFor } from '../../../web/src/state/verdict/verdict';
import { tetrahedron } from '../../support/glb';
import { begin, cageGlb, Gate, paintOf, quiet, until } from './harness';

/** A maker of cages beside a session of `a.glb`. Each cage it makes has UVs of its own; those it moves keep theirs. */
async function workshop() {
  const page = await begin();
  const gate = new Gate();
  const said: string[] = [];
  let count = 10;
  const box = (): Cage => {
    const { uvs, ...mesh } = tetrahedron(1.5);
    return { ...mesh, indices: new Uint32Array(mesh.indices), uvs: uvs.map((uv) => uv / ++count) } as never;
  };
  const state = { found: 6, moves: true, marks: undefined as Uint8Array | undefined };
  const points = (n: number) => Object.fromEntries([...'abcdef'].slice(0, n).map((name) => [name, [0, 0, 0] as const]));
  const engine = {
    cageGlb,
    loadTemplate: async () => ({ landmarks: points(6) }),
    async chooseCage({ marks }: { marks?: Uint8Array }) {
      state.marks = marks;
      return { cage: box(), template: 'made', fit: undefined };
    },
    makeCage: async (_: object, { signal }: { signal: AbortSignal }) =>
      gate.wait(signal).then(() => ({ ...box(), landmarks: points(2) })),
    refineCage: async (cage: Cage) => ({ ...cage, positions: cage.positions.map((x) => (state.moves ? x * 1.1 : x)) }),
    async fitCage(_: object, __: object, given: object, { signal }: { signal: AbortSignal }) {
      await gate.wait(signal);
      const used = { ...points(state.found), ...given };
      const guessed = Object.keys(used).length < 4 ? Object.keys(points(6)).filter((name) => !(name in used)) : [];
      return {
        cage: { ...box(), landmarks: used },
        used,
        confidence: {},
        missing: ['nose_tip', 'ear_lobe_left'],
        guessed,
      };
    },
  } as unknown as Engine;
  const { session, loader } = page;
  const maker = new CageMaker({ session, loader, engine: async () => engine, announce: (text) => said.push(text) });
  const notes = { note: '', missing: '' };
  maker.on('notes', (change) => Object.assign(notes, change));
  let fitting: Fitting | undefined;
  maker.on('fitting', (one) => (fitting = one));
  page.open('a.glb', 'cage.glb');
  await page.ready();
  return {
    ...page,
    get shown() {
      return page.shown;
    },
    get state() {
      return page.state;
    },
    maker,
    gate,
    notes,
    announced: said,
    engine: state,
    get fitting() {
      return fitting;
    },
  };
}

test('a cage is made for the model, fitted to it, moved, and turned; the page knows how it came about', async () => {
  const page = await workshop();
  const { maker, session } = page;
  const file = () => session.shown!.cage.files[0]!;
  await maker.make();
  await page.ready();
  assert.deepEqual([page.shown[1], maker.isMade, maker.isFresh], ['a-cage.glb', true, true]);
  assert.match(page.notes.note, /^A cage of 4 triangles was made\. Save it/);
  const known = () => Object.keys(landmarksOf(session.shown!.cage)).join('');
  assert.equal(known(), 'ab', 'the verdict is of a face that was looked for');
  const remedy = (code: string) =>
    remedyFor({ code } as never, { inward: { share: 0, triangles: [] } }, session, maker);
  assert.equal(remedy('faceSeam')!.title, 'Fit a template');
  await maker.flip([1]);
  await page.ready();
  assert.deepEqual([...session.shown!.cage.mesh.indices.subarray(3, 6)], [0, 3, 1]);
  assert.deepEqual([page.shown[1], maker.isMade, maker.isFresh], ['a-cage.glb', true, false]);
  assert.equal(remedy('cageTooFar')!.title, 'Move the cage');
  page.engine.moves = false;
  await maker.move();
  assert.match(await page.failed(), /^a\.glb: the cage a-cage\.glb cannot be moved into place/);
  assert.ok(maker.refusedToMove);
  page.engine.moves = true;
  await maker.move();
  await page.ready();
  assert.equal(page.notes.note, 'The cage was moved into place. Save it if it is right.');
  await maker.fit('human-head', { a: [1, 2, 3] });
  await page.ready();
  const { fitting } = madeOf(file())!;
  assert.deepEqual([fitting!.given, fitting!.template, fitting], [{ a: [1, 2, 3] }, 'human-head', page.fitting]);
  assert.deepEqual(
    [maker.isMade, known(), remedy('faceSeam'), remedy('cageTooFar')],
    [false, 'abcdef', undefined, undefined],
  );
  session.reportInspection({ verdict: 'usable', findings: [] } as never);
  assert.equal(page.notes.missing, 'Landmarks that were not found: nose tip, left ear lobe.');
  const changed = await maker.change({ positions: session.shown!.cage.mesh.positions.map((x) => 2 * x) });
  await page.ready();
  assert.equal(session.shown!.cage, changed);
  assert.equal(madeOf(file())!.fitting, fitting);
  page.open('b.glb');
  await page.ready();
  assert.deepEqual([maker.isOthers, page.fitting], [true, undefined]);
});

test('a cage that faces the other way is turned, once', async () => {
  const { session, ready, notes } = await workshop();
  const { cage } = session.shown!;
  const find = () => session.reportInspection({ verdict: 'unfit', findings: [{ code: 'cageBackward' }] } as never);
  find();
  assert.ok(session.isMakingCage, 'at once, so that nothing is said of it before');
  await ready();
  const turned = session.shown!.cage.mesh.positions;
  assert.deepEqual(
    [...turned],
    [...cage.mesh.positions].map((x, i) => (i % 3 === 1 ? x : 0 - x)),
  );
  assert.match(notes.note, /^The cage faced the other way, so it was turned by half\./);
  session.request({ cage: Promise.resolve(cage) });
  await ready();
  find();
  await ready();
  assert.equal(session.shown!.cage, cage);
});

test('a cage that was made for one model never reaches another that is loading, or that waits for its own cage', async () => {
  for (const work of ['make', 'fit', 'move'] as const) {
    const page = await workshop();
    const begin = () => (work === 'fit' ? page.maker.fit('car') : page.maker[work]());
    page.loader.gate.hold();
    page.session.request({ target: page.load('car.glb'), cage: page.load('car-cage.glb', 4) }, {}, true);
    await begin();
    assert.deepEqual(page.announced, ['Another model is being loaded.'], work);
    page.loader.gate.open();
    await page.ready();
    assert.deepEqual(page.shown.slice(0, 2), ['car.glb', 'car-cage.glb'], work);

    // One that is being made when another model is opened.
    page.gate.hold();
    const late = begin();
    page.open('b.glb', 'b-cage.glb');
    page.gate.open();
    await late;
    await page.ready();
    assert.deepEqual(page.shown.slice(0, 2), ['b.glb', 'b-cage.glb'], work);

    // A model whose cage cannot be read waits for another one.
    page.session.request({ target: page.load('c.glb'), cage: page.load('broken.glb') });
    await page.failed();
    await begin();
    await page.ready();
    assert.equal(page.shown[0], 'b.glb', work);
  }
});

test('a cage that is being made comes, though rules and paints are chosen meanwhile, and by these; cancelled, they go', async () => {
  const page = await workshop();
  const paints: string[] = [];
  page.session.on('paint', ({ name }) => paints.push(name));
  page.gate.hold();
  const made = page.maker.make();
  await until(() => page.gate.count === 1);
  page.session.setRules({ preset: 'paper', threshold: 0.9 });
  page.session.reportPaint(paintOf('violet.png'));
  await quiet();
  assert.deepEqual([page.state, paints], ['working', ['violet.png']]);
  page.gate.open();
  await made;
  await page.ready();
  assert.equal(page.session.shown!.projection.preset, 'paper');
  assert.equal(page.shown[1], 'a-cage.glb');

  page.gate.hold();
  const cancelled = page.maker.make();
  await until(() => page.gate.count === 1);
  page.session.setRules({ preset: 'default' });
  page.session.cancel();
  await cancelled;
  await page.ready();
  assert.deepEqual([page.session.rules.preset, page.shown[1]], ['paper', 'a-cage.glb']);
});

test('a sample whose cage was moved keeps its paints; a cage that is made for it has none of them', async () => {
  const page = await workshop();
  const sample = { name: 'one', title: 'One', target: '', cage: '', paints: [] };
  const ofSample = async (name: string, size: number) => ({ ...(await page.load(name, size)), sample });
  page.session.request({ target: ofSample('target.glb', 1), cage: ofSample('cage.glb', 4) });
  await page.ready();
  await page.maker.move();
  await page.ready();
  assert.equal(page.shown[1], 'cage.glb');
  assert.equal(sampleOf(page.session.shown!.cage), sample);
  await page.maker.make();
  await page.ready();
  assert.equal(page.shown[1], 'target-cage.glb');
  assert.equal(sampleOf(page.session.shown!.cage), undefined);
});

test('triangles that were marked to stay bare are for their own model, not for one that is opened after it', async () => {
  const page = await workshop();
  const { target } = page.session.shown!;
  page.session.setBare(Uint8Array.of(1, 0, 0, 0));
  await page.maker.cageFor(target);
  assert.deepEqual(page.engine.marks, Uint8Array.of(1, 0, 0, 0));
  await page.maker.cageFor(await page.load('b.glb'));
  assert.equal(page.engine.marks, undefined);
});

test('a fit that had to guess says so, and what to mark', async () => {
  const page = await workshop();
  page.engine.found = 2;
  await page.maker.fit('human-head');
  await page.ready();
  assert.match(page.notes.note, /placed by the model’s size: mark c, d, e, f\.$/);
  await page.maker.fit('human-head', { c: [0, 0, 0], d: [0, 0, 0] });
  await page.ready();
  assert.match(page.notes.note, /was fitted/);
});

/** The layers of a page, the uppermost first, those that are hidden in brackets, and how many are put away. */
async function layered() {
  const page = await workshop();
  const [stack, history] = [new LayerStack(), new History()];
  const edits = new Edits(stack, history);
  const away = new PutAwayLayers(page.session, stack, edits);
  followPaints(page.session, stack, edits);
  page.session.request({ cage: page.load('first.glb', 4) });
  await page.ready();
  page.session.request({ paint: Promise.resolve(page.session.checker) });
  await page.ready();
  stack.setBase('UV checker', page.session.checker);
  const state = () => {
    const names = stack.layers.toReversed().map(({ name, visible }) => (visible ? name : `(${name})`));
    return [...names, away.layers.length];
  };
  const add = async (name: string) => {
    page.session.request({ paint: Promise.resolve(paintOf(name)) });
    await page.ready();
  };
  const cage = async (uv: number) => {
    page.session.request({ cage: page.load(`cage-${uv}.glb`, 4, uv) });
    await page.ready();
  };
  return { page, stack, history, away, state, add, cage };
}

test('layers for earlier cages are put away, however often a cage is made; undo brings them back, and so does the offer', async () => {
  const { history, away, state, add, cage, stack } = await layered();
  await add('one');
  assert.deepEqual(state(), ['one', '(UV checker)', 0]);
  await cage(1);
  assert.deepEqual(state(), ['UV checker', 1]);
  await cage(2);
  assert.deepEqual(state(), ['UV checker', 1]);
  await add('two');
  await cage(3);
  assert.deepEqual(state(), ['UV checker', 2]);
  history.undo();
  assert.deepEqual(state(), ['two', '(UV checker)', 1]);
  history.redo();
  assert.deepEqual(state(), ['UV checker', 2]);
  await cage(2);
  away.bringBack();
  assert.deepEqual(state(), ['two', '(UV checker)', 1], 'those of this cage, without those of others');
  await cage(9);
  away.bringBack();
  assert.deepEqual(state(), ['two', 'one', '(UV checker)', 0], 'where none is of the cage, all of them');

  // As many as there is room for.
  await cage(10);
  for (let n = stack.layers.length; n < maxLayers - 1; n++) await add(`more ${n}`);
  away.bringBack();
  assert.deepEqual([stack.layers.length, away.layers.length], [maxLayers, 1]);
  assert.throws(() => away.bringBack(), /layers/);
});

test('the paint of the cage before can be carried over, as long as nothing is drawn for this one and the model is the same', async () => {
  const { page, history, away, state, add, cage } = await layered();
  const earlier = () => away.earlier?.layers.map(({ name }) => name);
  const first = page.session.shown!.cage.mesh;
  assert.equal(earlier(), undefined);
  await add('one');
  await add('two');
  assert.equal(earlier(), undefined);
  await cage(1);
  assert.deepEqual(earlier(), ['one', 'two']);
  await cage(2);
  assert.deepEqual([earlier(), away.earlier!.cage === first], [['one', 'two'], true], 'nothing was drawn in between');
  away.carryOver('carried over', paintOf('new'));
  assert.deepEqual([state(), earlier()], [['carried over', '(UV checker)', 0], undefined]);
  history.undo();
  assert.deepEqual(state(), ['UV checker', 0]);
  history.redo();
  await cage(3);
  assert.deepEqual(earlier(), ['carried over']);
  await add('three');
  assert.equal(earlier(), undefined);
  await cage(4);
  assert.deepEqual(earlier(), ['three']);
  page.open('other.glb', 'other-cage.glb');
  await page.ready();
  assert.equal(earlier(), undefined);
});

test('the paint of a sample can be carried over, too', async () => {
  const { away, stack, cage } = await layered();
  const paint = paintOf('of the sample', { name: 'sample', paints: [] } as never);
  stack.setBase('of the sample', paint);
  await cage(1);
  assert.deepEqual(
    [stack.base!.name, away.earlier!.layers.map(({ sheet }) => sheet === paint), away.layers.length],
    ['UV checker', [true], 0],
  );
});

test('layers stay where a cage has the same UVs', async () => {
  const { state, add, page } = await layered();
  await add('one');
  page.session.request({ cage: page.load('moved.glb', 5) });
  await page.ready();
  assert.deepEqual(state(), ['one', '(UV checker)', 0]);
});
