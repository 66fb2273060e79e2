import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Locator } from 'playwright-core';
import { glbOf, tetrahedron } from '../../support/glb';
import { balls, islandCage } from '../../support/models';
import { difference, look, modelArea } from '../../support/picture';
import { drop, glb, openSite, ready, type ShownPart, shownCounts, shownParts } from '../../support/site';

const site = await openSite();
const visit = await site.visit();

const table = (): Locator => visit.page.getByTestId('segment-table');
/** The choice in a row, found by what a screen reader says. */
const choice = ({ name }: ShownPart): Locator =>
  table().getByRole('combobox', { name: `Override for ${name}`, exact: true });

test('uncovered teeth share a row, and its override applies to all', async () => {
  const { page } = visit;
  const counts = await shownCounts(page);
  const parts = await shownParts(page);
  const teeth = parts.filter(({ name }) => /^upper-teeth.*, \d+ pieces$/.test(name));
  assert.equal(teeth.length, 1);
  const pieces = Number(/(\d+) pieces/.exec(teeth[0]!.name)![1]);
  assert.ok(pieces > 5 && teeth[0]!.points > 5 * pieces, `${pieces} teeth of ${teeth[0]!.points} points`);
  const culled = async (): Promise<number> =>
    Number(/(\d+) culled/.exec((await page.locator('#segment-summary').textContent())!)![1]);
  const before = await culled();
  await choice(teeth[0]!).selectOption('keep');
  assert.equal(await culled(), before - pieces);
  await choice(teeth[0]!).selectOption('auto');
  assert.equal(await culled(), before);
  assert.deepEqual(await shownCounts(page), counts);
});

test('the hovered or focused part is highlighted', async () => {
  const { page } = visit;
  const area = await modelArea(page);
  await page.mouse.move(5, 5);
  const before = await look(page, area);
  const largest = (await shownParts(page)).toSorted((a, b) => b.points - a.points)[0]!;
  await choice(largest).hover();
  assert.ok(difference(before, await look(page, area)) > 0.05, 'under the pointer');
  await page.mouse.move(5, 5);
  assert.ok(difference(before, await look(page, area)) < 0.0005, 'and no longer');
  await choice(largest).focus();
  assert.ok(difference(before, await look(page, area)) > 0.05, 'with the keyboard');
  await choice(largest).blur();
  assert.ok(difference(before, await look(page, area)) < 0.0005);
});

test('the tree is searched by name and state, and its branches are closed and opened', async () => {
  const { page } = visit;
  const seen = () => table().locator('tbody tr:not(.mesh) th').filter({ visible: true }).allTextContents();
  const all = await seen();
  await page.getByTestId('parts-search').fill('EYE');
  assert.deepEqual(await seen(), ['l-eye', 'r-eye']);
  await page.getByTestId('parts-state').selectOption('painted');
  assert.deepEqual(await seen(), []);
  await page.getByTestId('parts-search').fill('');
  assert.deepEqual(await seen(), ['skin']);
  await page.getByTestId('parts-state').selectOption('all');
  const branch = table().getByRole('button', { name: 'lower-teeth' });
  await branch.press('Enter');
  assert.deepEqual(
    await seen(),
    all.filter((name) => !name.startsWith('lower-teeth')),
  );
  assert.equal(await branch.getAttribute('aria-expanded'), 'false');
  await branch.press('Enter');
  assert.deepEqual(await seen(), all);
});

test('the table follows a moving model', async () => {
  const { page } = visit;
  const before = await shownParts(page);
  const inflate = async (amount: string): Promise<void> => {
    await page.locator('#deform').selectOption('inflate');
    await page.locator('#amount').fill(amount);
    await page.waitForFunction(
      (amount) =>
        document.querySelector<HTMLOutputElement>('#amount-value')!.value === amount &&
        document.querySelector('#live')!.ariaBusy === 'false',
      Number(amount).toFixed(2),
    );
  };
  await inflate('0.9');
  assert.notDeepEqual(
    (await shownParts(page)).map(({ covered }) => covered),
    before.map(({ covered }) => covered),
  );
  await inflate('0');
  assert.deepEqual(await shownParts(page), before);
});

test('of very many parts the largest fifty are listed; overrides of another model are dropped', async () => {
  const { page } = visit;
  const [first] = await shownParts(page);
  await choice(first!).selectOption('keep');
  await drop(page, [await balls(130), await islandCage(1)]);
  await ready(page);
  const parts = await shownParts(page);
  assert.equal(parts.length, 50);
  assert.ok(parts.every(({ lock }) => lock === 'auto'));
  const numbers = parts.map(({ name }) => Number(/^ball (\d+)$/.exec(name)?.[1])).toSorted((a, b) => a - b);
  assert.deepEqual(
    numbers,
    Array.from({ length: 50 }, (_, i) => i),
  );
  assert.match((await table().locator('caption').textContent())!, /50 largest of 130/);

  await page.getByTestId('target-input').setInputFiles(glb('thing.glb', glbOf(tetrahedron(0.5), 'thing')));
  await ready(page);
  assert.deepEqual(await shownParts(page), [
    { name: 'thing', points: 4, covered: '100 %', culled: false, lock: 'auto' },
  ]);
});

test('on a phone a tapped row stays highlighted until something else is tapped', async () => {
  // With fewer pixels, the stage, which stays while the page scrolls, would be drawn between them.
  const phone = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 1, hasTouch: true, isMobile: true };
  const { page } = await site.visit(phone);
  // What is said of the cage's fit comes later, and moves what is below it out from under a finger.
  await page.waitForFunction(() => document.querySelector('#fit-verdict')!.textContent !== '');
  const area = await modelArea(page);
  const row = page.getByTestId('segment-table').getByRole('rowheader', { name: 'skin' }).first();
  await row.scrollIntoViewIfNeeded();
  const before = await look(page, area);
  await row.tap();
  assert.ok(difference(before, await look(page, area)) > 0.05, 'lit');
  await page.locator('#segment-caption').tap();
  assert.ok(difference(before, await look(page, area)) < 0.0005, 'and dark again');
});
