import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Locator } from 'playwright-core';
import { PNG } from 'pngjs';
import { cancelOnceShown, kSlowWorker } from '../../../support/cancel';
import { glbOf, tetrahedron } from '../../../support/glb';
import { filled, image, names, rows, savedTexture, texel } from '../../../support/layers';
import { difference, look, modelArea } from '../../../support/picture';
import { saved, validModel } from '../../../support/saved';
import { drop, glb, Site, settled, shownError, type Upload, type Visit } from '../../../support/site';

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
/** Bands of colours from clear to full, from the left to the right or from top to bottom. */
const bands = (name: string, across: boolean, colorAt: (band: number) => readonly number[]): Upload =>
  image(name, 1024, (x, y) => colorAt(Math.floor((across ? x : y) / kBand)));
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

const row = (name: string): Locator => rows(visit.page).filter({ hasText: name });
const control = (role: 'slider' | 'combobox' | 'checkbox' | 'button', name: string): Locator =>
  visit.page.getByTestId('layer-list').getByRole(role, { name });

async function add(upload: Upload): Promise<void> {
  await visit.page.getByTestId('texture-input').setInputFiles(upload);
  assert.equal(await settled(visit.page), 'ready', await shownError(visit.page));
  await row(upload.name).waitFor();
}

test('a sample’s paint is the base layer, and another paint replaces it', async () => {
  const { page } = visit;
  assert.deepEqual(await names(page), ['Tiger stripes']);
  const area = await modelArea(page);
  const tiger = await look(page, area);
  await page.getByRole('radio', { name: 'War paint' }).check({ force: true });
  assert.equal(await settled(page), 'ready');
  assert.deepEqual(await names(page), ['War paint']);
  assert.ok(difference(tiger, await look(page, area)) > 0.05);
});

test('layers blend by the formulas of their modes, in linear light, with alpha', async () => {
  const { page } = visit;
  await control('button', 'Remove War paint').click();
  assert.deepEqual(await names(page), []);
  assert.equal(filled(await savedTexture(page)), 0, 'nothing is left');
  await add(bands('below.png', true, below));
  await assertTexture((column) => below(column), 'one layer alone is what its image is');
  await add(bands('above.png', false, above));
  assert.deepEqual(await names(page), ['above.png', 'below.png']);
  for (const blend of Object.keys(kFormulas)) {
    await control('combobox', 'Blending of above.png').selectOption(blend);
    await assertTexture((column, row) => joined(below(column), above(row), blend), blend);
  }
});

test('the texture is encoded off the main thread', async () => {
  const { page } = visit;
  const texture = await savedTexture(page);
  await page.locator('#paint-into [value=overlay]').check({ force: true });
  const document = await validModel((await saved(page, 'export-glb')).bytes);
  const images = document
    .getRoot()
    .listTextures()
    .map((texture) => texture.getImage()!)
    .filter((image) => PNG.sync.read(Buffer.from(image)).data.equals(texture.data));
  assert.equal(images.length, 1, 'the same in a model');
  assert.equal(await page.evaluate('encoded'), 0);
});

test('opacity, tint and visibility of a layer follow the same formulas', async () => {
  await control('combobox', 'Blending of above.png').selectOption('multiply');
  await control('slider', 'Opacity of above.png').fill('40');
  await assertTexture((column, row) => joined(below(column), above(row), 'multiply', 0.4), 'at 40 %');
  await visit.page.getByLabel('Tint of above.png').fill('#ff8020');
  await assertTexture((column, row) => joined(below(column), above(row), 'multiply', 0.4, [255, 128, 32]), 'tinted');
  await control('checkbox', 'Show above.png').uncheck({ force: true });
  await assertTexture((column) => below(column), 'hidden');
  await control('checkbox', 'Show above.png').check({ force: true });
  await control('slider', 'Opacity of above.png').fill('100');
  await visit.page.getByLabel('Tint of above.png').fill('#ffffff');
  await control('combobox', 'Blending of above.png').selectOption('normal');
  await assertTexture((column, row) => joined(below(column), above(row), 'normal'), 'as before');
});

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

test('undo restores a removed layer with its style, and redo removes it', async () => {
  const { page } = visit;
  await control('combobox', 'Blending of above.png').selectOption('screen');
  const before = await savedTexture(page);
  await control('button', 'Remove above.png').click();
  assert.deepEqual(await names(page), ['below.png']);
  await assertTexture((column) => below(column), 'removed');
  await page.keyboard.press('Control+z');
  assert.deepEqual(await names(page), ['above.png', 'below.png']);
  assert.deepEqual((await savedTexture(page)).data, before.data);
  await page.keyboard.press('Control+Shift+z');
  assert.deepEqual(await names(page), ['below.png']);
  await page.getByTestId('undo').click();
  assert.deepEqual((await savedTexture(page)).data, before.data);
});

test('layers for the last cage are put away when another model is opened, and come back when wanted', async () => {
  const { page } = visit;
  await page.getByRole('radio', { name: 'Tiger stripes' }).check({ force: true });
  assert.equal(await settled(page), 'ready');
  assert.deepEqual(await names(page), ['above.png', 'below.png', 'Tiger stripes']);
  await page.getByTestId('sample-select').selectOption('human');
  assert.equal(await settled(page), 'ready');
  assert.deepEqual(await names(page), ['Painted skull']);
  await page.getByRole('button', { name: 'Bring back' }).click();
  assert.deepEqual(await names(page), ['above.png', 'below.png', 'Painted skull']);
  assert.ok(await page.getByTestId('put-away').isHidden());
  await row('above.png').locator('.choose').click();
  assert.equal(await control('combobox', 'Blending of above.png').inputValue(), 'screen');
});

test('layers are composited when something changes, and not when the model turns', async () => {
  const { page } = visit;
  const area = await modelArea(page);
  const composed = (): Promise<number> => page.evaluate('composed') as Promise<number>;
  const [before, home] = [await composed(), await look(page, area)];
  await page.locator('#view').focus();
  for (let i = 0; i < 3; i++) {
    await page.keyboard.press('ArrowRight');
    await look(page, area);
  }
  assert.ok(difference(home, await look(page, area)) > 0.02, 'it turned');
  assert.equal(await composed(), before);
  await control('slider', 'Opacity of above.png').fill('50');
  await look(page, area);
  assert.ok((await composed()) > before);
});

test('a larger image enlarges the texture, and smaller layers are interpolated', async () => {
  const { page } = visit;
  await add(
    image('large.png', 2048, (x, y) => [(x % 2) * 255, (y % 2) * 255, (x * 7 + y) % 256, y < 1024 ? 255 : 128]),
  );
  const texture = await savedTexture(page);
  assert.equal(texture.width, 2048);
  for (const [x, y] of [
    [0, 0],
    [1, 0],
    [2047, 1023],
    [777, 512],
  ] as const)
    assert.deepEqual(texel(texture, x, y), [(x % 2) * 255, (y % 2) * 255, (x * 7 + y) % 256, 255]);
  await control('checkbox', 'Show large.png').uncheck({ force: true });
  assert.equal((await savedTexture(page)).width, 1024);
});

test('a seventeenth layer is refused with a message', async () => {
  const { page, complaints } = visit;
  while ((await names(page)).length < 16) await page.getByTestId('add-painting').click();
  assert.equal(await page.getByTestId('add-painting').isDisabled(), true);
  await page.getByTestId('texture-input').setInputFiles(image('next.png', 4, () => [0, 0, 0, 255]));
  await page.getByTestId('error').waitFor();
  assert.match(await shownError(page), /16 layers.*Remove one/);
  assert.equal((await names(page)).length, 16);
  assert.deepEqual(complaints, []);
});

test('of more layers than there is room for, as many as possible are brought back', async () => {
  const { page, complaints } = visit;
  await drop(page, [glb('cage.glb', glbOf(tetrahedron(2), 'thing')), glb('target.glb', glbOf(tetrahedron(), 'thing'))]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.getByTestId('add-painting').click();
  await page.getByTestId('sample-select').selectOption('car');
  const offer = page.getByTestId('put-away');
  await offer.filter({ hasText: '16 layers of earlier cages put away.' }).waitFor();
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.locator('#bring-back').click();
  await offer.filter({ hasText: 'One layer of an earlier cage put away.' }).waitFor();
  assert.equal((await names(page)).length, 16);
  assert.equal(await shownError(page), '');
  await page.locator('#bring-back').click();
  assert.match(await shownError(page), /16 layers.*Remove one/);
  assert.deepEqual(complaints, []);
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

test('cancelling a link changes no layers', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 500 } }, kSlowWorker);
  await page.getByRole('button', { name: 'Add War paint as a layer' }).click();
  await rows(page).filter({ hasText: 'War paint' }).waitFor();
  const before = await names(page);
  const givenUp = cancelOnceShown(page, 'button');
  await page
    .getByTestId('sample-select')
    .evaluate((select) => (location.hash = `sample=${(select as HTMLSelectElement).options[1]!.value}&layer=none`));
  await givenUp;
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await names(page), before);
  assert.deepEqual(complaints, []);
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
