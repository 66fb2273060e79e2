import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { head, middleOf } from '../../support/cages';
import { rows } from '../../support/layers';
import { lumpyBall } from '../../support/models';
import { drop, openSite, ready } from '../../support/site';

const site = await openSite();

const kDesk = { viewport: { width: 1440, height: 900 } };

const choose = (page: Page, key: string): Promise<void> =>
  page.locator(`#tools input[data-key=${key}]`).check({ force: true });

/** Which layers are visible, from the uppermost. */
const visible = (page: Page): Promise<boolean[]> =>
  rows(page)
    .locator('input[name=visible]')
    .evaluateAll((boxes) => boxes.map((box) => (box as HTMLInputElement).checked));

test('a model too large to be inspected by itself gets a cage, and is offered an inspection', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 390, height: 844 }, hasTouch: true });
  await drop(page, [await lumpyBall(250)]);
  await ready(page);
  assert.equal(await page.locator('#stage-verdict-text').textContent(), 'The cage is not checked yet');
  assert.equal(await page.getByTestId('stage-remedy').textContent(), 'Check it');
  await page.getByTestId('stage-remedy').click();
  await page.locator('#stage-verdict:not([data-verdict=""])').waitFor();
  assert.match((await page.locator('#stage-verdict-text').textContent())!, /^\d+ % paintable/);
  assert.deepEqual(complaints, []);
});

for (const key of ['b', 's'])
  test(`what is drawn on a cage that was made lies over its paint, as one step: ${key}`, async () => {
    const { page, complaints } = await site.visit(kDesk);
    await drop(page, [head()]);
    await ready(page);
    assert.deepEqual(await visible(page), [true]);
    await page.locator('#view-mode input[value=result]').check({ force: true });
    await choose(page, key);
    const { x, y } = await middleOf(page);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 20, y + 20, { steps: 3 });
    await page.mouse.up();
    await rows(page).nth(1).waitFor();
    assert.deepEqual(await visible(page), [true, true]);
    await page.getByTestId('undo').click();
    assert.deepEqual(await visible(page), [true], 'one step');
    assert.deepEqual(complaints, []);
  });
