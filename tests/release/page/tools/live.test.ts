import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { kDeforms } from '../../../../web/src/state/deform';
import { ball, islandCage, islandPaint } from '../../../support/models';
import { difference, frames, look, modelArea, shareOfHue, watch } from '../../../support/picture';
import { drop, openSite, ready, shownCounts, shownError } from '../../../support/site';

const site = await openSite();

/** Moves the model as far as that, and waits until it is on show. */
async function bend(page: Page, amount: number): Promise<void> {
  await page.getByTestId('amount').fill(String(amount));
  await page.locator('#live[aria-busy=false]').waitFor();
  assert.equal(await page.locator('#amount-value').textContent(), amount.toFixed(2));
  // A browser's clock may be too coarse for a ball.
  assert.match((await page.getByTestId('frame-time').textContent())!, /^\d/);
}

test('a deformed model is shown with its paint, and returns to the same pixels', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 600 } });
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const before = { counts: await shownCounts(page), picture: await look(page, area) };
  for (const how of kDeforms) {
    await page.getByTestId('deform').selectOption(how);
    await bend(page, 0.8);
    const picture = await look(page, area);
    assert.ok(difference(before.picture, picture) > 0.02, `${how} is seen`);
    await page.locator('#show-paint').uncheck({ force: true });
    assert.ok(difference(picture, await look(page, area)) > 0.02, `${how} is painted`);
    await page.locator('#show-paint').check({ force: true });
  }
  // So is the cage: as it is drawn anew by a transfer.
  await page.locator('#show-cage').check({ force: true });
  const bent = await look(page, area);
  for (const preset of ['paper', 'default']) {
    await page.getByTestId('preset').selectOption(preset);
    await ready(page);
    await page.locator('#live[aria-busy=false]').waitFor();
  }
  assert.ok(difference(bent, await look(page, area)) < 0.001, 'the cage is shown where it is moved to');
  await page.locator('#show-cage').uncheck({ force: true });
  await bend(page, 0);
  assert.deepEqual(await shownCounts(page), before.counts);
  assert.equal(difference(before.picture, await look(page, area)), 0);
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

test('Animate runs until it is switched off or another model is opened', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 960, height: 500 } });
  const amount = (): Promise<string> => page.getByTestId('amount').inputValue();
  await page.getByTestId('deform-moves').check();
  await page.waitForFunction(() => {
    const all = globalThis as unknown as { amounts?: Set<string> };
    return (
      (all.amounts ??= new Set()).add(document.querySelector<HTMLInputElement>('[data-testid=amount]')!.value).size >= 3
    );
  });
  assert.ok(Number(await page.getByTestId('frame-time').textContent()) > 0);
  await page.getByTestId('deform-moves').uncheck();
  await page.locator('#live[aria-busy=false]').waitFor();
  const last = await amount();
  await frames(page, 30);
  assert.equal(await amount(), last, 'it has stopped');
  await page.getByTestId('deform-moves').check();
  await page.getByTestId('sample-select').selectOption({ index: 1 });
  await ready(page);
  await page.waitForFunction(() => !document.querySelector<HTMLInputElement>('#deform-moves')!.checked);
  assert.equal(await page.getByTestId('amount').inputValue(), '0');
  assert.deepEqual(complaints, []);
});

test('an animated model plays with its paint', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 600 } });
  const paint = islandPaint();
  await drop(page, [await islandCage(1), { ...(await ball({ animated: true })), name: 'target.glb' }, paint]);
  await ready(page);
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const rest = await look(page, area);
  assert.ok(shareOfHue(rest, 140) > 0.05, 'it is painted green');
  assert.equal(await page.getByTestId('animation').inputValue(), '-1', 'no motion for those who want none');

  await page.getByTestId('animation').selectOption('0');
  await watch(page, area, (picture) => {
    const [green, blue] = [shareOfHue(picture, 140), shareOfHue(picture, 230)];
    assert.ok(green > 0.05 && blue < 0.02, `the paint moves with it: ${green} green, ${blue} of the model's own blue`);
    return difference(rest, picture) > 0.02;
  });
  await page.getByTestId('animation').selectOption('-1');
  assert.ok(difference(rest, await look(page, area)) < 0.002, 'it goes back to rest');
  assert.deepEqual(complaints, []);
});
