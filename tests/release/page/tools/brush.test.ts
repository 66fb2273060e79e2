import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { PNG } from 'pngjs';
import { filled, names, savedTexture, texel } from '../../../support/layers';
import { ball, islandCage } from '../../../support/models';
import { type Area, look, modelArea } from '../../../support/picture';
import { drop, openSite, ready, shownError } from '../../../support/site';

const kWindow = { width: 900, height: 500 };
const site = await openSite();
const visit = await site.visit({ viewport: kWindow, deviceScaleFactor: 1 });

type Spot = readonly [x: number, y: number];

async function choose(tool: 'Brush' | 'Erase'): Promise<void> {
  await visit.page.getByRole('radio', { name: tool }).check({ force: true });
}

async function set(options: Record<string, string>): Promise<void> {
  for (const [name, value] of Object.entries(options)) await visit.page.getByTestId(name).fill(value);
}

/** Draws with the mouse along a line from spot to spot; spots are shares of the picture's area. */
async function draw(area: Area, spots: readonly Spot[], steps = 8): Promise<void> {
  const { mouse } = visit.page;
  for (const [index, [x, y]] of spots.entries()) {
    await mouse.move(area.x + x * area.width, area.y + y * area.height, { steps: index === 0 ? 1 : steps });
    if (index === 0) await mouse.down();
  }
  await mouse.up();
}

/** Puts the mouse where it outlines nothing. */
const away = (): Promise<void> => visit.page.mouse.move(5, 5);

const kHard = { 'brush-hardness': '100', 'brush-opacity': '100', 'brush-color': '#00c040' };

test('a stroke skips unpainted zones, and continues behind them', async () => {
  const { page, complaints } = visit;
  await page.getByTestId('sample-select').selectOption({ index: 0 });
  await ready(page);
  const area = await modelArea(page);
  await page.locator('#view-mode input[value=naive]').check({ force: true });
  const naive = await look(page, area);
  await page.locator('#view-mode input[value=result]').check({ force: true });
  await choose('Brush');
  const bare = await look(page, area);
  const same = (a: PNG, b: PNG, x: number, y: number): boolean =>
    texel(a, x, y).every((value, channel) => Math.abs(value - texel(b, x, y)[channel]!) < 12);
  // The longest row of pixels that the naive transfer alone paints: across an eye.
  let eye = { y: 0, from: 0, to: 0 };
  for (let y = 0; y < 0.5 * bare.height; y++) {
    for (let x = 0, from = 0; x < bare.width; x++) {
      if (same(naive, bare, x, y)) from = x + 1;
      else if (x - from > eye.to - eye.from) eye = { y, from, to: x };
    }
  }
  assert.ok(eye.to - eye.from > 8, JSON.stringify(eye));
  await set({ ...kHard, 'brush-size': '45' });
  const share = (x: number): Spot => [x / area.width, eye.y / area.height];
  await draw(area, [share(eye.from - 25), share(eye.to + 12)], 12);
  await away();
  const painted = await look(page, area);
  const changed = (from: number, to: number): number => {
    let count = 0;
    for (let x = from; x < to; x++) if (!same(bare, painted, x, eye.y)) count++;
    return count / (to - from);
  };
  assert.ok(changed(eye.from - 25, eye.from - 10) > 0.9, 'painted before it');
  assert.ok(changed(eye.from + 2, eye.to - 2) === 0, 'the eye is as it was');
  assert.ok(changed(eye.to + 4, eye.to + 10) > 0.5, 'painted behind it');
  assert.deepEqual(complaints, []);
});

test('strokes survive a lost graphics context', async () => {
  const { page } = visit;
  const before = await savedTexture(page);
  assert.ok(filled(before) > 0);
  await page.evaluate(async () => {
    const canvas = document.querySelector('canvas')!;
    const extension = canvas.getContext('webgl2')!.getExtension('WEBGL_lose_context')!;
    const [lost, restored] = ['webglcontextlost', 'webglcontextrestored'].map(
      (event) => new Promise((done) => canvas.addEventListener(event, done, { once: true })),
    );
    extension.loseContext();
    await lost;
    await new Promise((done) => setTimeout(done)); // not while it is being told
    extension.restoreContext();
    await restored;
  });
  assert.equal(Buffer.compare((await savedTexture(page)).data, before.data), 0);
  await page.getByTestId('undo').click();
  assert.notEqual(Buffer.compare((await savedTexture(page)).data, before.data), 0);
  await page.getByTestId('redo').click();
  assert.equal(Buffer.compare((await savedTexture(page)).data, before.data), 0);
});

test('while the graphics are lost, that is said, and nothing empty is saved', async () => {
  const { page } = visit;
  const change = (to: 'loseContext' | 'restoreContext'): Promise<void> =>
    page.evaluate(async (to) => {
      const canvas = document.querySelector('canvas')!;
      const holder = globalThis as { lost?: WEBGL_lose_context | null };
      const extension = (holder.lost ??= canvas.getContext('webgl2')!.getExtension('WEBGL_lose_context'))!;
      const event = to === 'loseContext' ? 'webglcontextlost' : 'webglcontextrestored';
      const told = new Promise((done) => canvas.addEventListener(event, done, { once: true }));
      extension[to]();
      await told;
      await new Promise((done) => setTimeout(done)); // not while it is being told
    }, to);
  await change('loseContext');
  assert.match(await shownError(page), /^The browser has reset the graphics\. The picture comes back by itself/);
  for (const id of ['save-texture', 'export-glb', 'save-picture']) {
    let isSaved = false;
    page.once('download', () => (isSaved = true));
    await page.getByTestId(id).evaluate((button) => (button as HTMLElement).click());
    await page.locator('#error', { hasText: 'the browser has reset the graphics; try again in a moment' }).waitFor();
    await page.evaluate(() => (document.querySelector('#error')!.textContent = ''));
    assert.equal(isSaved, false, id);
  }
  await change('restoreContext');
  assert.equal(await shownError(page), '');
  assert.ok(filled(await savedTexture(page)) > 0);
});

test('a stroke that goes on while another model comes stays with its cage', async () => {
  const { page, complaints } = await site.visit({ viewport: kWindow });
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  const { x, y, width, height } = await modelArea(page);
  const begin = async (): Promise<void> => {
    await page.mouse.move(x + 0.5 * width, y + 0.4 * height);
    await page.mouse.down();
    await page.mouse.move(x + 0.55 * width, y + 0.45 * height, { steps: 4 });
  };
  await begin();
  await page.mouse.up();
  assert.ok((await names(page)).includes('Painting 1'));
  await begin();
  await drop(page, [await ball(), await islandCage(1)]);
  await ready(page);
  await page.mouse.move(x + 0.6 * width, y + 0.5 * height, { steps: 4 });
  await page.mouse.up();
  assert.deepEqual(await names(page), ['Flowers']);
  await page.getByTestId('ask').getByRole('button', { name: 'Undo' }).click();
  await page.getByTestId('layer-list').getByText('Painting 1').waitFor();
  assert.deepEqual(complaints, []);
});
