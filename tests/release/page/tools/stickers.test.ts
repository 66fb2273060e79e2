import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { CDPSession } from 'playwright-core';
import type { PNG } from 'pngjs';
import { filled, image, names, savedTexture } from '../../../support/layers';
import { difference, look, modelArea, shareOfHue } from '../../../support/picture';
import { Site, type Visit } from '../../../support/site';

let site: Site;
let visit: Visit;
let session: CDPSession;
// On a phone: what works there by hand works elsewhere too.
before(async () => {
  site = await Site.open();
  visit = await site.visit({
    viewport: { width: 390, height: 700 },
    hasTouch: true,
    isMobile: true,
    deviceScaleFactor: 0.5,
  });
  const { page } = visit;
  await page.locator('#view-mode input[value=result]').check({ force: true });
  session = await page.context().newCDPSession(page);
  await page.getByRole('button', { name: 'Remove Tiger stripes' }).click();
});
after(() => site?.close());

type Point = readonly [x: number, y: number];

/** Puts fingers on the picture, moves them and lifts them. Places are shares of the picture's area. */
async function touch(...steps: (readonly Point[])[]): Promise<void> {
  const area = await modelArea(visit.page); // the picture moves when the page is scrolled
  const points = (fingers: readonly Point[]) =>
    fingers.map(([x, y], id) => ({ x: area.x + x * area.width, y: area.y + y * area.height, id }));
  let down = 0;
  for (const fingers of steps) {
    const type = fingers.length > down ? 'touchStart' : 'touchMove';
    down = fingers.length;
    await session.send('Input.dispatchTouchEvent', { type, touchPoints: points(fingers) });
  }
  await session.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
}

const seen = async (): Promise<PNG> => look(visit.page, await modelArea(visit.page));

async function choose(tool: string): Promise<void> {
  await visit.page.getByRole('radio', { name: tool }).check({ force: true });
}

async function set(options: Record<string, string>): Promise<void> {
  for (const [name, value] of Object.entries(options)) await visit.page.getByTestId(name).fill(value);
}

async function undone(): Promise<void> {
  await visit.page.getByTestId('undo').click();
  assert.equal(filled(await savedTexture(visit.page)), 0);
}

test('one finger paints', async () => {
  await choose('Brush');
  await set({ 'brush-color': '#00c040', 'brush-size': '60', 'brush-hardness': '100' });
  await touch([[0.45, 0.45]], [[0.5, 0.4]], [[0.55, 0.38]]);
  assert.ok(shareOfHue(await seen(), 140) > 0.005);
  await undone();
});

test('two fingers turn the model, and the first one leaves no paint', async () => {
  const { page } = visit;
  const before = await seen();
  await touch(
    [[0.45, 0.45]],
    [
      [0.45, 0.45],
      [0.6, 0.45],
    ],
    [
      [0.55, 0.5],
      [0.7, 0.5],
    ],
    [
      [0.7, 0.5],
      [0.85, 0.5],
    ],
  );
  assert.ok(difference(before, await seen()) > 0.02, 'it turned');
  assert.equal(filled(await savedTexture(page)), 0);
  assert.equal(
    await page.getByTestId('undo').isDisabled(),
    false,
    'what was there to be undone, the removal of the paint, still is',
  );
  await page.locator('#view').focus();
  await page.keyboard.press('Home');
  assert.ok(difference(before, await seen()) < 0.01);
});

test('two fingers leave no paint if the first came down beside the model', async () => {
  const { page } = visit;
  const before = await seen();
  await touch(
    [[0.9, 0.3]],
    [
      [0.9, 0.3],
      [0.5, 0.42],
    ],
    [
      [0.9, 0.35],
      [0.5, 0.44],
    ],
    [
      [0.9, 0.4],
      [0.5, 0.46],
    ],
  );
  assert.equal(filled(await savedTexture(page)), 0);
  await page.locator('#view').focus();
  await page.keyboard.press('Home');
  assert.ok(difference(before, await seen()) < 0.01);
});

test('a tap places a text sticker in its colour, size and rotation', async () => {
  const { page } = visit;
  await choose('Sticker');
  await set({ 'sticker-text': 'HI', 'brush-color': '#00c040', 'brush-size': '80' });
  await touch([[0.5, 0.42]]);
  const [picture, texture] = [await seen(), await savedTexture(page)];
  assert.ok(shareOfHue(picture, 140) > 0.005);
  await undone();
  await set({ 'sticker-turn': '90' });
  await touch([[0.5, 0.42]]);
  assert.ok(difference(picture, await seen()) > 0.003, 'turned');
  await undone();
  await set({ 'sticker-turn': '0', 'brush-size': '65' });
  await touch([[0.5, 0.42]]);
  const smaller = filled(await savedTexture(page)) / filled(texture);
  const ratio = (100 ** (-15 / 100)) ** 2; // even steps of the slider are even ratios, and this is an area
  assert.ok(Math.abs(smaller / ratio - 1) < 0.2, `${smaller} of the area instead of ${ratio}`);
  await undone();
});

test('an image sticker is upright and not mirrored, and follows the finger until release', async () => {
  const { page } = visit;
  // Red on the left and blue on the right above, violet and cyan below.
  const quarters = [
    [220, 0, 0, 255],
    [0, 0, 230, 255],
    [210, 0, 220, 255],
    [0, 210, 220, 255],
  ];
  await page
    .getByTestId('sticker-image')
    .setInputFiles(image('quarters.png', 64, (x, y) => quarters[(x < 32 ? 0 : 1) + (y < 32 ? 0 : 2)]!));
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>('#sticker-text')!.value === '');
  await set({ 'brush-size': '80' });
  const bare = await seen();
  await touch([[0.38, 0.56]], [[0.42, 0.5]], [[0.47, 0.47]]);
  const picture = await seen();
  type Channels = readonly [red: number, green: number, blue: number];
  const middleOf = (name: string, is: (channels: Channels) => boolean): Point => {
    let [count, x, y] = [0, 0, 0];
    for (let row = 0; row < picture.height; row++) {
      for (let column = 0; column < picture.width; column++) {
        const at = 4 * (row * picture.width + column);
        if (bare.data.subarray(at, at + 3).every((value, channel) => value === picture.data[at + channel])) continue;
        if (is(picture.data.subarray(at, at + 3) as unknown as Channels))
          [count, x, y] = [count + 1, x + column, y + row];
      }
    }
    assert.ok(count > 20, `${name} is seen`);
    return [x / count, y / count];
  };
  const red = middleOf('red', ([r, g, b]) => r > 110 && g < 90 && b < 90);
  const blue = middleOf('blue', ([r, g, b]) => b > 110 && r < 90 && g < 100);
  const violet = middleOf('violet', ([r, g, b]) => r > 110 && b > 110 && g < 90);
  const cyan = middleOf('cyan', ([r, g, b]) => g > 110 && b > 110 && r < 90);
  assert.ok(red[0] < blue[0] && violet[0] < cyan[0], 'left is left');
  assert.ok(red[1] < violet[1] && blue[1] < cyan[1], 'up is up');
  await undone();
});

test('the space bar paints at the centre of the view, and the arrow keys draw while it is held', async () => {
  const { page, complaints } = visit;
  await page.locator('#view').focus();
  await page.keyboard.press('b');
  assert.equal(await page.locator('#tools :checked').evaluate((input) => input.parentElement!.textContent), 'Brush');
  await set({ 'brush-size': '40' });
  await page.locator('#view').focus();
  await page.keyboard.press(' ');
  const dab = filled(await savedTexture(page));
  assert.ok(dab > 20, `${dab} texels`);
  await page.locator('#view').focus();
  await page.keyboard.down(' ');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowUp');
  await page.keyboard.up(' ');
  assert.ok(filled(await savedTexture(page)) > 1.5 * dab);
  assert.deepEqual(await names(page), ['Painting 1']);
  assert.deepEqual(complaints, []);
});
