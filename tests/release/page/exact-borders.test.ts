import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { cancelOnceShown, kSlowWorker } from '../../support/cancel';
import { ball, islandCage, islandPaint } from '../../support/models';
import { difference, look, modelArea, shareOfHue } from '../../support/picture';
import { drop, openSite, ready, setThreshold } from '../../support/site';

const site = await openSite();
const visit = await site.visit();

const isCut = /^Adds [\d,]+ triangles\.$/;
const note = (page: Page): Promise<string | null> => page.getByTestId('borders-note').textContent();
const chooseMode = (page: Page, value: string): Promise<void> =>
  page.locator(`input[value=${value}]`).check({ force: true });

/** Waits until the model is shown as it was cut. */
async function cut(page: Page): Promise<void> {
  await page.waitForFunction(() => /Adds/.test(document.querySelector('[data-testid=borders-note]')!.textContent!));
  await ready(page);
}

/** Notes what is said of borders, from now on. */
async function watchNote(page: Page): Promise<() => Promise<string[]>> {
  await page.evaluate(() => {
    const seen: string[] = [];
    Object.assign(globalThis, { seen });
    new MutationObserver(() => seen.push(document.querySelector('[data-testid=borders-note]')!.textContent!)).observe(
      document.querySelector('[data-testid=borders-note]')!,
      { childList: true },
    );
  });
  return () => page.evaluate(() => (globalThis as unknown as { seen: string[] }).seen);
}

test('another threshold, lock or paint is shown at once, and cut again if the zones change', async () => {
  const { page, complaints } = visit;
  await page.getByTestId('exact-borders').check();
  await cut(page);
  const area = await modelArea(page);
  const before = await look(page, area);
  const seen = await watchNote(page);
  await setThreshold(page, 0.49);
  assert.deepEqual(await seen(), [], 'nothing is decided otherwise: it stays');
  await setThreshold(page, 1);
  await page.waitForFunction(() => (globalThis as unknown as { seen: string[] }).seen.length >= 2);
  assert.equal((await seen())[0], '', 'its own triangles first');
  await cut(page);
  assert.ok(difference(before, await look(page, area)) > 0.05);
  await setThreshold(page, 0.5);
  await page.waitForFunction(() => (globalThis as unknown as { seen: string[] }).seen.length >= 4);
  await cut(page);
  assert.ok(difference(before, await look(page, area)) < 0.0005);
  await page.getByTestId('texture-input').setInputFiles(islandPaint());
  await ready(page);
  assert.match((await note(page))!, isCut);
  assert.deepEqual(complaints, []);
});

test('cancelling switches exact borders off and keeps the view', async () => {
  const { page, complaints } = await site.visit({}, kSlowWorker);
  await chooseMode(page, 'result');
  const area = await modelArea(page);
  const before = await look(page, area);
  const givenUp = cancelOnceShown(page, 'Escape');
  await page.getByTestId('exact-borders').check();
  await givenUp;
  assert.equal(await page.getByTestId('status').textContent(), 'ready');
  assert.equal(await page.getByTestId('exact-borders').isChecked(), false);
  assert.deepEqual([await page.getByTestId('status').textContent(), await note(page)], ['ready', '']);
  assert.ok(difference(before, await look(page, area)) < 0.0005);
  assert.deepEqual(complaints, []);
});

for (const [name, options] of Object.entries({ mirrored: { mirrored: true }, 'skinned and morphed': { pose: true } })) {
  test(`a cut model is painted like a whole one: ${name}`, async () => {
    const { page, complaints } = await site.visit();
    await drop(page, [await ball(options), await islandCage(1), islandPaint()]);
    await ready(page);
    await chooseMode(page, 'result');
    const area = await modelArea(page);
    const hues = async (): Promise<number[]> => {
      const picture = await look(page, area);
      return [295, 237, 140].map((hue) => shareOfHue(picture, hue));
    };
    const [, , whole] = await hues();
    await page.getByTestId('exact-borders').check();
    await cut(page);
    const [violet, blue, green] = (await hues()) as [number, number, number];
    assert.ok(violet < 0.0005, `${violet} of the picture is smeared`);
    assert.ok(blue < 0.001, `${blue} of the picture shows through`);
    assert.ok(Math.abs(green - whole!) < 0.01, `${green} of the picture is painted, ${whole} before`);
    assert.deepEqual(complaints, []);
  });
}
