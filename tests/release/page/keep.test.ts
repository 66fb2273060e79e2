import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { faults } from '../../support/axe';
import { asset } from '../../support/cages';
import { filled, image, names, rows, savedTexture } from '../../support/layers';
import { modelArea } from '../../support/picture';
import { saved } from '../../support/saved';
import { drop, glb, passed, Site, settled, shownCounts, shownError, shownParts } from '../../support/site';

const project = (name: string, buffer: Buffer) => ({ name, mimeType: '', buffer });

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

/** Opens a model and a cage of the visitor's own. */
async function openOwn(page: Page): Promise<void> {
  await drop(page, [
    glb('bust.glb', asset('human', 'target.glb')),
    glb('bust-cage.glb', asset('human-misaligned', 'cage.glb')),
  ]);
  assert.equal(await settled(page), 'ready', await shownError(page));
}

/** All that somebody would miss. */
async function state(page: Page) {
  assert.equal(await settled(page), 'ready', await shownError(page));
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
  await page.locator('#parts summary').click();
  const part = (await shownParts(page))[0]!.name;
  await page.getByLabel(`Override for ${part}`, { exact: true }).selectOption('exclude');
  await page.getByTestId('threshold').fill('0.7');
  await page.getByTestId('preset').selectOption('paper');
  assert.equal(await settled(page), 'ready', await shownError(page));
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
  const line = page.getByTestId('kept');
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
  assert.equal(await settled(page), 'ready', await shownError(page));
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
  assert.ok(await other.getByTestId('kept').isHidden());
  await other.close();
  assert.deepEqual(complaints, []);
});

test('saved state that is broken, old or crashes the page does not stop the page from opening', async () => {
  const { page } = await site.visit({ viewport: { width: 900, height: 600 } });
  await page.getByTestId('add-painting').click();
  await stroke(page);
  await kept(page);
  const before = await state(page);
  const line = page.getByTestId('kept');

  /** Changes the stored work by a function's text, and reloads the page. @returns What it says then. */
  const reloaded = async (change: string): Promise<string> => {
    await page.evaluate(
      `new Promise((done, fail) => {
        const request = indexedDB.open('cagecast');
        request.onsuccess = () => {
          const transaction = request.result.transaction(['works'], 'readwrite');
          const works = transaction.objectStore('works');
          works.getAll().onsuccess = ({ target: { result: [work, ...others] } }) => {
            for (const { slot } of others) works.delete(slot);
            sessionStorage.setItem('cagecast-slot', work.slot);
            (${change})(work);
            works.put(work);
          };
          transaction.oncomplete = () => { request.result.close(); done(); };
          transaction.onabort = fail;
        };
      })`,
    );
    await page.reload();
    await line.locator('p', { hasText: /./ }).waitFor();
    await page.waitForFunction(
      () => document.querySelector('#target-name')!.textContent !== 'none yet' && document.querySelector('#view-mode'),
    );
    return (await line.locator('p').textContent())!;
  };
  const copy = await page.evaluate<unknown>(
    `new Promise((done) => { indexedDB.open('cagecast').onsuccess = ({ target: { result } }) => { result.transaction('works').objectStore('works').getAll().onsuccess = (event) => { result.close(); done(event.target.result[0]); }; }; })`,
  );
  const mend = `Object.assign(work, ${JSON.stringify(copy)})`;
  for (const [change, message] of [
    ['(work) => { work.version = 99; }', /could not be brought back: it was saved by another version/],
    [`(work) => { ${mend}; work.parts.models = 7; }`, /could not be brought back: the project is damaged/],
    [
      `(work) => { ${mend}; work.parts.layers.layers[0].sheet.file = 'gone'; work.parts.layers.layers[0].sheet.paint = ''; }`,
      /could not be brought back: the project is damaged: a file is missing/,
    ],
  ] as const) {
    assert.match(await reloaded(change), message);
    assert.ok((await shownCounts(page)).cosmetic > 0, 'a sample is open');
  }
  // It took the page down: it is brought back only when asked for.
  await page.evaluate(() => localStorage.setItem('cagecast-work', 'opening'));
  assert.match(await reloaded(`(work) => { ${mend}; }`), /did not get to show it/);
  await page.getByRole('button', { name: 'Bring it back' }).click();
  await line.filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.deepEqual(await state(page), before);
});

test('own files that give way to a sample are put aside, and brought back when asked for', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } });
  await openOwn(page);
  await stroke(page);
  await kept(page);
  await page.getByTestId('threshold').fill('0.7'); // which is not stored yet
  const before = await state(page);
  const line = page.getByTestId('kept');
  for (const open of [
    () => page.getByTestId('sample-select').selectOption('car'),
    () => page.evaluate(() => void (location.hash = '#sample=lizard')),
  ]) {
    await open();
    await line.filter({ hasText: 'Your last work is put aside.' }).waitFor();
    assert.equal(await settled(page), 'ready', await shownError(page));
    await page.locator('.files .name', { hasText: 'bust' }).first().waitFor({ state: 'detached' });
    await page.getByRole('button', { name: 'Bring it back' }).click();
    await line.filter({ hasText: 'Your last work is back.' }).waitFor();
    assert.deepEqual(await state(page), before);
  }
  assert.deepEqual(complaints, []);
});

test('work that gives way to what is brought back is put aside in turn', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } });
  await openOwn(page);
  await stroke(page);
  await kept(page);
  const line = page.getByTestId('kept');
  const back = page.getByRole('button', { name: 'Bring it back' });
  await page.getByTestId('sample-select').selectOption('car');
  await line.filter({ hasText: 'put aside' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.getByTestId('threshold').fill('0.7');
  const other = await state(page);
  await back.click();
  await line.filter({ hasText: 'What was here is put aside.' }).waitFor();
  assert.match((await page.locator('.files .name').allTextContents()).join(), /bust/);
  await back.click();
  await line.filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.deepEqual(await state(page), other);
  assert.deepEqual(complaints, []);
});

test('work that gives way is not said to be put aside as a whole if there was no room for its last changes', async () => {
  const { page } = await site.visit({ viewport: { width: 900, height: 600 } }, kFull);
  await openOwn(page);
  await page.getByTestId('kept-note').filter({ hasText: 'Your work is kept on this device' }).waitFor();
  await page.evaluate('window.full = true');
  await page.getByTestId('add-painting').click();
  await page.locator('#error', { hasText: 'there is no room left' }).waitFor();
  const line = page.getByTestId('kept');
  await page.getByTestId('sample-select').selectOption('car');
  await line.filter({ hasText: 'is put aside. Its last changes could not be kept: there is no room left' }).waitFor();
  await page.getByRole('button', { name: 'Bring it back' }).click();
  await line.filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.ok(!(await names(page)).includes('Painting 1'));
});

test('a tab beside one that has the latest work offers the one before', async () => {
  const { page } = await site.visit({ viewport: { width: 900, height: 600 } });
  const visit = async (): Promise<Page> => {
    const one = await page.context().newPage();
    await one.goto(site.url);
    assert.equal(await settled(one), 'ready', await shownError(one));
    return one;
  };
  const values = ['0.6', '0.7'];
  const tabs = await Promise.all([visit(), visit()]);
  for (const [i, tab] of tabs.entries()) {
    await tab.getByTestId('threshold').fill(values[i]!);
    await kept(tab);
  }
  for (const tab of tabs) await tab.close();
  await page.waitForFunction(async () => {
    const { held = [] } = await navigator.locks.query();
    return held.length === 1; // their works are free
  });
  const line = (tab: Page) => tab.getByTestId('kept');
  const latest = await visit();
  await line(latest).filter({ hasText: 'Your last work is back.' }).waitFor();
  const other = await visit();
  await line(other).filter({ hasText: 'An earlier work of yours is kept.' }).waitFor();
  await other.getByRole('button', { name: 'Bring it back' }).click();
  await line(other).filter({ hasText: 'Your last work is back.' }).waitFor();
  for (const [i, tab] of [other, latest].entries())
    assert.equal(await tab.getByTestId('threshold').inputValue(), values[i]);
});

test('starting over offers the work of this tab, although another one has later work', async () => {
  const { page } = await site.visit({ viewport: { width: 900, height: 600 } });
  await page.getByTestId('threshold').fill('0.7');
  await kept(page);
  await page.reload();
  const line = page.getByTestId('kept');
  await line.filter({ hasText: 'Your last work is back.' }).waitFor();
  const other = await page.context().newPage();
  await other.goto(site.url);
  assert.equal(await settled(other), 'ready', await shownError(other));
  await other.getByTestId('threshold').fill('0.6');
  await kept(other);
  await Promise.all([page.waitForEvent('load'), page.getByRole('button', { name: 'Start over' }).click()]);
  await line.filter({ hasText: 'put aside' }).waitFor();
  await page.getByRole('button', { name: 'Bring it back' }).click();
  await line.filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.equal(await page.getByTestId('threshold').inputValue(), '0.7');
});

/** Lets no blob be read while `window.gone` is set, as files that were changed or deleted cannot be. */
const kGone = `
  const { arrayBuffer } = Blob.prototype;
  Blob.prototype.arrayBuffer = function () {
    return window.gone ? Promise.reject(new DOMException('gone', 'NotReadableError')) : arrayBuffer.call(this);
  }`;

test('a project is not said to be saved if a file of it cannot be read any more', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } }, kGone);
  await openOwn(page);
  await page.evaluate('window.gone = true');
  await page.getByTestId('save-project').click();
  await page.locator('#alert').waitFor();
  assert.match(await shownError(page), /could not be saved: bust\.glb: the file was changed or deleted/);
  assert.deepEqual(complaints, []);
});

test('the work is back after a reload, too, when a link to it is in the address', async () => {
  const { page, complaints } = await site.visit({ permissions: ['clipboard-read', 'clipboard-write'] });
  await stroke(page);
  await kept(page);
  await page.getByTestId('share-link').click();
  await page.locator('#copy-note', { hasText: 'copied' }).waitFor();
  const isKept = `new Promise((done) => {
    indexedDB.open('cagecast').onsuccess = ({ target: { result } }) => {
      result.transaction('works').objectStore('works').getAll().onsuccess = ({ target }) => {
        result.close();
        done(location.hash !== '' && target.result.some(({ fragment }) => fragment === location.hash));
      };
    };
  })`;
  for (const end = Date.now() + 60_000; !(await page.evaluate(isKept)); await page.waitForTimeout(100))
    assert.ok(Date.now() < end, 'the link is not kept');
  await page.reload();
  await page.getByTestId('kept').filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.ok((await names(page)).includes('Painting 1'));
  assert.deepEqual(complaints, []);
});

test('a project file holds everything; a damaged or hostile one is reported in one sentence and changes nothing', async () => {
  const first = await site.visit({ viewport: { width: 900, height: 600 } });
  await work(first.page);
  const before = await state(first.page);
  const { name, bytes } = await saved(first.page, 'save-project');
  assert.equal(name, 'bust.cagecast');

  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } });
  await page.getByTestId('threshold').fill('0.35');
  const untouched = await state(page);
  const length = bytes.readUInt32LE(12);
  const text = bytes.subarray(16, 16 + length).toString();
  /** The project with another text. */
  const edited = (change: (text: string) => string): Buffer => {
    const changed = Buffer.from(change(text));
    const head = Buffer.from(bytes.subarray(0, 16));
    head.writeUInt32LE(changed.length, 12);
    return Buffer.concat([head, changed, bytes.subarray(16 + length)]);
  };
  const newer = Buffer.from(bytes);
  newer.writeUInt32LE(9, 8);
  const lying = Buffer.from(bytes);
  lying.writeUInt32LE(2 ** 32 - 1, 12);
  for (const [damaged, message] of [
    [Buffer.from('not a project'), /^x\.cagecast: this is not a Cagecast project$/],
    [Buffer.alloc(0), /^x\.cagecast: this is not a Cagecast project$/],
    [bytes.subarray(0, 200), /^x\.cagecast: the project is damaged: its text cannot be read$/],
    [bytes.subarray(0, -100), /^x\.cagecast: the project is damaged: it ends too early$/],
    [newer, /^x\.cagecast: this project was saved by a newer version/],
    [lying, /^x\.cagecast: the project is damaged: its text is too long$/],
    [edited((all) => all.replace('"size":1024', '"size":2048')), /^x\.cagecast: a painting is incomplete$/],
    [edited((all) => all.replace('"size":1024', '"size":99999')), /^x\.cagecast: .*a painting has an unknown size$/],
    [edited(() => '{"parts":{"models":{}},"files":[]}'), /^x\.cagecast: the project is damaged: it has no model$/],
    [edited(() => '[[[['), /^x\.cagecast: the project is damaged: its text cannot be read$/],
    [
      Buffer.concat([bytes.subarray(0, 16 + length), Buffer.alloc(bytes.length - 16 - length, 1)]),
      /^x\.cagecast: (bust\.glb|stripes\.png): /, // all files are damaged, and read at once
    ],
  ] as const) {
    await drop(page, [project('x.cagecast', damaged)]);
    await page.locator('#error', { hasText: 'x.cagecast' }).waitFor();
    assert.match(await shownError(page), message);
    await page.locator('#alert-close').click();
    assert.equal(await page.getByTestId('status').textContent(), 'error');
    const now = await page.evaluate(() => document.querySelector('#target-name')!.textContent);
    assert.equal(now, untouched.files[0]);
  }
  await page.getByTestId('preset').selectOption('paper');
  assert.equal(await settled(page), 'ready');
  await page.getByTestId('preset').selectOption('default');
  assert.deepEqual(await state(page), untouched);

  await drop(page, [project(name, bytes)]);
  await page.waitForFunction(() => document.querySelector('#target-name')!.textContent === 'bust.glb');
  assert.deepEqual(await state(page), before);
  assert.deepEqual(await faults(page), []);
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
  await passed(page, 1500); // longer than it waits before it tries again
  assert.equal(await shownError(page), '');
  assert.match((await page.getByTestId('kept-note').textContent())!, /is not kept on this device/);
  await saved(page, 'save-project');
  assert.equal(await warns(page), false, 'it is in a file');

  // A link has none of it, and says so before it is copied.
  await page
    .locator('#link-hint', { hasText: 'leaves out Painting 1 and Painting 2: your own paints stay on this device' })
    .waitFor();
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
  const filesOf = (name: string): string => `${name}-cage.glb ${name}.glb`;
  const waitFor = async (page: Page, ...wanted: string[]): Promise<void> => {
    for (const end = Date.now() + 60_000; ; await page.waitForTimeout(200)) {
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
  await page.getByTestId('kept').filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(await page.locator('#target-name').textContent(), 'a.glb');
  assert.equal(await page.getByTestId('threshold').inputValue(), '0.7');
  assert.deepEqual(complaints, []);
});

/** Delays transfers by `window.delay` milliseconds. */
const kSlowTransfers = `
  const { postMessage } = Worker.prototype;
  Worker.prototype.postMessage = function (message, ...rest) {
    const post = () => postMessage.call(this, message, ...rest);
    if (message?.task === 'project' && window.delay) setTimeout(post, window.delay);
    else post();
  }`;

test('a project that takes long to open leaves the work before it as it was', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } }, kSlowTransfers);
  const preset = page.getByTestId('preset');
  await openOwn(page);
  await preset.selectOption('paper');
  assert.equal(await settled(page), 'ready', await shownError(page));
  const { name, bytes } = await saved(page, 'save-project');
  await preset.selectOption('default');
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.getByTestId('threshold').fill('0.7');
  await kept(page);
  await page.evaluate('window.delay = 3000'); // longer than the page waits before it keeps what was changed
  await drop(page, [project(name, bytes)]);
  const line = page.getByTestId('kept');
  await line.filter({ hasText: 'put aside' }).waitFor();
  assert.equal(await preset.inputValue(), 'paper');
  await page.getByRole('button', { name: 'Bring it back' }).click();
  await line.filter({ hasText: 'Your last work is back.' }).waitFor();
  assert.equal(await preset.inputValue(), 'default');
  assert.equal(await page.getByTestId('threshold').inputValue(), '0.7');
  assert.deepEqual(complaints, []);
});

/** After a reload, holds the files of the work back, before they are found or while they are read, until `window.letGo()`. */
const kSlowWork = `
  const held = new Promise((done) => (window.letGo = done));
  const holds = (what) => {
    if (sessionStorage.getItem('holds') !== what) return;
    window.isHeld = true;
    return held;
  };
  const { request } = LockManager.prototype;
  LockManager.prototype.request = async function (...values) {
    const isHeld = holds('finding');
    await isHeld;
    return isHeld ? request.call(this, values[0], values.at(-1)) : request.apply(this, values); // without its patience
  };
  const { arrayBuffer } = Blob.prototype;
  Blob.prototype.arrayBuffer = async function () {
    if (this.name === 'bust.glb') await holds('reading');
    return arrayBuffer.call(this);
  };`;

test('files that are opened before the work is back stay, and the work is offered', async () => {
  for (const what of ['finding', 'reading']) {
    const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } }, kSlowWork);
    await openOwn(page);
    await page.getByTestId('kept-note').filter({ hasText: 'Your work is kept on this device' }).waitFor();
    await page.evaluate((what) => sessionStorage.setItem('holds', what), what);
    await page.reload();
    await page.waitForFunction(() => 'isHeld' in window);
    await drop(page, [
      glb('lizard.glb', asset('lizard', 'target.glb')),
      glb('lizard-cage.glb', asset('lizard', 'cage.glb')),
    ]);
    await page.evaluate('window.letGo()');
    await page.getByTestId('kept').filter({ hasText: 'Your last work is kept.' }).waitFor();
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.equal(await page.locator('#target-name').textContent(), 'lizard.glb', what);
    await page.getByRole('button', { name: 'Bring it back' }).click();
    await page.getByTestId('kept').filter({ hasText: 'Your last work is back.' }).waitFor();
    assert.equal(await page.locator('#target-name').textContent(), 'bust.glb');
    assert.deepEqual(complaints, []);
  }
});
