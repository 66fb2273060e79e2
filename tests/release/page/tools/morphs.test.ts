import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { islandCage, islandPaint, morphingBalls } from '../../../support/models';
import { difference, frames, look, modelArea, watch } from '../../../support/picture';
import { saved, validModel } from '../../../support/saved';
import { drop, kNoWebGl, openSite, ready, shownError, type Upload } from '../../../support/site';

const site = await openSite();

const slider = (page: Page, name: string) => page.getByTestId('morphs').getByLabel(name);

/** Waits until what was moved is on show. */
async function moved(page: Page): Promise<void> {
  await page.locator('#live[aria-busy=false]').waitFor();
  assert.equal(await shownError(page), '');
}

async function morph(page: Page, name: string, weight: number): Promise<void> {
  await slider(page, name).fill(String(weight));
  await moved(page);
}

async function open(page: Page, uploads: Upload[]): Promise<void> {
  await drop(page, uploads);
  await ready(page);
}

test('every morph has a slider, even without a name', async () => {
  const { page } = await site.visit();
  assert.equal(await page.getByTestId('morphs').isVisible(), false);
  await open(page, [await islandCage(1), await morphingBalls({ names: [], count: 20 })]);
  assert.equal(await page.getByTestId('morphs').isVisible(), true);
  assert.deepEqual(
    await page.locator('#morph-list span').allTextContents(),
    Array.from({ length: 20 }, (_, n) => `Morph ${n + 1}`),
  );
  await page.getByTestId('sample-select').selectOption('lizard');
  await ready(page);
  assert.equal(await page.getByTestId('morphs').isVisible(), false);
});

test('morphs and an animation of the same morphs exclude each other', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 600 } });
  await open(page, [await islandCage(1.1), await morphingBalls({ animated: true }), islandPaint()]);
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const rest = await look(page, area);
  await morph(page, 'drop', 1);
  await page.getByTestId('animation').selectOption('0');
  await moved(page);
  assert.equal(await slider(page, 'drop').inputValue(), '0', 'the animation has the word');
  await watch(page, area, (picture) => difference(rest, picture) > 0.02);
  await morph(page, 'grow', 0.5);
  assert.equal(await page.getByTestId('animation').inputValue(), '-1', 'it has ended');
  const still = await look(page, area);
  await frames(page, 10);
  assert.equal(difference(still, await look(page, area)), 0);
  await page.locator('#morphs-reset').click();
  await moved(page);
  assert.equal(difference(rest, await look(page, area)), 0);
  assert.deepEqual(complaints, []);
});

test('Smile moves the mouth of a model that is no VRM, and lets go of it; its clip goes on, and pauses', async () => {
  const { page, complaints } = await site.visit(
    { viewport: { width: 1000, height: 600 } },
    undefined,
    '#sample=avatar',
  );
  await page.locator('input[value=result]').check({ force: true });
  assert.equal(
    await page.getByTestId('morphs').locator('details').getAttribute('open'),
    null,
    'the sliders are folded',
  );
  const area = await modelArea(page);
  const weight = (name: string) => page.locator(`#morph-list input[name=${name}]`).inputValue().then(Number);
  const smile = page.getByRole('button', { name: 'Smile' });
  await page.locator('#view').focus();
  for (const key of [...Array(8).fill('+'), ...Array(11).fill('Shift+ArrowUp')]) await page.keyboard.press(key); // its face
  await frames(page, 30);
  const rest = await look(page, area);
  await smile.click();
  await moved(page);
  assert.deepEqual([await weight('mouthSmileLeft'), await weight('mouthSmileRight')], [0.9, 0.9]);
  const smiling = await look(page, area);
  assert.ok(difference(rest, smiling) > 0, 'it is seen');
  await page.getByRole('button', { name: 'Angry' }).click();
  await moved(page);
  assert.deepEqual([await weight('mouthSmileLeft'), await weight('browDownLeft')], [0, 1]);
  assert.equal(await smile.getAttribute('aria-pressed'), 'false', 'one at a time');
  await smile.click();
  await moved(page);

  const play = page.getByTestId('clip-play');
  assert.equal(await play.getAttribute('aria-label'), 'Play', 'no motion for those who want none');
  await play.press('Enter');
  assert.equal(await play.getAttribute('aria-label'), 'Pause');
  await watch(page, area, (picture) => difference(smiling, picture) > 0.02);
  assert.equal(await weight('mouthSmileLeft'), 0.9, 'the clip moves no morphs');
  await play.press('Enter');
  await frames(page, 2);
  const paused = await look(page, area);
  await frames(page, 10);
  assert.equal(difference(paused, await look(page, area)), 0);
  await page.getByTestId('animation').selectOption('-1');
  await smile.click();
  await moved(page);
  assert.equal(difference(rest, await look(page, area)), 0);
  assert.deepEqual(complaints, []);
});

test('where motion is wanted, Smile eases in, and a blink comes on top of it', async () => {
  const { page, complaints } = await site.visit({ reducedMotion: 'no-preference' }, kNoWebGl, '#sample=avatar');
  const seen = (name: string, from: number, to: number) =>
    page.waitForFunction(
      ([name, from, to]) => {
        const { valueAsNumber } = document.querySelector<HTMLInputElement>(`#morph-list input[name=${name}]`)!;
        return valueAsNumber > from && valueAsNumber < to;
      },
      [name, from, to] as const,
      { polling: 'raf' },
    );
  await Promise.all([seen('mouthSmileLeft', 0, 0.9), page.getByRole('button', { name: 'Smile' }).click()]);
  await seen('mouthSmileLeft', 0.89, 1);
  const blink = page.getByRole('button', { name: 'Blink' });
  await Promise.all([seen('eyeBlinkRight', 0, 1.1), blink.click()]);
  await seen('eyeBlinkRight', -1, 1e-9);
  assert.equal(await blink.getAttribute('aria-pressed'), 'false');
  assert.equal(await page.getByRole('button', { name: 'Smile' }).getAttribute('aria-pressed'), 'true');
  assert.deepEqual(complaints, []);
});

test('a deformed model is saved undeformed, and the page says so', async () => {
  const { page } = await site.visit();
  const target = await morphingBalls();
  await open(page, [target, await islandCage(0.8)]);
  assert.equal(await page.getByTestId('pose-note').isVisible(), false);
  const atRest = await saved(page, 'export-glb');
  await morph(page, 'grow', 0.9);
  await page.getByTestId('pose-note').waitFor();
  assert.deepEqual((await saved(page, 'export-glb')).bytes, atRest.bytes);
  assert.deepEqual((await validModel(atRest.bytes)).getRoot().listMeshes()[0]!.getWeights(), [0, 0]);
  await morph(page, 'grow', 0);
  await page.getByTestId('pose-note').waitFor({ state: 'hidden' });
});
