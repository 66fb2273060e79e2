import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { faults } from '../../support/axe';
import { asset, heldBack, holdingBack } from '../../support/cages';
import { glbOf, tetrahedron } from '../../support/glb';
import { saved, validModel } from '../../support/saved';
import { drop, glb, Site, settled, shownError, type Upload, type Visit } from '../../support/site';
import { unzip } from '../../support/zip';

const figure = (name: string): Upload => glb(`${name}.glb`, asset('human-body', 'target.glb'));

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

/** What the cards say of their avatars, once nothing is done to them any more. */
async function avatars(page: Page, count: number): Promise<string[]> {
  await page.waitForFunction(
    (count) => {
      const cards = [...document.querySelectorAll('.avatars .avatar')];
      // Between its share and its verdict, a cage is inspected.
      const isBusy = cards.some((card) => /Waiting|Reading|Fitting|Painting|, \d+ %$/.test(card.textContent!));
      return cards.length === count && !isBusy && cards.every((card) => card.querySelector('img')!.src !== '');
    },
    count,
    { timeout: 120_000 },
  );
  return page.locator('.avatars .avatar').evaluateAll((cards) => cards.map((card) => card.textContent!));
}

// A text, as a function of its own would reach the page with the test compiler's helpers in it.
const paintOnce = `async ({ x, y }) => {
  const canvas = document.querySelector('#view');
  const frame = () => new Promise((done) => requestAnimationFrame(() => done(canvas.toDataURL())));
  const send = (type, dx) => canvas.dispatchEvent(new PointerEvent(type, {
    clientX: x + dx, clientY: y, pointerId: 1, isPrimary: true, bubbles: true, button: type === 'pointermove' ? -1 : 0, buttons: 1,
  }));
  canvas.setPointerCapture = () => {}; // there is no such pointer
  const key = (type) => canvas.dispatchEvent(new KeyboardEvent(type, { key: 'Home' }));
  key('keydown'); // so that the frame to compare with is drawn
  const before = await frame();
  const began = performance.now();
  send('pointerdown', 0);
  send('pointermove', 4);
  const now = await frame();
  const spent = performance.now() - began;
  send('pointerup', 4);
  return { before, now, spent };
}`;

/**
 * Paints at a position of the page.
 * @returns The places of the canvas that have changed in the first frame after it, as shares of its size, and the milliseconds from
 * the pointer to the end of that frame.
 */
async function stroke(
  page: Page,
  at: { x: number; y: number },
): Promise<{ places: [number, number][]; spent: number }> {
  const taken = await page.evaluate(`(${paintOnce})(${JSON.stringify(at)})`);
  const { spent, ...urls } = taken as { before: string; now: string; spent: number };
  const pngOf = (url: string): PNG => PNG.sync.read(Buffer.from(url.split(',')[1]!, 'base64'));
  const [before, { width, height, data }] = [pngOf(urls.before), pngOf(urls.now)];
  const changed = new Set<number>();
  for (let i = 0; i < data.length; i += 4)
    if ([0, 1, 2].some((c) => Math.abs(data[i + c]! - before.data[i + c]!) > 24)) changed.add(i / 4);
  const places: [number, number][] = [];
  while (changed.size > 0) {
    const [first] = changed;
    const queue = [first!];
    const found: number[] = [];
    for (let pixel = queue.pop(); pixel !== undefined; pixel = queue.pop()) {
      if (!changed.delete(pixel)) continue;
      found.push(pixel);
      for (let dy = -2; dy <= 2; dy++) for (let dx = -2; dx <= 2; dx++) queue.push(pixel + dy * width + dx);
    }
    const mean = (of: (pixel: number) => number): number => found.reduce((sum, one) => sum + of(one), 0) / found.length;
    if (found.length >= 3)
      places.push([mean((pixel) => pixel % width) / width, mean((pixel) => Math.floor(pixel / width)) / height]);
  }
  return { places, spent };
}

test('figures dropped together get the template of the first; a stroke is on all six in the next frame; all are saved', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 700 }, deviceScaleFactor: 0.5 });
  const broken = glb('broken.glb', Buffer.from('this is no model'));
  const names = ['one', 'two', 'three', 'four', 'five', 'six'];
  await drop(page, [...names.slice(0, 2).map(figure), broken, ...names.slice(2).map(figure)]);
  const dropped = await avatars(page, 6);
  assert.match(await shownError(page), /^broken\.glb: this is not a GLB or glTF file/);
  assert.match(dropped[0]!, /^one, /);
  for (const label of dropped.slice(1)) assert.match(label, /, no cage$/);
  await page.locator('#alert-close').click();

  await page.locator('#template-select').selectOption('human-body');
  await page.getByTestId('fit-cage').click();
  await page.waitForFunction(() => !/no cage/.test(document.querySelector('.avatars')!.textContent!), undefined, {
    timeout: 60_000,
  });
  for (const label of await avatars(page, 6)) assert.match(label, /, \d+ % paintable, (good|with reservations)$/);
  assert.ok(await page.getByTestId('wardrobe-note').isHidden(), 'the paint fits all');
  assert.match(
    (await page.locator('#tools label:has(:checked)').textContent())!,
    /Turn/,
    'no tool for one model alone',
  );
  const pictures = () =>
    page.locator('.avatars img').evaluateAll((images) => images.map((image) => (image as HTMLImageElement).src));
  await page.locator('#landmark-show').click();
  await page.locator('label', { hasText: 'Zones' }).click();
  const before = (await pictures())[0]!;
  const shown = page.getByTestId('layer-list').locator('[name=visible]').first();
  await shown.setChecked(false, { force: true }); // so that pictures are taken again
  await page.waitForFunction(
    (before) => document.querySelector<HTMLImageElement>('.avatars img')!.src !== before,
    before,
  );
  const [first, second] = (await pictures()).map(
    (url) => PNG.sync.read(Buffer.from(url.split(',')[1]!, 'base64')).data,
  );
  const differing = first!.filter((value, i) => Math.abs(value - second![i]!) > 24).length;
  assert.ok(differing < 100, `${differing}: the first has no landmarks in its picture, as the second has none`);
  await shown.setChecked(true, { force: true });
  await page.locator('label', { hasText: 'Result' }).click();
  assert.deepEqual(await faults(page), []);

  await page.locator('#tools label', { hasText: 'Brush' }).click();
  const at = (await page.locator('#view').boundingBox())!;
  const { places, spent } = await stroke(page, { x: at.x + 0.26 * at.width, y: at.y + 0.24 * at.height });
  assert.equal(places.length, 6, `in ${spent} ms, at ${JSON.stringify(places)}`);

  const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId('export-all').click()]);
  assert.equal(download.suggestedFilename(), 'avatars-painted.zip');
  const files = unzip(readFileSync(await download.path()));
  assert.deepEqual(
    [...files.keys()],
    names.map((name) => `${name}-painted.glb`),
  );
  for (const bytes of files.values()) {
    const document = await validModel(bytes);
    const [overlay] = document
      .getRoot()
      .listMaterials()
      .filter((material) => material.getName() === 'Cagecast overlay');
    const { data } = PNG.sync.read(Buffer.from(overlay!.getBaseColorTexture()!.getImage()!));
    assert.ok(
      data.some((value, i) => i % 4 === 3 && value > 0),
      'there is paint',
    );
  }
  await page.locator('.avatars .avatar').nth(1).click();
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: 'two' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.ok(await page.getByTestId('save-cage').isVisible(), 'the cage that was fitted to it can be saved');
  await page.getByTestId('landmarks').waitFor();
  assert.equal(await page.locator('#tools input[data-key=b]').isChecked(), true, 'the brush stays in the hand');
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

test('twelve avatars are taken; the thirteenth is refused by name, and finds room when one is removed', async () => {
  const { page, complaints } = await site.visit();
  const model = (name: string): Upload => glb(`${name}.glb`, glbOf(tetrahedron()));
  const names = Array.from({ length: 12 }, (_, i) => `figure-${i + 1}`);
  await drop(page, [...names, 'one-too-many'].map(model));
  const full = 'The wardrobe is full: it holds 12 avatars, and one-too-many found no room. Remove one first.';
  await page.locator('#error', { hasText: full }).waitFor();
  const labels = await avatars(page, 12);
  names.forEach((name, i) => assert.match(labels[i]!, new RegExp(`^${name}, `)));
  assert.ok(await page.getByTestId('wardrobe-input').isDisabled());
  await page.locator('#alert-close').click();
  await drop(page, [model('one-too-many')]);
  await page.locator('#error', { hasText: full }).waitFor();

  await page.locator('#alert-close').click();
  await page.getByRole('button', { name: 'Remove figure-1', exact: true }).click();
  await avatars(page, 11);
  await drop(page, [model('one-too-many')]);
  assert.match((await avatars(page, 12)).at(-1)!, /^one-too-many, /);
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

/** Waits until the browser keeps the wardrobe so that an expression of it has a value. @param what  Of `wardrobe`. */
async function keptAs(page: Page, what: string, value: unknown): Promise<void> {
  const read = `new Promise((done) => {
    indexedDB.open('cagecast').onsuccess = ({ target: { result } }) => {
      result.transaction('works').objectStore('works').getAll().onsuccess = (event) => {
        result.close();
        const { wardrobe } = event.target.result[0]?.parts ?? {};
        done(wardrobe && ${what});
      };
    };
  })`;
  for (const end = Date.now() + 60_000; (await page.evaluate(read)) !== value; ) {
    assert.ok(Date.now() < end, 'it is not kept');
    await page.waitForTimeout(200);
  }
}

test('the avatars are back after a reload, with their cages, overrides and order, and are in the project file', async () => {
  const { page, complaints } = await site.visit();
  await page.getByTestId('open-wardrobe').click();
  await avatars(page, 1);
  await drop(page, [
    glb('bust.glb', asset('human', 'target.glb')),
    glb('bust-cage.glb', asset('human-misaligned', 'cage.glb')),
  ]);
  await page.getByTestId('wardrobe-sample').selectOption('car');
  await avatars(page, 3);
  // What is excluded of one is remembered while another is on the stage.
  await page.locator('.avatars .avatar').nth(1).click();
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: 'bust' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.locator('#parts summary').click();
  await page.locator('#segment-rows select').first().selectOption('exclude');
  await page.locator('.avatars .avatar').nth(2).click();
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: /car/i }).waitFor();
  const before = await avatars(page, 3);
  assert.equal(await settled(page), 'ready', await shownError(page));
  const chosen = (): Promise<(string | null)[]> =>
    page.locator('.avatars .avatar').evaluateAll((all) => all.map((one) => one.ariaPressed));
  assert.deepEqual(await chosen(), ['false', 'false', 'true']);

  await keptAs(page, 'wardrobe.at', 2);
  await page.reload();
  await page.getByTestId('kept').filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.deepEqual(await avatars(page, 3), before);
  assert.deepEqual(await chosen(), ['false', 'false', 'true']);
  assert.ok(await page.getByTestId('show-all').isChecked());
  assert.deepEqual(await faults(page), []);
  const project = await saved(page, 'save-project');

  const fresh = await site.visit();
  await drop(fresh.page, [{ name: project.name, mimeType: '', buffer: project.bytes }]);
  assert.deepEqual(await avatars(fresh.page, 3), before);
  await fresh.page.locator('.avatars .avatar').nth(1).click();
  await fresh.page.locator('.avatars .avatar[aria-pressed=true]', { hasText: 'bust' }).waitFor();
  assert.equal(await settled(fresh.page), 'ready', await shownError(fresh.page));
  assert.equal(await fresh.page.locator('#segment-rows select').first().inputValue(), 'exclude');
  assert.deepEqual([...complaints, ...fresh.complaints], []);
});

/** Notes the presets of the transfers that are asked for, and lets each wait for `window.delay` milliseconds. */
const kSlowTransfers = `const { postMessage } = Worker.prototype;
Object.assign(window, { asked: [], delay: 0 });
Worker.prototype.postMessage = function (message, ...rest) {
  const post = () => postMessage.call(this, message, ...rest);
  if (message?.task !== 'project') return post();
  window.asked.push(message.options.preset);
  if (window.delay > 0) setTimeout(post, window.delay);
  else post();
}`;

test('avatars that still wait are back after a reload; of two that are chosen at once, the last one comes', async () => {
  const { page, complaints } = await site.visit({}, kSlowTransfers);
  await page.getByTestId('open-wardrobe').click();
  await avatars(page, 1);
  await page.evaluate('window.delay = 5000');
  const names = ['one', 'two', 'three', 'four'];
  const model = (name: string): Upload => glb(`${name}.glb`, asset('lizard', 'target.glb'));
  await drop(page, [...names.map(model), glb('cage.glb', asset('lizard', 'cage.glb'))]);
  await keptAs(page, 'wardrobe.avatars.length', 4);
  assert.match((await page.locator('.avatars .avatar', { hasText: 'four' }).textContent())!, /Waiting/);
  await page.reload();
  await page.getByTestId('kept').filter({ hasText: 'Your last work is back.' }).waitFor();
  const labels = await avatars(page, 5);
  for (const [i, name] of names.entries())
    assert.match(labels[i + 1]!, new RegExp(`^${name}, \\d+ % paintable, good$`));

  const card = (at: number) => page.locator('.avatars .avatar').nth(at);
  await page.evaluate(() => {
    const cards = document.querySelectorAll<HTMLElement>('.avatars .avatar');
    for (const at of [1, 2, 1, 0]) cards[at]!.click();
  });
  await page.waitForTimeout(3000);
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(await card(0).getAttribute('aria-pressed'), 'true');
  assert.deepEqual(complaints, []);
});

test('an avatar that leaves the stage, and one that is just being painted, follow the preset', async () => {
  const { page, complaints } = await site.visit({}, kSlowTransfers);
  /** Waits until so many transfers have been asked for, by a preset, since the last time. */
  const asked = async (preset: string, count: number): Promise<void> => {
    const wanted = JSON.stringify(Array.from({ length: count }, () => preset));
    await page.waitForFunction(
      (wanted) => JSON.stringify((window as unknown as { asked: string[] }).asked) === wanted,
      wanted,
    );
    await page.waitForTimeout(1000);
    assert.equal(await page.evaluate('JSON.stringify(window.asked)'), wanted);
    await page.evaluate('window.asked = []');
  };
  const model = (name: string): Upload => glb(`${name}.glb`, asset('lizard', 'target.glb'));
  const cage = glb('cage.glb', asset('lizard', 'cage.glb'));
  await drop(page, [model('one'), cage]);
  await page.getByTestId('open-wardrobe').click();
  await avatars(page, 1);
  await drop(page, [model('two'), cage]);
  await avatars(page, 2);
  await page.evaluate('window.asked = []');
  await page.locator('.avatars .avatar').nth(1).click();
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: 'two' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  await asked('default', 2); // of the one that comes, and of the one that now stands beside it
  await page.getByTestId('preset').selectOption('paper');
  await asked('paper', 2); // of both
  await page.locator('.avatars .avatar').nth(0).click();
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: 'one' }).waitFor();
  await asked('paper', 2); // of the one that comes, and of the other, which stood beside it when that was default

  await page.evaluate('window.delay = 3000');
  await drop(page, [model('three'), cage]);
  await asked('paper', 1);
  await page.evaluate('window.delay = 0');
  await page.getByTestId('preset').selectOption('default');
  await asked('default', 3);
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

test('an avatar whose loading was cancelled can be chosen again; the focus stays in the strip where one is removed', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 700 } }, kSlowTransfers);
  await drop(page, ['one', 'two', 'three'].map(figure));
  await avatars(page, 3);
  await page.evaluate('window.delay = 3000');
  const second = page.locator('.avatars .avatar', { hasText: 'two' });
  await page.locator('#template-select').selectOption('human-body');
  await page.getByTestId('fit-cage').click();
  await page.waitForFunction(() => !/no cage/.test(document.querySelector('.avatars')!.textContent!), undefined, {
    timeout: 60_000,
  });
  await avatars(page, 3);
  await second.click();
  await page.getByTestId('cancel').click();
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.evaluate('window.delay = 0');
  await second.click();
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: 'two' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.getByRole('button', { name: 'Remove two' }).press('Enter');
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: 'three' }).waitFor();
  assert.ok(await page.evaluate(() => document.activeElement!.closest('.avatars') !== null));
  assert.deepEqual(complaints, []);
});

/** Opens the wardrobe with a model on the stage, and puts another one beside it, to which the cage is being fitted. */
async function beingFitted(): Promise<Visit> {
  const visit = await site.visit({}, holdingBack('refineCage', 'makeCage'));
  const { page } = visit;
  const model = (name: string): Upload => glb(name, asset('lizard', 'target.glb'));
  await drop(page, [model('one.glb'), glb('cage.glb', asset('lizard', 'cage.glb'))]);
  await page.locator('#target-name', { hasText: 'one.glb' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.getByTestId('open-wardrobe').click();
  await drop(page, [model('two.glb')]);
  await heldBack(page);
  return visit;
}

/** Puts an avatar on the stage. @param at Its place in the row. */
async function choose(page: Page, at: number): Promise<void> {
  await page.locator('.avatars .avatar').nth(at).click();
  await page.locator(`.avatars li:nth-child(${at + 1}) .avatar[aria-pressed=true]`).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
}

test('an avatar that comes on the stage while a cage is fitted to it gets that cage, unless another is chosen there', async () => {
  const { page, complaints } = await beingFitted();
  await choose(page, 1);
  await page.evaluate('window.letGo()');
  await page.locator('#cage-name', { hasText: 'two-cage.glb' }).waitFor();
  for (const name of ['one', 'two'])
    await page.locator('.avatars .avatar', { hasText: new RegExp(`^${name}, \\d+ % paintable, `) }).waitFor();
  assert.deepEqual(complaints, []);

  const chosen = await beingFitted();
  await choose(chosen.page, 1);
  await drop(chosen.page, [glb('own-cage.glb', asset('human-misaligned', 'cage.glb'))]);
  await chosen.page.locator('#cage-name', { hasText: 'own-cage.glb' }).waitFor();
  assert.equal(await settled(chosen.page), 'ready', await shownError(chosen.page));
  await chosen.page.evaluate('window.letGo()');
  await avatars(chosen.page, 2);
  await choose(chosen.page, 0);
  await choose(chosen.page, 1);
  assert.equal(await chosen.page.locator('#cage-name').textContent(), 'own-cage.glb');
  assert.deepEqual(chosen.complaints, []);
});

/** Chooses the sample of a car. @returns Lets it come. */
async function chooseHeldCar(page: Page): Promise<() => void> {
  let letGo = (): void => {};
  const held = new Promise<void>((done) => (letGo = done));
  await page.route(/car/, (route) => held.then(() => route.continue()));
  await page.evaluate(() => {
    const samples = document.querySelector<HTMLSelectElement>('#sample-select')!;
    samples.value = 'car';
    samples.dispatchEvent(new Event('change'));
  });
  return letGo;
}

test('a cage fitted to an avatar does not reach a sample that is loading, whether that avatar had come or not', async () => {
  for (const comes of [true, false]) {
    const { page, complaints } = await beingFitted();
    if (comes) await choose(page, 1);
    else await page.evaluate("document.querySelectorAll('.avatars .avatar')[1].click()");
    const letGo = await chooseHeldCar(page);
    await page.evaluate('window.letGo()');
    await page.waitForFunction(() => !/Waiting|Fitting/.test(document.querySelector('.avatars')!.textContent!));
    letGo();
    await page.locator('#target-name', { hasText: 'target.glb' }).waitFor();
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.equal(await page.locator('#cage-name').textContent(), 'cage.glb');
    assert.deepEqual(complaints, []);
  }
});

test('an avatar that was chosen, and then a sample, can be chosen again before that has come', async () => {
  for (const comes of [true, false]) {
    const { page, complaints } = await beingFitted();
    const second = page.locator('.avatars .avatar').nth(1);
    if (comes) await choose(page, 1);
    else await page.evaluate("document.querySelectorAll('.avatars .avatar')[1].click()");
    const letGo = await chooseHeldCar(page);
    await second.click();
    await page.locator('.avatars li:nth-child(2) .avatar[aria-pressed=true]').waitFor();
    letGo();
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.equal(await page.locator('#target-name').textContent(), 'two.glb');
    assert.notEqual(await page.getByTestId('sample-select').inputValue(), 'car');
    assert.deepEqual(complaints, []);
  }
});

test('“Fit this cage to all” fits the cage that was on the stage then, whatever comes there meanwhile', async () => {
  const { page, complaints } = await site.visit({}, holdingBack('refineCage'));
  await page.getByTestId('open-wardrobe').click();
  await avatars(page, 1);
  for (const [at, name] of ['human', 'car'].entries()) {
    await page.getByTestId('wardrobe-sample').selectOption(name);
    await avatars(page, at + 2);
  }
  await page.getByTestId('fit-all').click();
  await heldBack(page);
  await choose(page, 2);
  await page.evaluate('window.letGo()');
  await page.waitForFunction(
    () => !/Waiting|Fitting|other cage/.test(document.querySelector('.avatars')!.textContent!),
    undefined,
    { timeout: 60_000 },
  );
  await choose(page, 0);
  assert.ok(await page.getByTestId('wardrobe-note').isHidden(), 'all take its paint');
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

test('what is on the stage is in the list, though avatars are removed, or models opened, before the next one has come', async () => {
  const { page, complaints } = await site.visit();
  await page.getByTestId('open-wardrobe').click();
  await avatars(page, 1);
  for (const [at, name] of ['human', 'car', 'human-fused'].entries()) {
    await page.getByTestId('wardrobe-sample').selectOption(name);
    await avatars(page, at + 2);
  }
  const names = await page.locator('.avatars .name').allTextContents();
  const remove = `document.activeElement.dispatchEvent(new KeyboardEvent('keydown', { key: 'Delete', bubbles: true }));`;
  await page.locator('.avatars .avatar').first().focus();
  await page.evaluate(remove + remove);
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: names[2]! }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await page.locator('.avatars .name').allTextContents(), names.slice(2));
  assert.equal(await page.getByTestId('sample-select').inputValue(), 'car');

  await page.locator('.avatars .avatar').first().focus();
  await page.evaluate(
    `${remove} const samples = document.querySelector('#sample-select'); samples.value = 'human'; samples.dispatchEvent(new Event('change'));`,
  );
  await page.locator('.avatars .avatar[aria-pressed=true]', { hasText: names[1]! }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await page.locator('.avatars .name').allTextContents(), [names[1], names[3]]);
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

test('a sample that is loading comes, though the avatar on the stage is removed meanwhile', async () => {
  const { page, complaints } = await site.visit();
  await page.getByTestId('open-wardrobe').click();
  await avatars(page, 1);
  await page.getByTestId('wardrobe-sample').selectOption('human');
  await avatars(page, 2);
  const names = await page.locator('.avatars .name').allTextContents();
  const letGo = await chooseHeldCar(page);
  await page.locator('.avatars .avatar').first().press('Delete');
  letGo();
  await page.locator('.avatars .avatar[aria-pressed=true] img').waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(await page.getByTestId('sample-select').inputValue(), 'car');
  const now = await page.locator('.avatars .name').allTextContents();
  assert.deepEqual(now.slice(1), names.slice(1), 'the other one stays');
  assert.notEqual(now[0], names[0]);
  assert.deepEqual(complaints, []);
});

test('of all avatars to which the cage cannot be fitted, it says why', async () => {
  const { page, complaints } = await site.visit();
  const names = ['two', 'three'];
  await drop(page, [figure('one'), ...names.map((name) => glb(`${name}.glb`, glbOf(tetrahedron())))]);
  await avatars(page, 3);
  await page.locator('#template-select').selectOption('human-body');
  await page.getByTestId('fit-cage').click();
  await page.locator('#cage-note', { hasText: 'was fitted' }).waitFor();
  await page.locator('#error', { hasText: 'three: ' }).waitFor();
  const told = await shownError(page);
  for (const name of names) assert.match(told, new RegExp(`\\b${name}: `));
  assert.deepEqual(complaints, []);
});

/** An avatar on the stage for which a cage is being made; a fit to it, which came meanwhile, has given way to that. */
async function givenWay(): Promise<Visit> {
  const visit = await beingFitted();
  const { page } = visit;
  await choose(page, 1);
  await page.getByTestId('make-cage').click();
  await page.locator('#status[data-state=working]').waitFor({ state: 'attached' });
  await page.evaluate('window.held.pop()()');
  await page.waitForFunction(() => !/Waiting|Fitting/.test(document.querySelector('.avatars')!.textContent!));
  return visit;
}

test('a cage that is being made for an avatar is not replaced by one that was being fitted to it', async () => {
  const { page, complaints } = await givenWay();
  await page.evaluate('window.letGo()');
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(complaints, []);
});

test('an avatar whose cage was cancelled while it was made is fitted again, if a fit has given way to that', async () => {
  const { page, complaints } = await givenWay();
  await page.getByTestId('cancel').click();
  await heldBack(page);
  await page.evaluate('window.letGo()');
  await page.locator('#cage-name', { hasText: 'two-cage.glb' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(complaints, []);
});
