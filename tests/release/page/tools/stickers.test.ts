import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { PNG } from 'pngjs';
import { filled, names, savedTexture } from '../../../support/layers';
import { difference, look, modelArea } from '../../../support/picture';
import { openSite } from '../../../support/site';

const site = await openSite();
// On a phone: what works there by hand works elsewhere too.
const visit = await site.visit({
  viewport: { width: 390, height: 700 },
  hasTouch: true,
  isMobile: true,
  deviceScaleFactor: 0.5,
});
const { page } = visit;
await page.locator('#view-mode input[value=result]').check({ force: true });
const session = await page.context().newCDPSession(page);
await page.getByRole('button', { name: 'Remove Tiger stripes' }).click();

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

async function set(options: Record<string, string>): Promise<void> {
  for (const [name, value] of Object.entries(options)) await visit.page.getByTestId(name).fill(value);
}

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
