import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { glbOf, tetrahedron } from '../../../support/glb';
import { difference, look, modelArea } from '../../../support/picture';
import { drop, glb, openSite, ready, setThreshold, settled, shownCounts, shownParts } from '../../../support/site';

const site = await openSite();

/** Changes the part of the address that says what to show. */
function goTo(page: Page, hash: string): Promise<void> {
  return page.evaluate(async (hash) => {
    const told = new Promise((done) => addEventListener('hashchange', done, { once: true }));
    location.hash = hash;
    await told;
  }, hash);
}

test('a link restores sample, paint, rules, locks, view and camera, in this visit and in another', async () => {
  const { page } = await site.visit();
  await page.getByTestId('sample-select').selectOption({ index: 1 });
  await settled(page);
  await page.locator('#paints label').nth(1).click();
  await settled(page);
  await page.getByTestId('preset').selectOption('paper');
  await settled(page);
  await setThreshold(page, 0.35);
  await page.getByTestId('segment-table').locator('tbody tr select').last().selectOption('exclude');
  await page.locator('input[value=result]').check({ force: true });
  await page.locator('#show-cage').check({ force: true });
  const area = await modelArea(page);
  const front = await look(page, area);
  for (const key of ['ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowUp', '+', '+', '+'])
    await page.locator('#view').press(key);
  const seen = {
    counts: await shownCounts(page),
    parts: await shownParts(page),
    paint: await page.locator('.paints input').nth(1).isChecked(),
    picture: await look(page, area),
  };
  assert.ok(difference(front, seen.picture) > 0.1, 'it is turned');
  await page.getByTestId('share-link').focus();
  const link = await page.getByTestId('share-link').evaluate((anchor) => (anchor as HTMLAnchorElement).href);
  assert.ok(link.startsWith(`${site.url}#`), link);

  const check = async (page: Page): Promise<void> => {
    await ready(page);
    assert.deepEqual(await shownCounts(page), seen.counts);
    assert.deepEqual(await shownParts(page), seen.parts);
    assert.equal(await page.locator('.paints input').nth(1).isChecked(), seen.paint);
    assert.equal(await page.getByTestId('preset').inputValue(), 'paper');
    assert.equal(await page.getByTestId('threshold').inputValue(), '0.35');
    assert.equal(await page.locator('input[value=result]').isChecked(), true);
    assert.match(new URL(link).hash, /&angle=-4,74,1\.331$/, 'three steps to the left, one up, three nearer');
    const apart = difference(seen.picture, await look(page, area));
    assert.ok(apart < 0.002, `the pictures differ in ${apart}`);
  };
  const other = await site.visit({}, undefined, new URL(link).hash);
  await check(other.page);
  assert.deepEqual(other.complaints, []);
  // In a page that shows something else.
  await other.page.getByTestId('sample-select').selectOption({ index: 0 });
  await settled(other.page);
  for (const hash of ['#', new URL(link).hash]) await goTo(other.page, hash);
  await other.page.waitForFunction(
    () => document.querySelector<HTMLSelectElement>('#sample-select')!.selectedIndex === 1,
  );
  await check(other.page);
  // In one that shows it from elsewhere: it is turned, and not opened anew.
  await other.page.locator('#view').press('Home');
  assert.ok(difference(seen.picture, await look(other.page, area)) > 0.1);
  for (const hash of ['#', new URL(link).hash]) await goTo(other.page, hash);
  await check(other.page);
});

test('a click copies the link; models with a cage of their own have none, and the page says why', async () => {
  const { page } = await site.visit({ permissions: ['clipboard-read', 'clipboard-write'] });
  await page.getByTestId('share-link').click();
  await page.locator('#copy-note', { hasText: 'copied' }).waitFor();
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  assert.ok(copied.startsWith(`${site.url}#sample=lizard&`), copied);
  assert.equal(page.url(), site.url, 'the address stays');
  await drop(page, [glb('cage.glb', glbOf(tetrahedron(2), 'thing')), glb('target.glb', glbOf(tetrahedron(), 'thing'))]);
  await settled(page);
  await page.locator('#link-hint', { hasText: 'fits this model alone' }).waitFor();
  assert.equal(await page.getByTestId('share-link').getAttribute('href'), null);
});
