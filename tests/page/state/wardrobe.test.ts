import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Texture } from 'three';
import { noteMade } from '../../../web/src/state/made-cages';
import type { Model } from '../../../web/src/state/model';
import type { Paint } from '../../../web/src/state/paint';
import type { SplitProjection } from '../../../web/src/state/transfers';
import type { Avatar, Entry, Figure } from '../../../web/src/state/wardrobe/avatar';
import { Wardrobe } from '../../../web/src/state/wardrobe/wardrobe';
import { begin, copyOf, FakeTransferer, fileOf, Gate, quiet, until } from './harness';

/** A cage as one that was made here. */
function asMade(target: File, cage: Model): Model {
  noteMade(cage.files[0]!, { target, fitting: undefined });
  return cage;
}

/** A wardrobe beside a model with its cage, `one.glb`. */
async function wardrobe() {
  const page = await begin();
  const { session, loader } = page;
  page.open('one.glb', 'cage.glb');
  await page.ready();
  const [fits, transferer] = [new Gate(), new FakeTransferer()];
  const errors: string[] = [];
  /** What figures wear: the paint of the stage, or one of their own. */
  const worn = new Map<string, unknown>();
  let drawing = '';
  const drawn: string[] = [];
  const draw = async (cage: Model): Promise<Paint> => {
    drawn.push(`${drawing} ${cage.name}`);
    if (drawing === 'broken') throw new Error('it cannot be drawn');
    return { name: drawing, texture: new Texture(), picture: '', drawn: drawing };
  };
  let figures: readonly (Figure | undefined)[] | undefined;
  let refused: string | undefined;
  const view = {
    stand(model: Model, projection: SplitProjection | undefined): Figure {
      const setProjection = (next: SplitProjection): unknown => Object.assign(figure, { projection: next });
      const setPaint = (paint: unknown): unknown => worn.set(model.name, paint);
      const figure = { model, projection, setPaint, setProjection, classify() {}, dispose() {} };
      return figure;
    },
    arrange: (all: typeof figures) => void (figures = all),
    redraw() {},
  };
  const all = new Wardrobe({
    session,
    loader,
    transferer,
    async fit(cage, { name }, { signal }) {
      await fits.wait(signal);
      if (name === refused) throw new Error('the cage does not fit');
      return copyOf(name.replace('.', '-cage.'), cage);
    },
    async choose({ name, files }, { signal }) {
      await fits.wait(signal);
      if (name === refused) throw new Error('no cage can be made');
      return asMade(files[0]!, await page.load(name.replace('.', '-chosen.'), 4, name.length));
    },
    drawing: () => (drawing === '' ? undefined : { name: drawing, draw }),
    view,
    errors: { show: (text) => errors.splice(0, errors.length, text), add: (text) => errors.push(text) },
  });
  const entry = (name: string, cage?: Promise<Model>): Entry => {
    const file = fileOf(`${name}.glb`);
    return { name, target: () => loader.load(file), cage: cage && (() => cage) };
  };
  const named = (name: string): Avatar => all.list.all.find((avatar) => avatar.name === name)!;
  return {
    ...page,
    get shown() {
      return page.shown;
    },
    get state() {
      return page.state;
    },
    all,
    fits,
    errors,
    transferer,
    stage: page.transferer,
    entry,
    named,
    worn,
    drawn,
    /** Chooses a base paint that is drawn; none if the name is empty. */
    async drawAs(name: string): Promise<void> {
      drawing = name;
      all.refresh();
      await all.list.done;
    },
    get figures() {
      return figures;
    },
    /** The names of all, the one on the stage in brackets. */
    get names() {
      return all.list.all.map((one) => (one === all.list.active ? `[${one.name}]` : one.name)).join(' ');
    },
    refuse: (name: string) => void (refused = name),
    add: (...names: string[]) => all.add(names.map((name) => entry(name))),
    /** Puts an avatar on the stage, and waits until it is there. */
    async choose(name: string): Promise<void> {
      all.activate(named(name));
      await until(() => all.list.active.name === name, name);
      await page.ready();
    },
    /** Waits until nothing is done to any. */
    done: () => until(() => all.list.all.every(({ doing }) => doing === ''), 'the end of what is done'),
  };
}

/** Beside the model on the stage another one, `two`, to which the cage is being fitted. */
async function beingFitted() {
  const page = await wardrobe();
  page.fits.hold();
  void page.add('two');
  await until(() => page.fits.count === 1);
  return page;
}

/** Requests a sample that is loading. @returns Lets it come. */
function holdSample({ session, load }: Awaited<ReturnType<typeof wardrobe>>): () => void {
  const gate = new Gate();
  gate.hold();
  const held = async (name: string, size: number, uv: number) => gate.wait().then(() => load(name, size, uv));
  session.request({ target: held('car.glb', 1, 0), cage: held('car-cage.glb', 4, 2) }, {}, true);
  return () => gate.open();
}

test('avatars are read one after the other, get the cage on the stage, and stand beside it; what cannot be read is reported and left out', async () => {
  const page = await wardrobe();
  await page.add('two', 'broken', 'three');
  assert.deepEqual(page.errors, ['broken.glb: it is broken']);
  assert.equal(page.names, '[one] two three');
  for (const name of ['two', 'three']) {
    const { cage, takesPaint, verdict, follows } = page.named(name);
    assert.deepEqual([cage!.name, takesPaint, verdict, follows], [`${name}-cage.glb`, true, 'good', true]);
  }
  assert.equal(page.figures, undefined);
  page.all.showsAll = true;
  assert.deepEqual(
    page.figures!.map((figure) => figure?.model.name),
    [undefined, 'two.glb', 'three.glb'],
  );
  assert.equal(page.session.view.mode, 'result', 'one divider across all would hide more than it shows');
  page.all.remove(page.named('two'));
  assert.deepEqual(page.loader.disposed, ['two.glb']);
});

test('without a cage of the user’s own on the stage, each gets the one that is chosen for it, and the paint of all whose UVs are the same', async () => {
  const page = await wardrobe();
  const own = page.session.shown!.target.files[0]!;
  page.session.request({ cage: page.load('one-chosen.glb', 4, 7).then((cage) => asMade(own, cage)) });
  await page.ready();
  page.refuse('four.glb');
  await page.add('two', 'three', 'four');
  const { two, three, four } = Object.fromEntries(page.all.list.all.map((avatar) => [avatar.name, avatar]));
  assert.deepEqual([two!.cage!.name, two!.takesPaint, two!.follows], ['two-chosen.glb', true, false]);
  assert.deepEqual([three!.cage!.name, three!.takesPaint], ['three-chosen.glb', false]);
  assert.deepEqual([four!.cage, page.errors], [undefined, ['four: no cage can be made']]);
});

test('a base that is drawn is drawn for other cages, too: again when it or the cage changes, not for what takes the paint of the stage', async () => {
  const page = await wardrobe();
  await page.all.add([
    page.entry('two', page.load('two-own.glb', 4, 1)),
    page.entry('three', page.load('cage.glb', 4)),
  ]);
  assert.deepEqual([page.worn.get('two.glb'), page.worn.get('three.glb')], [undefined, 'stage']);
  await page.drawAs('tiger');
  await page.drawAs('tiger');
  const two = page.named('two');
  assert.deepEqual([page.worn.get('two.glb'), page.drawn], [two.own!.paint.texture, ['tiger two-own.glb']]);
  await page.drawAs('flowers');
  await page.choose('two');
  await page.done();
  assert.deepEqual(
    page.drawn,
    ['tiger', 'flowers'].map((name) => `${name} two-own.glb`).concat('flowers cage.glb', 'flowers cage.glb'),
  );
  let isFreed = false;
  page.named('one').own!.paint.texture.addEventListener('dispose', () => (isFreed = true));
  page.all.remove(page.named('one'));
  assert.ok(isFreed);
  await page.drawAs('');
  assert.equal(page.worn.get('three.glb'), undefined);
  await page.drawAs('broken');
  await page.drawAs('broken');
  assert.deepEqual(page.errors, ['it cannot be drawn'], 'once');
});

test('what takes the place of a sample does not get that sample’s cage', async () => {
  const page = await wardrobe();
  const sample = { name: 'car', title: 'Car', target: 'car.glb', cage: 'car-cage.glb', paints: [] };
  const ofSample = async (loading: Promise<Model>): Promise<Model> => ({ ...(await loading), sample });
  const car = { target: ofSample(page.load('car.glb')), cage: ofSample(page.load('car-cage.glb', 4, 2)) };
  page.session.request(car, {}, true);
  await page.ready();
  await page.all.add([page.entry('two'), page.entry('three')], page.all.list.active);
  await until(() => page.shown[0] === 'two.glb');
  await page.ready();
  assert.deepEqual([page.names, page.shown[1]], ['[two] three', 'two-chosen.glb']);
});

test('twelve are taken; more are refused by name, and find room when one is removed', async () => {
  const page = await wardrobe();
  const some = Array.from({ length: 13 }, (_, i) => `figure-${i + 2}`);
  await page.add(...some);
  const full =
    'The wardrobe is full: it holds 12 avatars, and figure-13 and figure-14 found no room. Remove one first.';
  assert.deepEqual([page.all.list.all.length, page.errors], [12, [full]]);
  page.all.remove(page.named('figure-2'));
  await page.add('figure-13');
  assert.equal(page.all.list.all.at(-1)!.name, 'figure-13');
});

test('another cage on the stage is fitted to those that follow; why it does not fit is said of each', async () => {
  const page = await wardrobe();
  await page.add('two', 'three');
  await page.all.add([page.entry('own', page.load('own-cage.glb', 4, 1))]);
  page.session.request({ cage: page.load('new-cage.glb', 4, 3) });
  await page.ready();
  await page.done();
  const uvsOf = (name: string) => page.named(name).cage!.mesh.uvs;
  for (const name of ['two', 'three']) assert.deepEqual(uvsOf(name), page.session.shown!.cage.mesh.uvs);
  assert.equal(page.named('own').takesPaint, false);
  page.refuse('own.glb');
  page.all.fitAll();
  await page.done();
  page.refuse('three.glb');
  page.session.request({ cage: page.load('next-cage.glb', 4, 4) });
  await until(() => page.errors.length === 2, 'the second error');
  assert.deepEqual(page.errors, ['own: the cage does not fit', 'three: the cage does not fit']);
});

test('a fit ends when its avatar is removed, and the next one is read', async () => {
  const page = await beingFitted();
  page.all.remove(page.named('two'));
  assert.equal(page.fits.count, 0);
  page.fits.open();
  await page.add('three');
  assert.deepEqual([page.names, page.errors], ['[one] three', []]);
});

test('an avatar that comes on the stage while a cage is fitted to it gets that cage, unless another is chosen there', async () => {
  const page = await beingFitted();
  await page.choose('two');
  page.fits.open();
  await until(() => page.shown[1] === 'two-cage.glb');
  await page.done();
  assert.ok(page.all.list.all.every(({ takesPaint }) => takesPaint));

  const other = await beingFitted();
  await other.choose('two');
  other.session.request({ cage: other.load('own-cage.glb', 4, 1) });
  await other.ready();
  other.fits.open();
  await other.done();
  await other.choose('one');
  await other.choose('two');
  assert.equal(other.shown[1], 'own-cage.glb');
});

test('a cage that was fitted to an avatar does not reach a sample that is loading, whether that avatar had come or not', async () => {
  for (const comes of [true, false]) {
    const page = await beingFitted();
    if (comes) await page.choose('two');
    else page.all.activate(page.named('two'));
    const letCome = holdSample(page);
    page.fits.open();
    await page.done();
    letCome();
    await page.ready();
    assert.deepEqual(page.shown.slice(0, 2), ['car.glb', 'car-cage.glb']);
  }
});

test('an avatar that was chosen, and then a sample, can be chosen again before that has come', async () => {
  for (const comes of [true, false]) {
    const page = await beingFitted();
    if (comes) await page.choose('two');
    else page.all.activate(page.named('two'));
    const letCome = holdSample(page);
    await page.choose('two');
    letCome();
    await quiet();
    assert.equal(page.shown[0], 'two.glb');
  }
});

test('of two that are chosen at once the last one comes; one whose loading was cancelled can be chosen again', async () => {
  const page = await wardrobe();
  await page.add('two', 'three');
  for (const name of ['two', 'three', 'two', 'one']) page.all.activate(page.named(name));
  await page.ready();
  await quiet();
  assert.equal(page.names, '[one] two three');
  page.stage.gate.hold();
  page.all.activate(page.named('two'));
  await quiet();
  page.session.cancel();
  page.stage.gate.open();
  await page.choose('two');
  assert.equal(page.names, 'one [two] three');
});

test('“Fit this cage to all” fits the cage that was on the stage then, whatever comes there meanwhile', async () => {
  const page = await wardrobe();
  await page.all.add(['two', 'three'].map((name, i) => page.entry(name, page.load(`${name}-own.glb`, 4, 1 + i))));
  page.fits.hold();
  page.all.fitAll();
  await until(() => page.fits.count === 1);
  await page.choose('three');
  page.fits.open();
  await page.done();
  await page.ready();
  await page.choose('one');
  await page.done();
  assert.ok(
    page.all.list.all.every(({ takesPaint }) => takesPaint),
    page.names,
  );
});

test('what is on the stage is in the list, though avatars are removed, or models opened, before the next one has come', async () => {
  const page = await wardrobe();
  await page.add('two', 'three', 'four');
  page.all.remove(page.named('one'));
  page.all.remove(page.named('two'));
  await until(() => page.all.list.active.name === 'three');
  await page.ready();
  assert.equal(page.names, '[three] four');

  page.all.remove(page.named('three'));
  page.open('five.glb', 'five-cage.glb');
  await until(() => page.all.list.active.name === 'five');
  assert.equal(page.names, '[five] four');
  page.all.remove(page.named('four'));
  page.all.remove(page.named('five'));
  assert.equal(page.names, '[five]', 'the last one stays');
});

test('a sample that is loading comes, though the avatar on the stage is removed meanwhile', async () => {
  const page = await wardrobe();
  await page.add('two');
  const letCome = holdSample(page);
  page.all.remove(page.named('one'));
  letCome();
  await until(() => page.shown[0] === 'car.glb');
  await page.ready();
  assert.equal(page.names, '[car] two');
});

test('one that leaves the stage, and one that is just being painted, follow the rules', async () => {
  const page = await wardrobe();
  await page.add('two');
  const asked = async (...expected: string[]): Promise<void> => {
    await page.ready();
    await page.done();
    await quiet();
    const all = [...page.stage.asked, ...page.transferer.asked].filter((text) => text.startsWith('project'));
    assert.deepEqual(all.map((text) => text.replace('project ', '')).toSorted(), expected.toSorted());
    page.stage.asked = [];
    page.transferer.asked = [];
  };
  await asked('default one.glb', 'default two.glb');
  await page.choose('two');
  await asked('default one.glb', 'default two.glb');
  page.session.setRules({ preset: 'paper' });
  await asked('paper one.glb', 'paper two.glb');
  await page.choose('one');
  await asked('paper one.glb', 'paper two.glb');
  page.transferer.gate.hold();
  void page.add('three');
  await until(() => page.transferer.asked.length === 1);
  page.session.setRules({ preset: 'default' });
  page.transferer.gate.open();
  await asked('default one.glb', 'default two.glb', 'paper three.glb', 'default three.glb');
  page.session.setRules({ weldTolerance: 1e-5 });
  await asked('default one.glb', 'default two.glb', 'default three.glb');
});

test('overrides are remembered while another is on the stage; the kept wardrobe has all, those too that still wait', async () => {
  const page = await wardrobe();
  await page.add('two');
  await page.choose('two');
  page.session.lock([0], 'exclude');
  await page.choose('one');
  assert.deepEqual(page.session.locks, {});
  page.loader.gate.hold();
  const file = fileOf('four.glb');
  const waiting = { files: [file], cage: undefined, sample: undefined, follows: false, locks: {}, bare: undefined };
  const entry = { ...page.entry('four'), kept: { name: 'four', ...waiting } };
  void page.all.add([page.entry('three'), entry]);
  page.all.list.all.reverse();
  const { kept } = page.all;
  assert.deepEqual([kept.at, kept.avatars.map(({ name }) => name)], [2, ['four', 'two']]);
  assert.deepEqual([kept.avatars[1]!.locks, kept.avatars[0]!.files], [{ 0: 'exclude' }, [file]]);
  page.loader.gate.open();
  await page.done();

  const other = await wardrobe();
  const two = { ...other.entry('two', other.load('cage.glb', 4)), kept: kept.avatars[1] };
  other.all.restore([other.entry('zero', other.load('cage.glb', 4)), two], 1);
  await other.done();
  assert.equal(other.names, 'zero [one] two');
  await other.choose('two');
  assert.deepEqual(other.session.locks, { 0: 'exclude' });
});

test('a cage that is being made for an avatar is not replaced by one that was being fitted to it, which comes if that is cancelled', async () => {
  for (const isCancelled of [false, true]) {
    const page = await beingFitted();
    await page.choose('two');
    const done = page.session.work('Making', 0, { abort() {}, makesCage: true });
    page.fits.pass();
    await page.done();
    assert.equal(page.state, 'working');
    if (isCancelled) page.session.cancel();
    else if (page.session.keepTarget()) page.session.request({ cage: page.load('made-cage.glb', 4, 1) });
    done();
    await page.ready();
    page.fits.open();
    await page.done();
    await page.ready();
    assert.equal(page.shown[1], isCancelled ? 'two-cage.glb' : 'made-cage.glb');
  }
});
