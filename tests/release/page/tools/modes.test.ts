import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import type { PNG } from 'pngjs';
import { ball, islandCage } from '../../../support/models';
import { coloredPart, difference, look, modelArea, shareOfHue } from '../../../support/picture';
import { drop, openSite, ready, type Upload } from '../../../support/site';

const kModes = ['compare', 'result', 'naive', 'zones', 'segments', 'checker', 'distance', 'stretch'] as const;

const site = await openSite();
const visit = await site.visit({ viewport: { width: 900, height: 560 } });

const choose = (page: Page, mode: (typeof kModes)[number]): Promise<void> =>
  page.locator(`#view-mode input[value=${mode}]`).check({ force: true });
const ticks = (page: Page): Promise<string[]> => page.locator('#legend .ticks span').allTextContents();

async function open(...files: Upload[]): Promise<Page> {
  const { page } = visit;
  await drop(page, files);
  await ready(page);
  return page;
}

/** The hues, in steps of 10°, that fill some of a picture with strong colours. */
function hues(picture: PNG): number[] {
  return Array.from({ length: 36 }, (_, step) => 10 * step).filter((hue) => shareOfHue(picture, hue) > 0.0003);
}

/** Where the ball is, in a mode that gives it strong colours. */
async function ballArea(page: Page) {
  const area = await modelArea(page);
  return coloredPart(area, await look(page, area));
}

/** The colour in the middle of a picture. */
function middle({ data, width, height }: PNG): number[] {
  const at = 4 * (Math.floor(height / 2) * width + Math.floor(width / 2));
  return [...data.subarray(at, at + 3)];
}

test('parts have distinct colours', async () => {
  const { page } = visit;
  await choose(page, 'segments');
  const picture = await look(page, await modelArea(page));
  const found = hues(picture);
  await choose(page, 'result');
  const painted = hues(await look(page, await modelArea(page)));
  assert.ok(found.length > 2 * painted.length, `${found.join()} against ${painted.join()}`);
  assert.ok(shareOfHue(picture, 198) > 0.1, 'the skin is of one');
});

test('the distance to the cage has a scale in shares of the model’s diagonal', async () => {
  const page = await open(await ball(), await islandCage(1));
  await choose(page, 'distance');
  const area = await ballArea(page);
  // From 0.1 in front of a side to 0.48 under a corner, of a diagonal of 3.1.
  assert.deepEqual(await ticks(page), ['0', '5', '10', '15', '≥ 20']);
  const [r, g, b] = middle(await look(page, area)) as [number, number, number];
  assert.ok(b > 1.4 * g && b > 2 * r, `near a side it is blue: ${[r, g, b]}`);
  assert.ok(shareOfHue(await look(page, area), 150) > 0.002, 'under a corner it is green');

  await open(await islandCage(2));
  assert.deepEqual(await ticks(page), ['0', '15', '30', '45', '≥ 60']);
  const far = middle(await look(page, area)) as [number, number, number];
  assert.ok(far[1] > far[0] && far[1] > far[2], `35 % of the diagonal away it is green: ${far}`);
});

test('stretch is shown on painted triangles, and reveals one that spans half of the texture', async () => {
  const page = await open(await ball(), await islandCage(1));
  await choose(page, 'distance');
  const area = await ballArea(page);
  await choose(page, 'stretch');
  assert.deepEqual(await ticks(page), ['≤ ¼×', '½×', '1×', '2×', '≥ 4×']);
  const [red, blue] = [15, 211];
  const even = await look(page, area);
  assert.ok(shareOfHue(even, blue) < 0.0005, 'nothing is crammed');
  assert.ok(shareOfHue(even, red) < 0.05, 'nor drawn out');

  // Per vertex, a triangle over an edge of the cage takes in all that lies between two islands.
  await page.getByTestId('preset').selectOption('paper');
  await ready(page);
  const smeared = shareOfHue(await look(page, area), blue);
  assert.ok(smeared > 0.005, `${smeared} of the picture is crammed`);
  await page.getByTestId('preset').selectOption('default');
  await ready(page);
  assert.ok(difference(even, await look(page, area)) < 0.0005);

  await page
    .getByTestId('segment-table')
    .locator('select')
    .first()
    .evaluate((select: HTMLSelectElement) => {
      select.value = 'exclude';
      select.dispatchEvent(new Event('change'));
    });
  const clay = middle(await look(page, area));
  assert.ok(Math.max(...clay) - Math.min(...clay) < 40, `what is not painted is grey: ${clay}`);
});
