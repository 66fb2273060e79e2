import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page, Route } from 'playwright-core';
import { faults } from '../../../support/axe';
import { kNoWebGl, openSite, ready, settled, shownError } from '../../../support/site';

const site = await openSite();

const kHuman = /\/human\/target\.glb/;

/** Answers only when the test lets it. @returns a function that waits for the next request. */
async function hang(page: Page, address: RegExp): Promise<() => Promise<Route>> {
  const held: Route[] = [];
  let arrive = (): void => {};
  await page.route(address, (route) => {
    held.push(route);
    arrive();
  });
  return async () => {
    while (held.length === 0) await new Promise<void>((done) => (arrive = done));
    return held.shift()!;
  };
}

test('a sample that does not come is said to after ten seconds, and can be asked for again; it may come meanwhile', async () => {
  const { page } = await site.visit({}, kNoWebGl);
  const box = page.getByTestId('ask');
  const request = await hang(page, kHuman);
  await page.clock.install();
  const choose = async (): Promise<Route> => {
    // Else the page's clock would run on, however long this takes.
    await page.clock.pauseAt((await page.evaluate(() => Date.now())) + 1000);
    await page.getByTestId('sample-select').selectOption('human');
    const asked = await request();
    await page.clock.runFor(9_000);
    assert.ok(await box.isHidden());
    await page.clock.runFor(2_000);
    await box.filter({ hasText: /^Human.*: still waiting for the server\./ }).waitFor();
    await page.clock.resume();
    return asked;
  };
  const asked = await choose();
  assert.deepEqual(await faults(page), []);
  await asked.continue();
  await box.waitFor({ state: 'hidden' });
  await ready(page);

  await page.getByTestId('sample-select').selectOption('lizard');
  await ready(page);
  await choose();
  // What is held stays so, as it would not if its route were taken away.
  await page.route(kHuman, (route) => route.continue());
  await box.getByRole('button', { name: 'Try again' }).click();
  await page.locator('#target-name', { hasText: 'target.glb' }).waitFor();
  await ready(page);
  assert.equal(await page.getByTestId('sample-select').inputValue(), 'human');
  assert.ok(await box.isHidden());

  // Whoever cancels is not told any more.
  await hang(page, /\/lizard\/cage\.glb/);
  await page.getByTestId('sample-select').selectOption('lizard');
  await page.getByTestId('cancel').click();
  await page.clock.runFor(11_000);
  assert.ok(await box.isHidden());
});

test('a sample that fails can be asked for again', async () => {
  const { page } = await site.visit({}, kNoWebGl);
  const box = page.getByTestId('ask');
  await page.route(kHuman, (route) => route.abort());
  await page.getByTestId('sample-select').selectOption('human');
  await box.filter({ hasText: /^Human.*: not loaded\./ }).waitFor();
  assert.equal(await settled(page), 'error');
  assert.equal(await shownError(page), 'human/target.glb: the file could not be loaded');
  assert.equal(await page.getByTestId('sample-select').inputValue(), 'lizard', 'what is shown');
  await page.unroute(kHuman);
  await box.getByRole('button', { name: 'Try again' }).click();
  await page.locator('#status[data-state=ready]').waitFor({ state: 'attached' });
  assert.equal(await page.getByTestId('sample-select').inputValue(), 'human');
  assert.ok(await box.isHidden());
  assert.equal(await shownError(page), '');
});

test('so can the list of samples', async () => {
  const { page } = await site.visit({}, async (page) => {
    await page.addInitScript(kNoWebGl);
    await page.route(/\/samples\/index\.json/, (route) => route.abort());
  });
  await page.getByTestId('ask').filter({ hasText: 'The samples: not loaded.' }).waitFor();
  await page.unroute(/\/samples\/index\.json/);
  await page.getByRole('button', { name: 'Try again' }).click();
  await ready(page);
  await page.waitForFunction(() => document.querySelector<HTMLSelectElement>('#sample-select')!.options.length > 2);
});
