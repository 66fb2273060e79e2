import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { faults } from '../../support/axe';
import { asset } from '../../support/cages';
import { filled, image, names, rows, savedTexture } from '../../support/layers';
import { modelArea } from '../../support/picture';
import { saved } from '../../support/saved';
import { drop, glb, openSite, ready, settled, shownCounts, shownError, shownParts } from '../../support/site';

const site = await openSite();

/** Opens a model and a cage of the visitor's own. */
async function openOwn(page: Page): Promise<void> {
  await drop(page, [
    glb('bust.glb', asset('human', 'target.glb')),
    glb('bust-cage.glb', asset('human-misaligned', 'cage.glb')),
  ]);
  await ready(page);
}

/** All that somebody would miss. */
async function state(page: Page) {
  await ready(page);
  await page.locator('#live[aria-busy=true]').waitFor({ state: 'detached' });
  const texture = await savedTexture(page);
  const value = (id: string): Promise<string> => page.getByTestId(id).inputValue();
  return {
    files: await page.locator('.files .name').allTextContents(),
    counts: await shownCounts(page),
    overrides: (await shownParts(page)).flatMap(({ name, lock }) => (lock === 'auto' ? [] : [[name, lock]])),
    layers: await names(page),
    opacities: await rows(page)
      .locator('[name=opacity]')
      .evaluateAll((all) => all.map((one) => (one as HTMLInputElement).value)),
    painted: filled(texture),
    texture: createHash('sha256').update(texture.data).digest('hex'),
    threshold: await value('threshold'),
    preset: await value('preset'),
    amount: await value('amount'),
    color: await value('brush-color'),
    mode: await page.locator('#view-mode :checked').inputValue(),
    light: await value('light'),
    background: await page.getByLabel('Own background').isChecked(),
  };
}

/** Whether the page would ask before it is left. */
const warns = (page: Page): Promise<boolean> =>
  page.evaluate(() => !dispatchEvent(new Event('beforeunload', { cancelable: true })));

/** Waits until the browser keeps everything; not after `state`, which saves the texture: then the page does not ask. */
const kept = (page: Page): Promise<unknown> =>
  page.waitForFunction(() => dispatchEvent(new Event('beforeunload', { cancelable: true })));

async function stroke(page: Page): Promise<void> {
  await page.locator('#tools input[data-key=b]').check({ force: true });
  await page.getByTestId('brush-color').fill('#00c040');
  const { x, y, width, height } = await modelArea(page);
  await page.mouse.move(x + 0.5 * width, y + 0.4 * height);
  await page.mouse.down();
  await page.mouse.move(x + 0.55 * width, y + 0.5 * height, { steps: 4 });
  await page.mouse.up();
}

/** Has no room while `window.full` is set. */
const kFull = `
  const { put } = IDBObjectStore.prototype;
  IDBObjectStore.prototype.put = function (...values) {
    if (window.full) throw new DOMException('full', 'QuotaExceededError');
    return put.apply(this, values);
  }`;

/** Opens files and changes everything that can be changed. */
async function work(page: Page): Promise<void> {
  await openOwn(page);
  await drop(page, [image('stripes.png', 64, (x) => [4 * x, 20, 200, x % 8 < 4 ? 255 : 90])]);
  await rows(page).filter({ hasText: 'stripes.png' }).waitFor();
  await rows(page).filter({ hasText: 'stripes.png' }).locator('[name=opacity]').fill('60');
  await stroke(page);
  const part = (await shownParts(page))[0]!.name;
  await page.getByLabel(`Override for ${part}`, { exact: true }).selectOption('exclude');
  await page.getByTestId('threshold').fill('0.7');
  await page.getByTestId('preset').selectOption('paper');
  await ready(page);
  await page.getByTestId('amount').fill('0.4');
  await page.getByTestId('light').selectOption('soft');
  await page.getByLabel('Own background').check();
}

/** Keeps the status at which the picture of the first sample was taken away. */
const kWatchPoster = `new MutationObserver((changes) => {
  if (changes.some(({ removedNodes }) => [...removedNodes].some(({ id }) => id === 'poster')))
    window.posterLeft = document.querySelector('[data-testid=status]').textContent
}).observe(document, { childList: true, subtree: true })`;

test('a reload in the middle of a painting brings everything back, files included; starting over can be taken back', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } }, kWatchPoster);
  await work(page);
  await kept(page);
  const before = await state(page);
  assert.ok(before.painted > 0 && before.layers.includes('Painting 1') && before.overrides.length === 1);
  await page.reload();
  const line = page.getByTestId('ask');
  await line.filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.deepEqual(await state(page), before);
  assert.notEqual(await page.evaluate('posterLeft'), 'ready', 'the picture of the sample does not lie over the work');
  assert.equal(await page.getByTestId('undo').isDisabled(), true);
  assert.deepEqual(await faults(page), []);

  // What is added to it is kept too.
  await stroke(page);
  await kept(page);
  const more = await state(page);
  const button = page.getByRole('button', { name: 'Start over' });
  await button.focus();
  await Promise.all([page.waitForEvent('load'), page.keyboard.press('Enter')]);
  await line.filter({ hasText: 'put aside' }).waitFor();
  await ready(page);
  assert.deepEqual((await names(page)).length, 1, 'the layers of the sample');
  assert.equal(await page.getByTestId('threshold').inputValue(), '0.5');
  assert.deepEqual(await faults(page), []);
  await page.getByRole('button', { name: 'Bring it back' }).click();
  await line.filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.deepEqual(await state(page), more);

  // Another tab does not take it away from this one.
  const other = await page.context().newPage();
  await other.goto(site.url);
  assert.equal(await settled(other), 'ready', await shownError(other));
  assert.ok(await other.getByTestId('ask').isHidden());
  await other.close();
  assert.deepEqual(complaints, []);
});

test('where there is no room, that is said once, and leaving asks', async () => {
  const { page } = await site.visit({ viewport: { width: 900, height: 600 } }, `${kFull}; window.full = true;`);
  assert.equal(await warns(page), false, 'there is nothing to lose');
  await page.getByTestId('add-painting').click();
  await page.locator('#error', { hasText: 'there is no room left' }).waitFor();
  assert.equal(await warns(page), true);
  await page.locator('#alert-close').click();
  await page.getByTestId('add-painting').click();
  assert.match((await page.getByTestId('kept-note').textContent())!, /is not kept on this device/);
  await saved(page, 'save-project');
  assert.equal(await warns(page), false, 'it is in a file');

  // A link has none of it, and says so before it is copied.
  await page.locator('#link-hint', { hasText: 'leaves out Painting 1 and Painting 2: a link has no images' }).waitFor();
  assert.match((await page.getByTestId('share-link').textContent())!, /without your layers/);
});

/** The names of the files of each kept work; those that the browser no longer has are missing. */
async function keptFiles(page: Page): Promise<string[]> {
  const works = await page.evaluate<string[]>(`new Promise((done) => {
    indexedDB.open('cagecast').onsuccess = ({ target: { result } }) => {
      const transaction = result.transaction(['works', 'files']);
      const [works, files] = ['works', 'files'].map((name) => transaction.objectStore(name).getAll());
      const keys = transaction.objectStore('files').getAllKeys();
      const nameOf = (key) => files.result[keys.result.indexOf(key)]?.name ?? 'missing';
      transaction.oncomplete = () => {
        result.close();
        done(works.result.map((work) => work.files.map(nameOf).sort().join(' ')));
      };
    };
  })`);
  return works.sort();
}

test('the works of open tabs are kept however many there are, and a work whose files were dropped is kept whole again', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } });
  const filesOf = (name: string): string => `${name}-cage.glb ${name}.glb flowers.png`;
  const waitFor = async (page: Page, ...wanted: string[]): Promise<void> => {
    for (const end = Date.now() + 60_000; ; await page.evaluate(() => new Promise(requestAnimationFrame))) {
      const found = await keptFiles(page);
      if (wanted.map(filesOf).join() === found.join()) return;
      if (Date.now() > end) assert.deepEqual(found, wanted.map(filesOf));
    }
  };
  const all = ['a', 'b', 'c', 'd'];
  const others: Page[] = [];
  for (const [at, name] of all.entries()) {
    const tab = at === 0 ? page : await page.context().newPage();
    if (at > 0) {
      others.push(tab);
      await tab.goto(site.url);
      assert.equal(await settled(tab), 'ready', await shownError(tab));
    }
    await drop(tab, [
      glb(`${name}.glb`, asset('human', 'target.glb')),
      glb(`${name}-cage.glb`, asset('human-misaligned', 'cage.glb')),
    ]);
    assert.equal(await settled(tab), 'ready', await shownError(tab));
    await waitFor(tab, ...all.slice(0, at + 1));
  }
  for (const tab of others) await tab.close();
  await page.waitForFunction(async () => ((await navigator.locks.query()).held ?? []).length === 1);
  await page.bringToFront();
  await page.getByTestId('threshold').fill('0.6');
  await waitFor(page, 'a', 'c', 'd');

  await page.evaluate(`new Promise((done) => {
    indexedDB.open('cagecast').onsuccess = ({ target: { result } }) => {
      const transaction = result.transaction(['works', 'files'], 'readwrite');
      for (const name of ['works', 'files']) transaction.objectStore(name).clear();
      transaction.oncomplete = () => { result.close(); done(); };
    };
  })`);
  await page.getByTestId('threshold').fill('0.7');
  await waitFor(page, 'a');
  await page.reload();
  await page.getByTestId('ask').filter({ hasText: 'Your last work is back.' }).waitFor();
  await ready(page);
  assert.equal(await page.locator('#target-name').textContent(), 'a.glb');
  assert.equal(await page.getByTestId('threshold').inputValue(), '0.7');
  assert.deepEqual(complaints, []);
});
