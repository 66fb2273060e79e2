import assert from 'node:assert/strict';
import { test } from 'node:test';
import { type Command, Edits, History, LayerStack } from '#three';
import { barePart } from '../../../web/src/state/project/bare-part';
import { cagePart } from '../../../web/src/state/project/cage-part';
import { Keeper, type Offer } from '../../../web/src/state/project/keeper';
import { layersPart } from '../../../web/src/state/project/layers-part';
import { type Contribution, filesIn, Project } from '../../../web/src/state/project/project';
import { scenePart } from '../../../web/src/state/project/scene-part';
import { settingsParts, viewPart } from '../../../web/src/state/project/settings-parts';
import type { Flags, Shelf, Work, WorkStore } from '../../../web/src/state/project/shelf';
import { PutAwayLayers } from '../../../web/src/state/put-away-layers';
import type { Angle } from '../../../web/src/state/view-state';
import { begin, Gate, paintOf, quiet, until } from './harness';

/** What the tabs of a browser share. */
class FakeBrowser {
  works: Work[] = [];
  files = new Map<string, Blob>();
  holders = new Map<string, object>();
  work: Flags['work'] | undefined;
  isFull = false;
  /** Holds reading back. */
  readonly gate = new Gate();
  #time = 0;

  store(): WorkStore {
    return {
      works: async () => this.works.toSorted((a, b) => b.at - a.at),
      keys: async () => new Set(this.files.keys()),
      file: async (key) => this.gate.wait().then(() => this.files.get(key)),
      put: async (work, added, open) => {
        if (this.isFull) throw new DOMException('full', 'QuotaExceededError');
        const files = new Map([...this.files, ...added]);
        if (!work.files.every((key) => files.has(key))) return false;
        this.files = files;
        this.works = [...this.works.filter(({ slot }) => slot !== work.slot), { ...work, at: ++this.#time }];
        this.works = this.works.filter(({ slot, at }) => at > this.#time - 3 || open.has(slot));
        return true;
      },
    };
  }
}

class FakeCamera {
  angle: Angle | undefined;
  readonly #followers: (() => void)[] = [];

  onMove(follow: () => void): void {
    this.#followers.push(follow);
  }

  lookFrom(angle: Angle): void {
    this.angle = angle;
    for (const follow of this.#followers) follow();
  }

  home(): void {
    this.angle = undefined;
  }
}

/** Others beside the model: the camera shows all of them. */
const crowdPart = (camera: FakeCamera): Contribution => ({
  name: 'crowd',
  isWork: false,
  save: () => true,
  read: () => ({ ready: () => camera.home() }),
});

/** A tab, with a page that keeps its work. @param memory What it had before it was reloaded. */
async function tab(browser: FakeBrowser, memory: Partial<Flags> = {}, fragment = '') {
  const page = await begin();
  const { session, loader } = page;
  const [stack, history] = [new LayerStack(), new History()];
  const edits = new Edits(stack, history);
  const samples = { samples: [], find: () => undefined };
  const project = new Project(session, scenePart(session, samples, loader));
  const away = new PutAwayLayers(session, stack, edits);
  const images = {
    check: async () => {},
    load: async (file: File) => ({ ...paintOf(file.name), file }),
    nameOf: () => '',
    pack: never,
    unpack: never,
  };
  const live = { shape: { deform: 'bend', amount: 0, cage: true, morphs: new Map() } as never, move() {} };
  const camera = new FakeCamera();
  session.on('transfer', () => camera.home());
  const parts: Contribution[] = [
    layersPart({ session, stack, edits, away, samples, painter: undefined, images }),
    ...settingsParts(session, live),
    barePart(session),
    cagePart({ session, samples, templates: ['human-head'] }, undefined),
    crowdPart(camera),
    viewPart(session, camera),
  ];
  for (const part of parts) project.add(part);
  const self = {};
  const offers: Offer[] = [];
  const notes: string[] = [];
  const errors: string[] = [];
  let isOver = false;
  const shelf: Shelf = {
    open: async () => browser.store(),
    flags: {
      get: (name) => (name === 'work' ? browser.work : memory[name]) as never,
      set: (name, value) => void Object.assign(name === 'work' ? browser : memory, { [name]: value }),
    },
    hold: async (slot) => {
      const holder = browser.holders.get(slot);
      if (!holder) browser.holders.set(slot, self);
      return holder === undefined || holder === self;
    },
    letGo: (slot) => void browser.holders.delete(slot),
    held: async () => new Set(browser.holders.keys()),
    fragment,
    isLink: (text) => text.startsWith('#sample'),
    startOver: () => (isOver = true),
  };
  const keeper = new Keeper({ project, session, history }, shelf, {
    offer: (offer) => offer && offers.push(offer),
    note: (text) => notes.push(text),
    error: (text) => errors.push(text),
  });
  const close = (): void => {
    for (const [slot, holder] of browser.holders) if (holder === self) browser.holders.delete(slot);
  };
  const step = (name: string): Command => ({ name, bytes: 0, undo() {}, redo() {} });
  return {
    ...page,
    get shown() {
      return page.shown;
    },
    get state() {
      return page.state;
    },
    keeper,
    camera,
    project,
    history,
    stack,
    browser,
    notes,
    errors,
    offers,
    memory,
    get offer() {
      return offers.at(-1)?.text;
    },
    get isOver() {
      return isOver;
    },
    /** Opens files of the visitor's own, and keeps them. */
    async work(name: string): Promise<void> {
      page.open(`${name}.glb`, `${name}-cage.glb`);
      await page.ready();
      history.add(step('stroke'));
      await keeper.save();
    },
    act: () => history.add(step('stroke')),
    /** Opens files in place of what is shown. */
    replace(target: string, cage: string): void {
      page.open(target, cage);
      keeper.replaceBy(session.requested.target!);
    },
    close,
    fragment,
    /** Does what the last offer offers. */
    async take(): Promise<void> {
      const { length } = offers;
      offers.at(-1)!.action!.run();
      await until(() => offers.length > length, 'what is offered');
      await quiet();
    },
    /** The names of the files of each work. */
    get kept() {
      const nameOf = (key: string): string => (browser.files.get(key) as File | undefined)?.name ?? 'missing';
      return browser.works.map(({ files }) => files.map(nameOf).toSorted().join(' ')).toSorted();
    },
  };
}

type Tab = Awaited<ReturnType<typeof tab>>;

/** The same tab after a reload. */
async function reloaded({ close, browser, memory, fragment }: Tab): Promise<Tab> {
  close();
  return tab(browser, memory, fragment);
}

const never = (): never => {
  throw new Error('there are no paintings here');
};

test('work is back after a reload, with its files and settings; starting over can be taken back', async () => {
  const first = await tab(new FakeBrowser());
  await first.keeper.restore();
  await first.work('bust');
  first.stack.add('stripes', { ...paintOf('stripes.png'), file: new File(['x'], 'stripes.png') } as never);
  first.session.setRules({ threshold: 0.7, preset: 'paper', weldTolerance: 1e-4 });
  first.session.setView({ mode: 'zones' });
  await first.ready();
  first.session.setLocks({ 0: 'exclude' });
  first.session.setBare(Uint8Array.of(0, 1, 1, 0));
  await first.keeper.save();
  assert.ok(first.keeper.isKept);
  const before = first.project.snapshot()!.work;

  const second = await reloaded(first);
  assert.equal(await second.keeper.restore(), false);
  assert.deepEqual(second.shown.slice(0, 2), ['bust.glb', 'bust-cage.glb']);
  assert.equal(second.offer, 'Your last work is back.');
  assert.equal(second.project.snapshot()!.work, before);
  assert.deepEqual(second.session.rules, { threshold: 0.7, preset: 'paper', weldTolerance: 1e-4, borders: 'triangle' });
  assert.deepEqual([second.session.locks, second.session.bare], [{ 0: 'exclude' }, Uint8Array.of(0, 1, 1, 0)]);
  assert.deepEqual([second.session.view.mode, second.stack.layers.map(({ name }) => name)], ['zones', ['stripes']]);

  second.offers.at(-1)!.action!.run();
  await until(() => second.isOver, 'a new beginning');
  const third = await reloaded(second);
  third.open('sample.glb', 'cage.glb');
  await third.ready();
  assert.equal(await third.keeper.restore(), false);
  assert.equal(third.offer, 'Your last work is put aside.');
  assert.equal(third.shown[0], 'sample.glb');
  await third.take();
  assert.equal(third.project.snapshot()!.work, before);
});

test('a work that is broken or old, or that took the page down, does not stop the page from opening', async () => {
  const browser = new FakeBrowser();
  const first = await tab(browser);
  await first.keeper.restore();
  await first.work('bust');
  const [work] = structuredClone(browser.works);
  for (const [change, says] of [
    [{ version: 99 }, /could not be brought back: it was saved by another version/],
    [{ parts: { ...work!.parts, models: 7 } }, /could not be brought back: the project is damaged: it has no models/],
    [{ files: [] }, /could not be brought back: the project is damaged: a file is missing/],
  ] as const) {
    browser.works = [{ ...work!, ...(change as Partial<Work>) }];
    const next = await reloaded(first);
    assert.equal(await next.keeper.restore(), true);
    assert.match(next.offer!, says);
    next.close();
  }
  browser.works = [work!];
  browser.work = 'opening';
  const next = await reloaded(first);
  assert.equal(await next.keeper.restore(), false);
  assert.match(next.offer!, /did not get to show it/);
  await next.take();
  assert.equal(next.shown[0], 'bust.glb');
});

test('a work is back, too, when a link to it is in the address; another link comes first', async () => {
  const browser = new FakeBrowser();
  const first = await tab(browser, {}, '#sample=a');
  await first.keeper.restore();
  await first.work('bust');
  first.close();
  const same = await tab(browser, { ...first.memory }, '#sample=a');
  await same.keeper.restore();
  assert.equal(same.offer, 'Your last work is back.');
  same.close();
  const other = await tab(browser, { ...first.memory }, '#sample=b');
  await other.keeper.restore();
  assert.equal(other.offer, 'Your last work is kept.');
  await other.take();
  assert.equal(other.shown[0], 'bust.glb');
});

test('own files that give way are put aside as they are at that moment, and what gives way to them in turn', async () => {
  const page = await tab(new FakeBrowser());
  await page.keeper.restore();
  await page.work('bust');
  page.session.setRules({ threshold: 0.7 }); // which is not stored yet
  page.replace('car.glb', 'car-cage.glb');
  page.session.setRules({ threshold: 0.8 }); // while the other one is being loaded
  await page.ready();
  await until(() => page.offer === 'Replaced bust.');
  assert.equal(page.history.last!.name, 'replacing bust');
  assert.deepEqual(page.kept, ['bust-cage.glb bust.glb']);
  page.session.setRules({ threshold: 0.2 });
  page.history.undo();
  await until(() => page.shown[0] === 'bust.glb');
  await page.ready();
  await quiet();
  assert.equal(page.session.rules.threshold, 0.8);
  assert.equal(page.history.last, undefined, 'as after a reload');

  // Of several, the last one is held; what was only looked at is nothing to bring back.
  for (const name of ['car', 'lizard']) {
    page.replace(`${name}.glb`, `${name}-cage.glb`);
    await page.ready();
    await quiet();
  }
  assert.equal(page.offer, 'Replaced car.');
  page.history.undo();
  await until(() => page.shown[0] === 'car.glb');
  await quiet();
  assert.equal(page.history.undo(), undefined);
});

test('a model that replaces another and fails, or is cancelled, or cannot be taken back, loses nothing', async () => {
  const page = await tab(new FakeBrowser());
  await page.keeper.restore();
  await page.work('bust');
  page.replace('broken.glb', 'car-cage.glb');
  await page.failed();
  await quiet();
  assert.deepEqual([page.offers.length, page.history.last!.name], [0, 'stroke']);
  page.replace('car.glb', 'car-cage.glb');
  await page.ready();
  await quiet();
  assert.equal(page.offer, 'Replaced bust.');
  page.loader.gate.hold();
  page.history.undo();
  await quiet();
  page.session.cancel();
  page.loader.gate.open();
  await quiet();
  assert.deepEqual([page.shown[0], page.history.last!.name], ['car.glb', 'replacing bust']);
  page.history.undo();
  await until(() => page.shown[0] === 'bust.glb');
});

test('without a store, too, what was replaced can be taken back', async () => {
  const page = await tab(new FakeBrowser());
  await page.work('bust');
  page.replace('car.glb', 'car-cage.glb');
  await page.ready();
  await quiet();
  page.history.undo();
  await until(() => page.shown[0] === 'bust.glb');
});

test('where there is no room, that is said once, and work is not said to be put aside as a whole', async () => {
  const browser = new FakeBrowser();
  const page = await tab(browser);
  await page.keeper.restore();
  await page.work('bust');
  browser.isFull = true;
  for (let i = 0; i < 2; i++) {
    page.session.setRules({ threshold: 0.6 + i / 10 });
    page.act();
    await page.keeper.save();
  }
  assert.equal(page.errors.length, 1);
  assert.match(page.errors[0]!, /^Your work is not kept on this device: there is no room left/);
  assert.equal(page.keeper.isKept, false);
  page.replace('car.glb', 'car-cage.glb');
  await page.ready();
  await quiet();
  assert.match(page.offer!, /^Replaced bust\. It could not be kept on this device: there is no room left/);
  browser.isFull = false;
  page.history.undo();
  await until(() => page.shown[0] === 'bust.glb');
  await quiet();
  assert.equal(page.session.rules.threshold, 0.7, 'the page itself has all of it');
});

test('a tab beside one that has the latest work offers the one before; starting over offers the tab’s own', async () => {
  const browser = new FakeBrowser();
  const tabs = [await tab(browser), await tab(browser)];
  for (const [i, one] of tabs.entries()) {
    await one.keeper.restore();
    await one.work(`work-${i}`);
  }
  for (const one of tabs) one.close();
  const latest = await tab(browser);
  await latest.keeper.restore();
  assert.equal(latest.shown[0], 'work-1.glb');
  const other = await tab(browser);
  await other.keeper.restore();
  assert.equal(other.offer, 'An earlier work of yours is kept.');
  await other.take();
  assert.equal(other.shown[0], 'work-0.glb');
  // The other one has later work now.
  latest.session.setRules({ threshold: 0.9 });
  latest.act();
  await latest.keeper.save();
  await other.keeper.startOver();
  const again = await reloaded(other);
  await again.keeper.restore();
  assert.equal(again.offer, 'Your last work is put aside.');
  await again.take();
  assert.equal(again.shown[0], 'work-0.glb');
});

test('the works of open tabs are kept however many there are; a work whose files were dropped is kept whole again', async () => {
  const browser = new FakeBrowser();
  const tabs = [];
  for (const name of ['a', 'b', 'c', 'd', 'e']) {
    const one = await tab(browser);
    await one.keeper.restore();
    await one.work(name);
    tabs.push(one);
  }
  const [first, ...others] = tabs;
  const filesOf = (...names: string[]) => names.map((name) => `${name}-cage.glb ${name}.glb`);
  assert.deepEqual(first!.kept, filesOf('a', 'b', 'c', 'd', 'e'));
  for (const one of others) one.close();
  first!.session.setRules({ threshold: 0.6 });
  await first!.keeper.save();
  assert.deepEqual(first!.kept, filesOf('a', 'd', 'e'));
  browser.works = [];
  browser.files.clear();
  first!.session.setRules({ threshold: 0.7 });
  await first!.keeper.save();
  assert.deepEqual(first!.kept, filesOf('a'));
});

test('a project that takes long to open leaves the work before it as it was', async () => {
  const page = await tab(new FakeBrowser());
  await page.keeper.restore();
  await page.work('bust');
  const { parts, files } = page.project.snapshot()!;
  const found = new Map<string, File>();
  for (const [key, make] of files) found.set(key, (await make()) as File);
  const saved = structuredClone({ ...parts, rules: { preset: 'paper', threshold: 0.2 } });
  page.session.setRules({ threshold: 0.7 });
  page.act();
  page.transferer.gate.hold();
  const opening = page.keeper.open(saved, filesIn(found));
  await until(() => page.session.rules.preset === 'paper');
  await page.keeper.save(); // as when people pause: it is neither the one nor the other
  page.transferer.gate.open();
  assert.equal(await opening, true);
  assert.deepEqual([page.offer, page.session.rules.threshold], ['Replaced bust.', 0.2]);
  page.history.undo();
  await until(() => page.session.rules.preset === 'default');
  await quiet();
  assert.deepEqual([page.session.rules.preset, page.session.rules.threshold], ['default', 0.7]);
});

test('files that are opened before the work is back stay, and the work is offered', async () => {
  for (const what of ['finding', 'reading']) {
    const browser = new FakeBrowser();
    const first = await tab(browser);
    await first.keeper.restore();
    await first.work('bust');
    const next = await reloaded(first);
    const gate = what === 'finding' ? browser.gate : next.loader.gate;
    gate.hold();
    const restored = next.keeper.restore();
    await until(() => gate.count > 0);
    next.open('lizard.glb', 'lizard-cage.glb');
    gate.open();
    assert.equal(await restored, false, what);
    await next.ready();
    assert.deepEqual([next.offer, next.shown[0]], ['Your last work is kept.', 'lizard.glb'], what);
    await next.take();
    assert.equal(next.shown[0], 'bust.glb', what);
  }
});

test('a project that somebody has damaged or changed by hand is refused in one sentence, and changes nothing', async () => {
  const page = await tab(new FakeBrowser());
  await page.keeper.restore();
  await page.work('bust');
  const { parts, work, files } = page.project.snapshot()!;
  const file = (await [...files.values()][0]!()) as File;
  const layer = { name: 'L', style: {}, sheet: { size: 99999, file: 'x' } };
  const fit = { template: 'no-template', given: {}, used: {}, confidence: {}, missing: [] };
  for (const [change, says] of [
    [{ models: {} }, /it has no model$/],
    [{ models: { target: { files: [] } } }, /a file is missing$/],
    [{ layers: { layers: Array(999).fill(layer) } }, /no list of layers, or too long/],
    [{ layers: { layers: [{ ...layer, sheet: 7 }] } }, /it has no paint$/],
    [{ layers: { layers: [layer] } }, /paintings need WebGL/],
    [{ shape: { morphs: [[1]] } }, undefined], // at rest
    [{ shape: { morphs: 'all' } }, /no list of morphs/],
    [{ bare: [2 ** 26, 2 ** 26] }, /too many marks/],
    [{ cages: [{ cage: 'x', fitting: fit }] }, /it has an unknown template$/],
    [{ cages: [{ cage: 'x', fitting: { ...fit, template: 'human-head', used: { a: [1, 2] } } }] }, /has no place$/],
    [{ overrides: [] }, /it has no overrides$/],
  ] as const) {
    const hostile = { ...structuredClone(parts), ...change };
    const opening = page.keeper.open(hostile as Record<string, unknown>, (key) =>
      key === 'x' || files.has(String(key)) ? file : filesIn(new Map())(key),
    );
    if (!says) {
      await opening;
      continue;
    }
    await assert.rejects(opening, says);
    assert.equal(page.shown[0], 'bust.glb');
  }
  const values = {
    rules: { preset: 'x', threshold: 7, weldTolerance: 1, borders: 1 },
    overrides: { 0: 'x', '-1': 'keep', 99: 'keep' },
  };
  assert.ok(await page.keeper.open({ ...structuredClone(parts), ...values }, () => file));
  assert.deepEqual(page.session.rules, { preset: 'default', threshold: 0.5, weldTolerance: 0, borders: 'triangle' });
  assert.deepEqual(page.session.locks, { 0: 'auto' });
  assert.ok(work.length > 0);
});

test('who looks at a place finds it again after a reload, also beside others', async () => {
  const first = await tab(new FakeBrowser());
  await first.keeper.restore();
  await first.work('bust');
  const angle: Angle = { turn: 12, tilt: 84, near: 4.5, at: [0.1, 0.8, 0] };
  first.camera.lookFrom(angle);
  const isKept = (): boolean => JSON.stringify(first.browser.works[0]!.parts).includes('4.5');
  for (let wait = 0; !isKept() && wait < 100; wait++) await new Promise((done) => setTimeout(done, 50));
  assert.ok(isKept(), 'without anything else that is done');
  const second = await reloaded(first);
  await second.keeper.restore();
  assert.deepEqual(second.camera.angle, angle);
});
