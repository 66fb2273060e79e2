import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { faults } from '../../../support/axe';
import { saved } from '../../../support/saved';
import { kPlay, openSite } from '../../../support/site';

const site = await openSite();

const kDesk = { viewport: { width: 1000, height: 800 } };

/** Opens the sheet, and waits for its link. @returns Its URL fragment. */
async function share(page: Page): Promise<string> {
  if (!(await page.locator('#share:popover-open').isVisible())) await page.locator('#stage-share').click();
  await page.locator('#share-link[href]').waitFor();
  await page.waitForFunction(() => document.querySelector<HTMLCanvasElement>('#card')!.width === 540);
  return page.getByTestId('share-link').evaluate((anchor) => (anchor as HTMLAnchorElement).hash);
}

/** The share of a picture that is as orange as the tiger. */
function shareOf({ data }: { data: ArrayLike<number> }, is: (r: number, g: number, b: number) => boolean): number {
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i + 3]! > 0 && is(data[i]!, data[i + 1]!, data[i + 2]!)) count++;
  return (4 * count) / data.length;
}

const isOrange = (r: number, g: number, b: number): boolean => r > 150 && r > 1.5 * g && g > 1.3 * b;

test('Share opens a sheet with a preview; the picture is what it shows, or the model alone; Escape closes it', async () => {
  const { page, complaints } = await site.visit(kDesk, kPlay, '#sample=human');
  await share(page);
  assert.deepEqual(await faults(page), []);
  assert.equal(await page.getByTestId('card-name').inputValue(), 'Human bust');
  const before = await page.getByTestId('card').evaluate((card) => (card as HTMLCanvasElement).toDataURL());
  await page.getByTestId('card-name').fill('Ada, at the ball');
  await page.waitForFunction(
    (before) => document.querySelector<HTMLCanvasElement>('#card')!.toDataURL() !== before,
    before,
  );
  const picture = PNG.sync.read((await saved(page, 'save-picture')).bytes);
  assert.deepEqual([picture.width, picture.height], [2160, 2700]);
  assert.ok(picture.data.every((value, i) => i % 4 < 3 || value === 255));
  await page.locator('#share summary').click();
  await page.getByTestId('clear-picture').check();
  const alone = PNG.sync.read((await saved(page, 'save-picture')).bytes);
  const covered = alone.data.filter((value, i) => i % 4 === 3 && value > 0).length / (alone.data.length / 4);
  assert.ok(covered > 0.1 && covered < 0.8, `${covered} of it is the model`);
  await page.keyboard.press('Escape');
  await page.locator('#share').waitFor({ state: 'hidden' });
  assert.equal(await page.evaluate(() => document.activeElement!.id), 'stage-share');
  assert.deepEqual(complaints, []);
});

test('in a film of five seconds the paint rolls on, and it is 1080 × 1350', async () => {
  const { page, complaints } = await site.visit(kDesk, kPlay, '#sample=avatar&layer=tiger,1,ffffff,normal');
  await share(page);
  await page.evaluate(`{
    const card = document.querySelector('#card');
    const small = new OffscreenCanvas(108, 135).getContext('2d', { willReadFrequently: true });
    globalThis.frames = [];
    globalThis.sampling = true;
    const sample = () => {
      small.drawImage(card, 0, 0, 108, 135);
      if (card.width === 1080) frames.push([...small.getImageData(0, 0, 108, 135).data]);
      if (sampling) setTimeout(sample, 100);
    };
    sample();
  }`);
  const { name, bytes } = await saved(page, 'save-film');
  assert.match(name, /\.(webm|mp4)$/);
  assert.ok(bytes.length > 5000);
  const frames = await page.evaluate<number[][]>('(sampling = false, frames)');
  const painted = frames.map((data) => shareOf({ data }, isOrange));
  const most = Math.max(...painted);
  assert.ok(most > 0.02, `${most} is orange`);
  assert.ok(painted[0]! < 0.2 * most, `it begins bare: ${painted[0]} of ${most}`);
  assert.ok(painted.at(-1)! > 0.5 * most, 'and ends painted');
  assert.deepEqual(complaints, []);
});
