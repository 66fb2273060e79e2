import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { faults } from '../../support/axe';
import { asset } from '../../support/cages';
import { saved, validModel } from '../../support/saved';
import { drop, glb, openSite, ready, shownError, type Upload } from '../../support/site';
import { unzip } from '../../support/zip';

const figure = (name: string): Upload => glb(`${name}.glb`, asset('human-body', 'target.glb'));

const site = await openSite();

/** What the cards say of their avatars, once nothing is done to them any more. */
async function avatars(page: Page, count: number): Promise<string[]> {
  await page.waitForFunction(
    (count) => {
      const cards = [...document.querySelectorAll('.avatars .avatar')];
      // Between its share and its verdict, a cage is inspected.
      const isBusy = cards.some((card) => /Waiting|Reading|Fitting|Being painted/.test(card.textContent!));
      return cards.length === count && !isBusy;
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

test('figures dropped together get the same template, each by itself; a stroke is on all six in the next frame; all are saved', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 700 }, deviceScaleFactor: 0.5 });
  const broken = glb('broken.glb', Buffer.from('this is no model'));
  const figures = ['one', 'two', 'three', 'four', 'five', 'six'];
  await drop(page, [...figures.slice(0, 2).map(figure), broken, ...figures.slice(2).map(figure)]);
  const dropped = await avatars(page, 6);
  assert.match(await shownError(page), /^broken\.glb: this is no model that can be opened/);
  for (const label of dropped) assert.match(label, /, (painted|looks off\?)$/);
  await page.locator('#alert-close').click();
  assert.ok(await page.getByTestId('wardrobe-note').isHidden(), 'the paint fits all');
  assert.match(
    (await page.locator('#tools label:has(:checked)').textContent())!,
    /Turn/,
    'no tool for one model alone',
  );
  await page.locator('label', { hasText: 'Zones' }).click();
  await page.locator('label', { hasText: 'Result' }).click();
  assert.deepEqual(await faults(page), []);

  await page.locator('#tools label', { hasText: 'Brush' }).click();
  const names = await page
    .locator('.avatars .placed')
    .evaluateAll((items) => items.map((item) => item.getBoundingClientRect().toJSON() as DOMRect));
  const { x, y, width } = names[0]!;
  const { places, spent } = await stroke(page, { x: x + width / 2, y: y - 90 });
  assert.equal(places.length, 6, `in ${spent} ms, at ${JSON.stringify(places)}`);
  const view = (await page.locator('#view').boundingBox())!;
  for (const name of names) {
    const middle = (name.x + name.width / 2 - view.x) / view.width;
    const above = places.filter(([x, y]) => Math.abs(x - middle) < 0.05 && y * view.height < name.y - view.y);
    assert.ok(above.length >= 1, 'a name is below its figure');
  }

  const { name, bytes } = await saved(page, 'export-all');
  assert.equal(name, 'avatars-painted.zip');
  const files = unzip(bytes);
  assert.deepEqual(
    [...files.keys()],
    figures.map((name) => `${name}-painted.glb`),
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
  await ready(page);
  assert.ok(await page.getByTestId('save-cage').isVisible(), 'the cage that was fitted to it can be saved');
  await page.getByTestId('landmarks').waitFor();
  assert.equal(await page.locator('#tools input[data-key=b]').isChecked(), true, 'the brush stays in the hand');
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});
