import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { PNG } from 'pngjs';
import { filled, names, savedTexture, texel } from '../../../support/layers';
import { ball, islandCage } from '../../../support/models';
import { type Area, difference, look, modelArea, shareOfHue } from '../../../support/picture';
import { drop, Site, settled, shownError, type Visit } from '../../../support/site';

const kWindow = { width: 900, height: 500 };
let site: Site;
let visit: Visit;
before(async () => {
  site = await Site.open();
  visit = await site.visit({ viewport: kWindow, deviceScaleFactor: 1 });
});
after(() => site?.close());

type Spot = readonly [x: number, y: number];

/** Opens a ball in a cube whose six sides are islands of the texture, and nothing on it. */
async function openBall(): Promise<void> {
  const { page } = visit;
  await drop(page, [await ball(), await islandCage(1)]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.locator('input[value=result]').check({ force: true });
  for (const name of await names(page)) await page.getByRole('button', { name: `Remove ${name}`, exact: true }).click();
  await page.locator('#view').focus();
  await page.keyboard.press('Home');
}

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

/** The hue of a pixel in degrees, and how coloured it is: 0..1. */
function hueAt(picture: PNG, x: number, y: number): { hue: number; saturation: number } {
  const [r, g, b] = texel(picture, Math.round(x), Math.round(y)) as [number, number, number];
  const [most, least] = [Math.max(r, g, b), Math.min(r, g, b)];
  const spread = most - least;
  const sixth = most === r ? ((g - b) / spread + 6) % 6 : most === g ? (b - r) / spread + 2 : (r - g) / spread + 4;
  return { hue: 60 * sixth, saturation: most === 0 ? 0 : spread / most };
}

const kGreen = '#00c040'; // hue 140; the ball is blue
const isGreen = ({ hue, saturation }: { hue: number; saturation: number }): boolean =>
  Math.abs(hue - 140) < 15 && saturation > 0.5;
const kHard = { 'brush-hardness': '100', 'brush-opacity': '100', 'brush-color': kGreen };

test('a stroke appears while it is drawn, on a new layer, and undo restores every byte', async () => {
  const { page, complaints } = visit;
  await openBall();
  const area = await modelArea(page);
  await choose('Brush');
  await set({ ...kHard, 'brush-size': '60' });
  const bare = await look(page, area);
  await page.mouse.move(area.x + 0.4 * area.width, area.y + 0.5 * area.height);
  await page.mouse.down();
  await page.mouse.move(area.x + 0.5 * area.width, area.y + 0.4 * area.height, { steps: 3 });
  assert.ok(shareOfHue(await look(page, area), 140) > 0.01, 'while the button is still pressed');
  assert.deepEqual(await names(page), ['Painting 1']);
  const first = await savedTexture(page);
  await page.mouse.up();
  await away();
  const second = await savedTexture(page);
  assert.ok(filled(second) > 1000);
  assert.ok(
    second.data.every((byte, at) => Math.abs(byte - first.data[at]!) <= 2),
    'it stays as it was shown',
  );

  await set({ 'brush-color': '#c000d0', 'brush-opacity': '50', 'brush-hardness': '20' });
  await draw(area, [
    [0.35, 0.3],
    [0.6, 0.6],
  ]);
  const third = await savedTexture(page);
  assert.notDeepEqual(third.data, second.data);
  const step = async (key: string, expected: PNG | undefined): Promise<void> => {
    await page.keyboard.press(key);
    const found = await savedTexture(page);
    if (expected) assert.ok(Buffer.compare(found.data, expected.data) === 0, key);
    else assert.equal(filled(found), 0, key);
  };
  await step('Control+z', second);
  await step('Control+z', undefined);
  await page.keyboard.press('Control+Shift+z');
  await step('Control+y', third);
  await page.getByTestId('undo').click();
  await page.getByTestId('undo').click();
  await away();
  assert.ok(difference(bare, await look(page, area)) < 0.0005, 'nothing is left on the model either');
  assert.match((await page.getByTestId('undo').getAttribute('title'))!, /removing/, 'what came before the strokes');
  assert.deepEqual(complaints, []);
});

test('a stroke across a UV seam has no gap, near and far', async () => {
  const { page } = visit;
  await openBall();
  const area = await modelArea(page);
  // Turned until an edge of the cube faces the viewer: islands meet there that lie apart in the texture.
  for (let i = 0; i < 6; i++) await page.keyboard.press('ArrowRight');
  await choose('Brush');
  await set({ ...kHard, 'brush-size': '40' });
  await draw(
    area,
    [
      [0.36, 0.5],
      [0.64, 0.5],
    ],
    3,
  );
  await away();
  const texture = await savedTexture(page);
  const islands = new Set<number>();
  for (let y = 0; y < 1024; y += 4) {
    for (let x = 0; x < 1024; x += 4)
      if (texel(texture, x, y)[3]! > 128) islands.add(Math.floor((3 * x) / 1024) + 3 * Math.floor((2 * y) / 1024));
  }
  assert.ok(islands.size >= 2, `it lies on ${islands.size} islands`);
  let length = 0.27;
  for (const zoom of ['near', 'far']) {
    const picture = await look(page, { x: 0, y: 0, ...kWindow });
    for (let share = 0.5 - length / 2; share < 0.5 + length / 2; share += 0.001) {
      const found = hueAt(picture, area.x + share * area.width, area.y + 0.5 * area.height);
      assert.ok(isGreen(found), `${zoom}: at ${share.toFixed(3)} the hue is ${Math.round(found.hue)}`);
    }
    for (let i = 0; i < 8; i++) await page.keyboard.press('-');
    length /= 1.1 ** 8;
  }
});

test('a fast stroke is continuous, not a string of dots', async () => {
  const { page } = visit;
  await openBall();
  const area = await modelArea(page);
  await choose('Brush');
  await set({ ...kHard, 'brush-size': '20' });
  await draw(
    area,
    [
      [0.4, 0.3],
      [0.58, 0.55],
    ],
    1,
  ); // two samples of the pointer
  await away();
  const picture = await look(page, area);
  for (let share = 0.01; share < 1; share += 0.005) {
    const found = hueAt(picture, (0.4 + 0.18 * share) * area.width, (0.3 + 0.25 * share) * area.height);
    assert.ok(isGreen(found), `at ${share.toFixed(3)} of the way the hue is ${Math.round(found.hue)}`);
  }
});

test('mirroring paints the other half of the cage too', async () => {
  const { page } = visit;
  await openBall();
  const area = await modelArea(page);
  for (let i = 0; i < 9; i++) await page.keyboard.press('ArrowRight');
  await choose('Brush');
  await set({ ...kHard, 'brush-size': '50' });
  await page.getByTestId('brush-mirror').check();
  await draw(area, [
    [0.47, 0.4],
    [0.53, 0.5],
  ]);
  await page.getByTestId('brush-mirror').uncheck();
  const texture = await savedTexture(page);
  // The sides of the cube in the texture, in rows of three: right, left, top; bottom, front, back.
  const counts = [0, 0, 0, 0, 0, 0];
  for (let y = 0; y < 1024; y++)
    for (let x = 0; x < 1024; x++)
      if (texel(texture, x, y)[3]! > 128) counts[Math.floor((3 * x) / 1024) + 3 * Math.floor((2 * y) / 1024)]!++;
  const [right, left] = counts as [number, number];
  assert.ok(
    right + left > 500 && Math.abs(right - left) <= 0.02 * right,
    `${right} texels on the right, ${left} on the left`,
  );
});

test('the eraser removes painting, but nothing of the layers below', async () => {
  const { page } = visit;
  await openBall();
  const area = await modelArea(page);
  await choose('Brush');
  await set({ ...kHard, 'brush-size': '70' });
  await draw(area, [
    [0.45, 0.4],
    [0.55, 0.4],
  ]);
  const painted = filled(await savedTexture(page));
  await choose('Erase');
  await set({ 'brush-size': '50' });
  await draw(area, [
    [0.42, 0.4],
    [0.5, 0.4],
  ]);
  await away();
  const rest = filled(await savedTexture(page));
  assert.ok(rest > 0.1 * painted && rest < 0.9 * painted, `${rest} of ${painted} texels are left`);
  const picture = await look(page, area);
  assert.ok(!isGreen(hueAt(picture, 0.47 * area.width, 0.4 * area.height)), 'erased');
  assert.ok(isGreen(hueAt(picture, 0.55 * area.width, 0.4 * area.height)), 'left');
});

test('a stroke skips unpainted zones, and continues behind them', async () => {
  const { page, complaints } = visit;
  await page.getByTestId('sample-select').selectOption({ index: 0 });
  assert.equal(await settled(page), 'ready');
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

test('fine painting uses a separate layer of twice the resolution, and undo restores every byte', async () => {
  const { page, complaints } = visit;
  await openBall();
  const area = await modelArea(page);
  await choose('Brush');
  await set({ ...kHard, 'brush-size': '30' });
  const line: Spot[] = [
    [0.4, 0.5],
    [0.6, 0.45],
  ];
  await draw(area, line);
  const plain = await savedTexture(page);
  assert.equal(plain.width, 1024);

  const fine = page.getByTestId('painting-fine');
  await fine.check();
  await draw(area, line);
  assert.deepEqual(await names(page), ['Painting 2', 'Painting 1']);
  await page.getByRole('button', { name: 'Remove Painting 1', exact: true }).click();
  const sharp = await savedTexture(page);
  assert.equal(sharp.width, 2048);
  const ratio = filled(sharp) / filled(plain);
  assert.ok(Math.abs(ratio - 4) < 0.2, `${ratio} times as many texels`);
  // What is but larger has soft edges of two texels at least, between none and all.
  const soft = ({ data }: PNG): number =>
    data.filter((value, at) => at % 4 === 3 && value > 25 && value < 230).length / Math.sqrt(filled({ data } as PNG));
  assert.ok(soft(sharp) < 1.4 * soft(plain), `${soft(sharp)} beside ${soft(plain)}`);

  await draw(area, [
    [0.45, 0.3],
    [0.55, 0.3],
  ]);
  assert.notDeepEqual((await savedTexture(page)).data, sharp.data);
  await page.keyboard.press('Control+z');
  assert.deepEqual((await savedTexture(page)).data, sharp.data);
  await page.keyboard.press('Control+z');
  await page.locator('.layer .choose', { hasText: 'Painting 1' }).click();
  assert.equal(await fine.isChecked(), false, 'it says what is painted on');
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
  for (const id of ['save-texture', 'stage-save', 'save-picture']) {
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

test('erasing without a painting shows a message', async () => {
  const { page } = visit;
  await openBall();
  const area = await modelArea(page);
  await choose('Erase');
  await draw(area, [
    [0.48, 0.4],
    [0.5, 0.4],
  ]);
  assert.match(await shownError(page), /no painting to erase/);
  await page.locator('#alert-close').focus();
  await page.keyboard.press('Enter');
  assert.equal(await page.evaluate(() => document.activeElement?.id), 'view');
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
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.mouse.move(x + 0.6 * width, y + 0.5 * height, { steps: 4 });
  await page.mouse.up();
  assert.deepEqual(await names(page), ['UV checker']);
  assert.match((await page.getByTestId('put-away').textContent())!, /One layer of an earlier cage put away/);
  assert.deepEqual(complaints, []);
});
