import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { faults } from '../../../support/axe';
import { filled, names, savedTexture } from '../../../support/layers';
import { ball, islandCage } from '../../../support/models';
import { type Area, difference, look, modelArea, shareOfHue } from '../../../support/picture';
import { drop, openSite, ready, type Upload } from '../../../support/site';

const kGreen = 140; // the hue of the paint; the ball is blue
const kGreenPaint = '#00c040';
const site = await openSite();

/** Opens a ball in a cube whose six sides are islands of the texture, and nothing on it. */
async function openBall(page: Page): Promise<Area> {
  await drop(page, [await ball(), await islandCage(1)]);
  await ready(page);
  await page.locator('input[value=result]').check({ force: true });
  for (const name of await names(page)) await page.getByRole('button', { name: `Remove ${name}`, exact: true }).click();
  await page.locator('#view').press('Home');
  return modelArea(page);
}

const choose = (page: Page, title: string): Promise<void> =>
  page.getByRole('radio', { name: title, exact: true }).check({ force: true });

async function set(page: Page, options: Record<string, string>): Promise<void> {
  for (const [name, value] of Object.entries(options)) await page.getByTestId(name).fill(value);
}

const at = ({ x, y, width, height }: Area, u: number, v: number) => ({ x: x + u * width, y: y + v * height });

/** Drags the mouse from place to place; places are shares of an area. */
async function drag(page: Page, area: Area, ...places: (readonly [number, number])[]): Promise<void> {
  for (const [index, [u, v]] of places.entries()) {
    const { x, y } = at(area, u, v);
    await page.mouse.move(x, y, { steps: index === 0 ? 1 : 4 });
    if (index === 0) await page.mouse.down();
  }
  await page.mouse.up();
}

const away = (page: Page): Promise<void> => page.mouse.move(5, 60);

/** A picture of the model without what tools show over it. */
async function bareLook(page: Page, area: Area): Promise<PNG> {
  const hide = await page.addStyleTag({ content: '[class^=sticker-], .cross, .brush-ring { opacity: 0 }' });
  const picture = await look(page, area);
  await hide.evaluate((style) => (style as Element).remove());
  return picture;
}

/** The middle of what is green, in shares of the picture, and its share. */
async function green(page: Page, area: Area): Promise<{ x: number; y: number; share: number }> {
  const picture = await bareLook(page, area);
  let [count, x, y] = [0, 0, 0];
  for (let i = 0; i < picture.data.length; i += 4) {
    const [r, g, b] = picture.data.subarray(i, i + 3) as unknown as [number, number, number];
    if (g < 90 || r > 0.6 * g || b > 0.7 * g) continue;
    count++;
    x += (i / 4) % picture.width;
    y += Math.floor(i / 4 / picture.width);
  }
  return {
    x: x / count / picture.width,
    y: y / count / picture.height,
    share: count / (picture.width * picture.height),
  };
}

test('a sticker is seen before it is placed, and is moved, turned, scaled, mirrored, restyled and removed afterwards', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 640 }, deviceScaleFactor: 0.5 });
  const area = await openBall(page);
  await choose(page, 'Sticker');
  await set(page, { 'brush-color': kGreenPaint, 'sticker-text': 'FLAG' });
  const bare = await green(page, area);
  assert.equal(bare.share, 0);

  const place = at(area, 0.42, 0.5);
  await page.mouse.move(place.x, place.y);
  await page.mouse.move(place.x + 1, place.y);
  const previewed = await green(page, area);
  assert.ok(previewed.share > 0.004, `${previewed.share} is seen before`);
  assert.ok(Math.abs(previewed.x - 0.42) < 0.03 && Math.abs(previewed.y - 0.5) < 0.05, 'at the pointer');
  assert.deepEqual(await names(page), [], 'and nothing is placed');
  assert.equal(filled(await savedTexture(page)), 0, 'nor saved');
  await away(page);
  assert.equal((await green(page, area)).share, 0);

  await page.mouse.click(place.x, place.y);
  await away(page);
  const placed = await green(page, area);
  assert.ok(Math.abs(placed.share / previewed.share - 1) < 0.1);
  assert.deepEqual(await names(page), ['Stickers 1']);
  assert.deepEqual(await faults(page), []);
  const first = await bareLook(page, area);

  // Not around an edge of the cube, where the sticker would end.
  await drag(page, area, [0.43, 0.5], [0.47, 0.5], [0.51, 0.5]);
  await away(page);
  const moved = await green(page, area);
  assert.ok(moved.x - placed.x > 0.06, `moved by ${moved.x - placed.x}`);
  assert.ok(Math.abs(moved.share / placed.share - 1) < 0.25, `one sticker only: ${moved.share} of ${placed.share}`);

  // Its corner turns and scales it.
  const handle = (await page.locator('.sticker-handle').boundingBox())!;
  await page.mouse.move(handle.x + 22, handle.y + 22);
  await page.mouse.down();
  await page.mouse.move(handle.x + 22 - 10, handle.y + 22 + 60, { steps: 4 });
  await page.mouse.up();
  assert.notEqual(await page.getByTestId('sticker-turn').inputValue(), '0');
  await away(page);
  const turned = await bareLook(page, area);
  assert.ok(difference(first, turned) > 0.005);
  await page.getByRole('button', { name: 'Mirror', exact: true }).click();
  assert.ok(difference(turned, await bareLook(page, area)) > 0.002);
  assert.ok(await page.getByTestId('sticker-flip').isChecked());
  await set(page, { 'brush-color': '#d00000' });
  assert.ok(shareOfHue(await look(page, area), 0) > 0.003, 'in another colour');
  assert.equal((await green(page, area)).share, 0);

  // A second one, and the first is still there to be chosen.
  await page.getByRole('button', { name: 'Done', exact: true }).click();
  await set(page, { 'sticker-text': '2', 'sticker-turn': '0', 'brush-size': '60', 'brush-color': kGreenPaint });
  await page.mouse.click(at(area, 0.34, 0.68).x, at(area, 0.34, 0.68).y);
  await away(page);
  assert.ok((await green(page, area)).share > 0.001);
  await page.mouse.click(at(area, moved.x, moved.y).x, at(area, moved.x, moved.y).y);
  assert.equal(await page.getByTestId('sticker-text').inputValue(), 'FLAG');
  await page.locator('#view').press('Delete');
  await away(page);
  assert.ok(shareOfHue(await look(page, area), 0) < 0.001, 'removed');
  assert.ok((await green(page, area)).share > 0.001, 'the other one stays');

  // Every step can be undone: removed, second, colour, mirrored, turned, moved.
  for (let i = 0; i < 6; i++) await page.keyboard.press('Control+z');
  assert.equal(await page.locator('.sticker-bar').isVisible(), false);
  const apart = difference(first, await bareLook(page, area));
  assert.ok(apart < 0.0005, `as it was placed, but for ${apart}`);
  await page.keyboard.press('Control+z');
  assert.deepEqual(await names(page), []);
  assert.deepEqual(complaints, []);
});

test('a picture that is dropped is a sticker until it is used as a whole paint; a square of a power of two is a paint at once', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 640 }, deviceScaleFactor: 0.5 });
  const area = await openBall(page);
  const picture = (width: number, height: number): Upload => {
    const png = new PNG({ width, height });
    for (let i = 0; i < png.data.length; i += 4) png.data.set([0, 200, 0, 255], i);
    return { name: 'photo.png', mimeType: 'image/png', buffer: PNG.sync.write(png) };
  };
  await drop(page, [picture(60, 40)]);
  const whole = page.getByRole('button', { name: 'Use as a whole paint' });
  await whole.waitFor();
  const place = at(area, 0.42, 0.5);
  await page.mouse.click(place.x, place.y);
  await away(page);
  const { share } = await green(page, area);
  assert.ok(share > 0.004 && share < 0.2, `${share} is a sticker`);
  await drop(page, [picture(60, 40)]);
  await whole.click();
  await page.locator('#texture-name', { hasText: 'photo.png' }).waitFor();
  await drop(page, [{ ...picture(64, 64), name: 'sheet.png' }]);
  await page.locator('#texture-name', { hasText: 'sheet.png' }).waitFor();
  assert.deepEqual(complaints, []);
});

test('a click fills the whole part; its colour is taken by the eyedropper and stays among the swatches', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 640 } });
  const area = await openBall(page);
  await choose(page, 'Fill');
  await set(page, { 'brush-color': kGreenPaint });
  await page.mouse.click(at(area, 0.5, 0.5).x, at(area, 0.5, 0.5).y);
  await away(page);
  const front = await look(page, area);
  const share = shareOfHue(front, kGreen);
  assert.ok(share > 0.05, `${share}`);
  await page.locator('#view').focus();
  for (let i = 0; i < 15; i++) await page.keyboard.press('ArrowRight');
  assert.ok(shareOfHue(await look(page, area), kGreen) > 0.95 * share, 'from behind too');
  await page.keyboard.press('Home');
  const swatch = page.getByTestId('swatches').getByRole('button');
  assert.equal(await swatch.first().getAttribute('title'), kGreenPaint);
  assert.ok((await swatch.count()) <= 8);

  await choose(page, 'Brush');
  const color = page.getByTestId('brush-color');
  await color.fill('#112233');
  await page.keyboard.down('Alt');
  await page.mouse.click(at(area, 0.5, 0.5).x, at(area, 0.5, 0.5).y);
  await page.keyboard.up('Alt');
  assert.equal(await color.inputValue(), kGreenPaint);
  await color.fill('#112233');
  await page.locator('#pick-color').click();
  assert.equal(await page.locator('#pick-color').getAttribute('aria-pressed'), 'true');
  await page.mouse.click(at(area, 0.5, 0.5).x, at(area, 0.5, 0.5).y);
  assert.equal(await color.inputValue(), kGreenPaint);
  assert.equal(await page.locator('#pick-color').getAttribute('aria-pressed'), 'false');
  await color.fill('#112233');
  await page.locator('#view').press('i');
  await page.locator('#view').press(' ');
  assert.equal(await color.inputValue(), kGreenPaint, 'by keys, at the cross');
  await swatch.nth(2).click();
  assert.notEqual(await color.inputValue(), kGreenPaint);
  assert.deepEqual(await faults(page), []);

  await page.keyboard.press('Control+z');
  await away(page);
  assert.equal(shareOfHue(await look(page, area), kGreen), 0);
  assert.ok(difference(front, await look(page, area)) > 0.05);
  assert.deepEqual(complaints, []);
});

test('keys choose tools and sizes, and a list names them', async () => {
  const { page } = await site.visit({ viewport: { width: 700, height: 844 }, hasTouch: true });
  const view = page.locator('#view');
  for (const [key, title] of Object.entries({ b: 'Brush', e: 'Erase', s: 'Sticker', f: 'Fill' })) {
    await view.press(key);
    assert.ok(await page.getByRole('radio', { name: title, exact: true }).isChecked(), title);
  }
  await view.press('b');
  const size = async (): Promise<number> => Number(await page.getByTestId('brush-size').inputValue());
  const before = await size();
  await view.press(']');
  const larger = await size();
  assert.ok(larger > before);
  await view.press('[');
  assert.equal(await size(), before);
  await view.press('?');
  const list = page.getByRole('dialog', { name: 'Keys' });
  assert.match((await list.textContent())!, /Erase/);
  assert.deepEqual(await faults(page), []);
  await page.keyboard.press('Escape');
  assert.ok(await list.isHidden());
  const button = page.getByRole('button', { name: 'Keys', exact: true });
  const { width, height } = (await button.boundingBox())!;
  assert.ok(Math.min(width, height) >= 44, `${width} × ${height}`);
  await button.click();
  await list.getByRole('button', { name: 'Close' }).click();
  assert.ok(await list.isHidden());
});

test('where no paint is seen, nobody paints: the pointer turns the model again, and opens the menu of a part', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 500 } });
  const turn = page.getByRole('radio', { name: 'Turn', exact: true });
  await choose(page, 'Brush');
  await page.locator('#show-paint').uncheck({ force: true });
  assert.ok(await turn.isChecked(), 'without paint');
  await choose(page, 'Fill');
  assert.ok(await page.locator('#show-paint').isChecked());
  await page.locator('#view-mode input[value=segments]').check({ force: true });
  assert.ok(await turn.isChecked(), 'in Parts');
  const before = await names(page);
  const { x, y } = at(await modelArea(page), 0.5, 0.5);
  await page.mouse.click(x, y);
  await page.getByTestId('part-menu').waitFor();
  assert.deepEqual(await names(page), before, 'nothing was painted');
  assert.deepEqual(complaints, []);
});

test('a sticker is duplicated beside itself, and copied to the other side, where it can be read, too', async () => {
  const { page, complaints } = await site.visit(
    { viewport: { width: 1200, height: 900 }, deviceScaleFactor: 0.5 },
    undefined,
    '#sample=human&view=result',
  );
  const area = await modelArea(page);
  await page.getByRole('radio', { name: 'Sticker' }).check({ force: true });
  await set(page, { 'sticker-text': 'F', 'brush-size': '40', 'brush-color': kGreenPaint });
  const place = at(area, 0.4, 0.72);
  await page.mouse.click(place.x, place.y);
  await away(page);
  const one = await green(page, area);
  const bar = (await page.locator('.sticker-bar').boundingBox())!;
  assert.ok(bar.y > place.y && bar.y < place.y + 200, `the bar, at ${bar.y}, is below it, at ${place.y}`);
  await page.getByRole('button', { name: 'Other side' }).click();
  await away(page);
  const two = await green(page, area);
  assert.ok(two.share > 1.4 * one.share, `${two.share} after ${one.share}`);
  assert.ok(two.x > one.x + 0.03, 'on the other side');
  assert.equal(await page.getByTestId('sticker-flip').isChecked(), false, 'not as in a mirror');
  await page.getByRole('button', { name: 'Duplicate' }).click();
  await away(page);
  assert.ok((await green(page, area)).share > 1.2 * two.share);
  assert.deepEqual(await names(page), ['Stickers 1', 'Painted skull'].slice(0, (await names(page)).length));
  for (const key of ['z', 'z']) await page.keyboard.press(`Control+${key}`);
  await away(page);
  assert.ok(Math.abs((await green(page, area)).share / one.share - 1) < 0.1, 'each is a step');
  assert.deepEqual(complaints, []);
});
