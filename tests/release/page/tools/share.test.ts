import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { faults } from '../../../support/axe';
import { head, middleOf } from '../../../support/cages';
import { savedTexture } from '../../../support/layers';
import { saved } from '../../../support/saved';
import { drop, kPlay, openSite, ready } from '../../../support/site';

const site = await openSite();

const kDesk = { viewport: { width: 1000, height: 800 } };

/** Opens the sheet, and waits for its link. @returns Its URL fragment. */
async function share(page: Page): Promise<string> {
  if (!(await page.locator('#share:popover-open').isVisible())) await page.locator('#stage-share').click();
  await page.locator('#share-link[href]').waitFor();
  await page.waitForFunction(() => document.querySelector<HTMLCanvasElement>('#card')!.width === 540);
  return page.getByTestId('share-link').evaluate((anchor) => (anchor as HTMLAnchorElement).hash);
}

/** The composite of the layers. In Play they are folded. */
async function textureOf(page: Page): Promise<PNG> {
  await page
    .locator('details:has([data-testid=layer-list])')
    .evaluate((one) => ((one as HTMLDetailsElement).open = true));
  return savedTexture(page);
}

/** The share of a picture that is about as red and blue as the brush, or as orange as the tiger. */
function shareOf({ data }: { data: ArrayLike<number> }, is: (r: number, g: number, b: number) => boolean): number {
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i + 3]! > 0 && is(data[i]!, data[i + 1]!, data[i + 2]!)) count++;
  return (4 * count) / data.length;
}

const isPink = (r: number, g: number, b: number): boolean => r > 180 && g < 90 && b > 60;
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

test('a link has the look of a model of one’s own: it is shown on a sample, and worn by the next model', async () => {
  const { page } = await site.visit(kDesk, kPlay);
  await drop(page, [head()]);
  await ready(page);
  await page.locator('.paints label', { hasText: 'Harlequin' }).click();
  await ready(page);
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  const { x, y } = await middleOf(page);
  await page.mouse.move(x - 40, y - 60);
  await page.mouse.down();
  await page.mouse.move(x + 40, y - 40, { steps: 6 });
  await page.mouse.up();
  await page.waitForFunction(() => document.querySelectorAll('#layer-list li').length === 2);
  const drawn = await textureOf(page);
  assert.ok(shareOf(drawn, isPink) > 0.001, 'a stroke');
  await share(page);
  await page.waitForFunction(() => document.querySelector<HTMLAnchorElement>('#share-link')!.hash.includes('strokes'));
  const hash = await share(page);
  assert.match(hash, /^#look=human-head&layer=harlequin,/);
  assert.ok(hash.length < 4000, `${hash.length} letters`);
  assert.match((await page.locator('#link-hint').textContent())!, /has the look, not your model/);

  const isSame = async (page: Page): Promise<void> => {
    await page.waitForFunction(() => document.querySelectorAll('#layer-list li').length === 2);
    const texture = await textureOf(page);
    let apart = 0;
    for (let i = 0; i < texture.data.length; i++) if (Math.abs(texture.data[i]! - drawn.data[i]!) > 24) apart++;
    assert.ok(apart / texture.data.length < 0.002, `${apart} bytes differ`);
    assert.ok(shareOf(texture, isPink) > 0.8 * shareOf(drawn, isPink));
  };
  const { page: other, complaints } = await site.visit(kDesk, kPlay, hash);
  await ready(other);
  await other.getByTestId('ask').filter({ hasText: 'Drop yours' }).waitFor();
  assert.match((await other.locator('#target-name').textContent())!, /target/);
  await isSame(other);
  assert.equal(await share(other), hash, 'it is carried on');
  await other.keyboard.press('Escape');
  await drop(other, [head()]);
  await ready(other);
  assert.equal(await other.locator('#target-name').textContent(), 'bust.glb');
  await isSame(other);
  assert.doesNotMatch(
    (await other.getByTestId('ask').filter({ visible: true }).allTextContents()).join(),
    /Drop yours/,
  );
  assert.deepEqual(complaints, []);
});

test('of a link that is damaged, one sentence says so, and the page goes on', async () => {
  for (const hash of [
    '#look=octopus&layer=tiger,1,ffffff,normal',
    '#sample=nobody',
    '#sample=human&layer=harlequin,1,ffffff,normal&layer=strokes:Y2BgYGRg',
    '#look=human-body&layer=nothing,1,ffffff,normal',
  ]) {
    const { page, complaints } = await site.visit(kDesk, kPlay, hash);
    await ready(page);
    await page.getByTestId('ask').filter({ hasText: 'The link is cut off or damaged.' }).waitFor();
    await page.locator('#stage-verdict:not([data-verdict=""])').waitFor();
    assert.deepEqual(complaints, []);
  }
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
