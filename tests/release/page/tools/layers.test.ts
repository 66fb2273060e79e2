import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Locator } from 'playwright-core';
import { filled, image, names, rows, savedTexture, texel } from '../../../support/layers';
import { openSite, ready, settled, shownError } from '../../../support/site';

const site = await openSite();
const visit = await site.visit({ viewport: { width: 900, height: 500 } });

const control = (role: 'slider' | 'combobox' | 'checkbox' | 'button', name: string): Locator =>
  visit.page.getByTestId('layer-list').getByRole(role, { name });

test('layers are reordered with the keys, which keep the focus, and by dragging', async () => {
  const { page } = visit;
  const [red, blue] = [
    [255, 0, 0, 255],
    [0, 0, 255, 255],
  ];
  const assertTop = async (color: number[]) => assert.deepEqual(texel(await savedTexture(page), 512, 512), color);
  await control('button', 'Remove Tiger stripes').click();
  for (const upload of [image('below.png', 64, () => red), image('above.png', 64, () => blue)]) {
    await page.getByTestId('texture-input').setInputFiles(upload);
    await ready(page);
    await rows(page).filter({ hasText: upload.name }).waitFor();
  }
  await assertTop(blue);
  await control('button', 'Reorder above.png').focus();
  await page.keyboard.press('ArrowDown');
  assert.deepEqual(await names(page), ['below.png', 'above.png']);
  await page.waitForFunction(
    () => document.querySelector('#summary')!.textContent === 'above.png is now number 2 of 2 from the top.',
  );
  await page.keyboard.press('ArrowDown');
  assert.deepEqual(await names(page), ['below.png', 'above.png'], 'the lowest stays the lowest');
  await assertTop(red);

  await rows(page)
    .first()
    .evaluate((row) => row.scrollIntoView({ block: 'center' }));
  const grip = (await control('button', 'Reorder above.png').boundingBox())!;
  const top = (await rows(page).first().boundingBox())!;
  await page.mouse.move(grip.x + grip.width / 2, grip.y + grip.height / 2);
  await page.mouse.down();
  await page.mouse.move(grip.x + grip.width / 2, top.y + 4, { steps: 6 });
  await page.mouse.up();
  assert.deepEqual(await names(page), ['above.png', 'below.png']);
  await page.mouse.move(grip.x + grip.width / 2, grip.y + 200, { steps: 3 });
  assert.deepEqual(await names(page), ['above.png', 'below.png'], 'and stays where it was let go');
  await assertTop(blue);
});

test('a sample’s paint can be added as a layer, and a link restores all layers', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 500 } });
  await page.getByRole('button', { name: 'Add War paint as a layer' }).click();
  await rows(page).filter({ hasText: 'War paint' }).waitFor();
  const chosen = page.locator('#paints input:checked');
  await chosen.and(page.getByLabel('War paint', { exact: true })).waitFor();
  await page.getByLabel('UV checker', { exact: true }).check({ force: true });
  await rows(page).filter({ hasText: 'UV checker' }).waitFor();
  assert.deepEqual(await names(page), ['UV checker', 'Tiger stripes'], 'the one on top is replaced');
  await page.getByTestId('undo').click();
  const list = page.getByTestId('layer-list');
  await list.getByRole('combobox', { name: 'Blending of War paint' }).selectOption('multiply');
  await list.getByRole('slider', { name: 'Opacity of War paint' }).fill('60');
  await rows(page).filter({ hasText: 'Tiger stripes' }).locator('.choose').click();
  await page.getByLabel('Tint of Tiger stripes').fill('#80c0ff');
  const texture = await savedTexture(page);
  await page.getByTestId('share-link').focus(); // else the link follows when the hand rests
  const link = await page.getByTestId('share-link').evaluate((anchor) => (anchor as HTMLAnchorElement).hash);
  const other = await site.visit({ viewport: { width: 900, height: 500 } }, undefined, link);
  await rows(other.page).filter({ hasText: 'War paint' }).waitFor();
  assert.deepEqual(await names(other.page), ['War paint', 'Tiger stripes']);
  assert.equal(Buffer.compare((await savedTexture(other.page)).data, texture.data), 0);
  // What another page's link brought is nothing to be undone.
  assert.equal(await other.page.getByTestId('undo').isDisabled(), true);

  // Nor is what had lain there before it.
  for (const name of ['War paint', 'Tiger stripes'])
    await other.page.getByRole('button', { name: `Remove ${name}` }).click();
  await other.page.getByTestId('share-link').focus();
  const bare = await other.page.getByTestId('share-link').evaluate((anchor) => (anchor as HTMLAnchorElement).hash);
  await other.page.getByTestId('undo').click();
  await other.page.evaluate((hash) => (location.hash = hash), bare);
  await other.page.waitForFunction(() => document.querySelectorAll('#layer-list li').length === 0);
  assert.equal(await settled(other.page), 'ready', await shownError(other.page));
  assert.equal(filled(await savedTexture(other.page)), 0);
  // What was done before is no step any more; that it was replaced may be one.
  await other.page.locator('#undo:disabled, #undo[title^="Undo: replacing"]').waitFor();
  assert.deepEqual([...complaints, ...other.complaints], []);
});

test('a missing paint of a link is reported, and the layers stay', async () => {
  const { page } = await site.visit({ viewport: { width: 900, height: 500 } }, (page) =>
    page.route(/paint-war-paint\.png$/, (route) => route.abort()).then(() => {}),
  );
  const before = await names(page);
  await page.evaluate(
    () =>
      (location.hash =
        'sample=lizard&layer=lizard/paint-tiger.png,0.5,ffffff,normal&layer=lizard/paint-war-paint.png,1,ffffff,normal'),
  );
  await page.getByTestId('error').waitFor();
  assert.match(await shownError(page), /^lizard\/paint-war-paint\.png: the file could not be loaded$/);
  assert.equal((await names(page)).length, before.length);
});
