import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Locator } from 'playwright-core';
import { filled, names, rows, savedTexture, texel } from '../../../support/layers';
import { Site, settled, shownError, type Visit } from '../../../support/site';

let site: Site;
let visit: Visit;
before(async () => {
  site = await Site.open();
  // Counts how often a level of the composite is made: the last thing that is done for it. And files made on the page's thread.
  visit = await site.visit(
    { viewport: { width: 900, height: 500 } },
    `globalThis.composed = 0
    WebGL2RenderingContext.prototype.blitFramebuffer = new Proxy(WebGL2RenderingContext.prototype.blitFramebuffer, {
      apply: (original, gl, args) => (globalThis.composed++, Reflect.apply(original, gl, args)),
    })
    globalThis.encoded = 0
    OffscreenCanvas.prototype.convertToBlob = new Proxy(OffscreenCanvas.prototype.convertToBlob, {
      apply: (original, canvas, args) => (globalThis.encoded++, Reflect.apply(original, canvas, args)),
    })`,
  );
  await visit.page.locator('input[value=result]').check({ force: true });
});
after(() => site?.close());

const kBands = 16;
const kBand = 1024 / kBands;
const below = (band: number): number[] => [
  17 * band,
  255 - 13 * band,
  (band * 97) % 256,
  band < 8 ? 255 : 255 - 28 * (band - 8),
];
const above = (band: number): number[] => [255 - 11 * band, (band * 53) % 256, 15 * band, 15 + 16 * band - 1];

const decode = (byte: number): number =>
  byte <= 0.04045 * 255 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4;
const encode = (share: number): number =>
  255 * (share <= 0.0031308 ? 12.92 * share : 1.055 * share ** (1 / 2.4) - 0.055);
const kFormulas: Record<string, (below: number, layer: number) => number> = {
  normal: (_, layer) => layer,
  multiply: (below, layer) => below * layer,
  screen: (below, layer) => below + layer - below * layer,
  add: (below, layer) => Math.min(1, below + layer),
};

/** What a layer over another looks like, by “Compositing and Blending Level 1” in linear light. */
function joined(under: number[], layer: number[], blend: string, opacity = 1, tint = [255, 255, 255]): number[] {
  const [alphaUnder, alpha] = [under[3]! / 255, (opacity * layer[3]!) / 255];
  const whole = alpha + alphaUnder * (1 - alpha);
  const color = [0, 1, 2].map((channel) => {
    const [b, s] = [decode(under[channel]!), decode(layer[channel]!) * decode(tint[channel]!)];
    const mixed =
      s * alpha * (1 - alphaUnder) + b * alphaUnder * (1 - alpha) + alpha * alphaUnder * kFormulas[blend]!(b, s);
    return whole > 0 ? encode(mixed / whole) : 0;
  });
  return [...color, 255 * whole];
}

/** Compares the saved texture with a formula, in the middle of each meeting of two bands. */
async function assertTexture(expected: (column: number, row: number) => number[], what: string): Promise<void> {
  const texture = await savedTexture(visit.page);
  assert.equal(texture.width, 1024);
  for (let row = 0; row < kBands; row++) {
    for (let column = 0; column < kBands; column++) {
      const found = texel(texture, (column + 0.5) * kBand, (row + 0.5) * kBand);
      const wanted = expected(column, row);
      // Colours were multiplied by alpha and rounded on the way: the less there is, the less is known of its colour.
      const slack = 2 + 380 / Math.max(1, wanted[3]!);
      const apart = Math.max(...wanted.map((value, channel) => Math.abs(value - found[channel]!)));
      assert.ok(apart <= slack, `${what}: ${found} instead of ${wanted.map(Math.round)} at ${column}, ${row}`);
    }
  }
}
const control = (role: 'slider' | 'combobox' | 'checkbox' | 'button', name: string): Locator =>
  visit.page.getByTestId('layer-list').getByRole(role, { name });

test('layers are reordered with the keys, which keep the focus, and by dragging', async () => {
  const { page } = visit;
  await control('button', 'Reorder above.png').focus();
  await page.keyboard.press('ArrowDown');
  assert.deepEqual(await names(page), ['below.png', 'above.png']);
  await page.waitForFunction(
    () => document.querySelector('#summary')!.textContent === 'above.png is now number 2 of 2 from the top.',
  );
  await page.keyboard.press('ArrowDown');
  assert.deepEqual(await names(page), ['below.png', 'above.png'], 'the lowest stays the lowest');
  await assertTexture((column, row) => joined(above(row), below(column), 'normal'), 'the other way round');

  const grip = (await control('button', 'Reorder above.png').boundingBox())!;
  const top = (await rows(page).first().boundingBox())!;
  await page.mouse.move(grip.x + grip.width / 2, grip.y + grip.height / 2);
  await page.mouse.down();
  await page.mouse.move(grip.x + grip.width / 2, top.y + 4, { steps: 6 });
  await page.mouse.up();
  assert.deepEqual(await names(page), ['above.png', 'below.png']);
  await page.mouse.move(grip.x + grip.width / 2, grip.y + 200, { steps: 3 });
  assert.deepEqual(await names(page), ['above.png', 'below.png'], 'and stays where it was let go');
  await assertTexture((column, row) => joined(below(column), above(row), 'normal'), 'dragged back');
});

test('a sample’s paint can be added as a layer, and a link restores all layers', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 500 } });
  await page.getByRole('button', { name: 'Add War paint as a layer' }).click();
  await rows(page).filter({ hasText: 'War paint' }).waitFor();
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
  await other.page.waitForFunction(() => document.querySelector<HTMLButtonElement>('#undo')!.disabled);
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
