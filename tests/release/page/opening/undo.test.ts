import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { faults } from '../../../support/axe';
import { asset } from '../../../support/cages';
import { image, names, rows, savedTexture } from '../../../support/layers';
import { drop, glb, kPlay, openSite, ready, shownParts, type Visit } from '../../../support/site';

const site = await openSite();

const dino = () => [
  glb('dino.glb', asset('human', 'target.glb')),
  glb('dino-cage.glb', asset('human-misaligned', 'cage.glb')),
];

/** All that somebody would miss. */
async function state(page: Page) {
  await page.locator('#live[aria-busy=true]').waitFor({ state: 'detached' });
  const texture = await savedTexture(page);
  const value = (id: string): Promise<string> => page.getByTestId(id).inputValue();
  return {
    files: (await page.locator('.files .name').allTextContents()).slice(0, 2),
    overrides: (await shownParts(page)).flatMap(({ name, lock }) => (lock === 'auto' ? [] : [[name, lock]])),
    layers: await names(page),
    texture: createHash('sha256').update(texture.data).digest('hex'),
    rules: [await value('threshold'), await value('preset')],
    amount: await value('amount'),
  };
}

/** Opens files of one's own, and changes what can be changed. */
async function work({ page }: Visit): Promise<void> {
  await drop(page, dino());
  await ready(page);
  await drop(page, [image('stripes.png', 64, (x) => [4 * x, 20, 200, 255])]);
  await rows(page).filter({ hasText: 'stripes.png' }).waitFor();
  const [part] = await shownParts(page);
  await page.getByLabel(`Override for ${part!.name}`, { exact: true }).selectOption('exclude');
  await page.getByTestId('threshold').fill('0.7');
  await page.getByTestId('amount').fill('0.4');
  await page.locator('#view').focus();
  for (const key of ['ArrowLeft', 'ArrowLeft', '+', 'Shift+ArrowLeft', 'Shift+ArrowUp']) await page.keyboard.press(key);
  await ready(page);
}

/** The view at rest, beside the verdict, which comes when the cage was inspected: seconds after the model on a slow machine. */
async function viewOf(page: Page): Promise<Buffer> {
  await page.locator('#stage-verdict:not([data-verdict=""])').waitFor();
  const take = () => page.locator('#view').screenshot();
  for (let [before, now] = [await take(), await take()]; ; [before, now] = [now, await take()])
    if (now.equals(before)) return now;
}

test('a sample over own work can be taken back by the message and by the key, with all that was there', async () => {
  const visit = await site.visit({ viewport: { width: 900, height: 700 } });
  const { page, complaints } = visit;
  await work(visit);
  const before = await state(page);
  const seen = await viewOf(page);
  const box = page.getByTestId('ask');
  for (const undo of [
    () => box.getByRole('button', { name: 'Undo' }).click(),
    () => page.locator('#view').press('Control+z'),
  ]) {
    await page.getByTestId('sample-select').selectOption('lizard');
    await ready(page);
    await box.filter({ hasText: 'Replaced dino.' }).waitFor();
    assert.equal(await page.getByTestId('undo').getAttribute('title'), 'Undo: replacing dino');
    assert.ok(await page.getByTestId('put-away').isHidden(), 'there is one way back');
    assert.deepEqual(await faults(page), []);
    await undo();
    await page.locator('#target-name', { hasText: 'dino.glb' }).waitFor();
    await ready(page);
    assert.ok(await box.isHidden());
    assert.deepEqual(await state(page), before);
  }
  assert.ok(seen.equals(await viewOf(page)), 'from where it was seen');
  assert.deepEqual(complaints, []);
});

test('the message goes after a while, or with the next step; own files over own, and over a sample that was changed, say it, too', async () => {
  const { page } = await site.visit({ viewport: { width: 900, height: 700 } }, kPlay);
  const box = page.getByTestId('ask');
  await page.getByTestId('menu').click();
  await page.getByTestId('sample-select').selectOption('human');
  await ready(page);
  assert.ok(await box.isHidden(), 'nobody misses what was only looked at');
  await drop(page, [image('stripes.png', 64, (x) => [4 * x, 20, 200, 255])]);
  await rows(page).filter({ hasText: 'stripes.png' }).waitFor({ state: 'attached' });
  await page.clock.install();
  await drop(page, dino());
  await box.filter({ hasText: /^Replaced Human/ }).waitFor();
  await page.clock.runFor(12_000);
  await box.waitFor({ state: 'hidden' });
  await page.getByTestId('target-input').setInputFiles(dino().map((file) => ({ ...file, name: `other-${file.name}` })));
  await box.filter({ hasText: 'Replaced dino.' }).waitFor();
  await drop(page, [image('dots.png', 64, (x) => [4 * x, 20, 200, 255])]);
  await box.waitFor({ state: 'hidden' });
  for (let i = 0; i < 2; i++) await page.locator('#view').press('Control+z');
  await page.locator('#target-name', { hasText: /^dino.glb/ }).waitFor();
});
