import assert from 'node:assert/strict';
import { test } from 'node:test';
import { faults } from '../../support/axe';
import { openSite, passed, settled } from '../../support/site';

const site = await openSite();

/** A script that makes the first load of a tab a first visit. */
const kFirstVisit = `if (!sessionStorage.begun) { sessionStorage.begun = 1; localStorage.removeItem('cagecast-guide') }`;
const kPhone = { viewport: { width: 390, height: 844 }, hasTouch: true };

test('a first visit is offered a way of three steps, which the keyboard can walk, and which is not offered again', async () => {
  const { page, complaints } = await site.visit(kPhone, kFirstVisit);
  const guide = page.getByTestId('guide');
  await guide.waitFor();
  assert.equal(await page.evaluate(() => document.activeElement?.tagName), 'BODY', 'it takes no focus by itself');
  assert.deepEqual(await faults(page), []);
  await guide.getByRole('button', { name: 'Show me' }).click();
  const before = await page.locator('#view-mode input:checked').inputValue();
  for (const [step, seen] of ['divider', 'tools', 'target-file'].entries()) {
    assert.match((await guide.textContent())!, new RegExp(`Step ${step + 1} of 3`));
    const marked = page.locator('.guided').last();
    assert.ok(await marked.isVisible(), seen);
    const isSeen = await marked.evaluate((element) => {
      const { x, y, width, height } = element.getBoundingClientRect();
      return element.contains(document.elementFromPoint(x + width / 2, y + height / 2));
    });
    assert.ok(isSeen || seen === 'tools', `${seen} is in view, and nothing is over it`); // between the tools are gaps
    assert.deepEqual(await faults(page), []);
    await page.keyboard.press('Enter');
  }
  await guide.waitFor({ state: 'detached' });
  assert.equal(await page.locator('#view-mode input:checked').inputValue(), before, 'the view is as it was');
  assert.equal(await page.locator('.guided').count(), 0);

  await page.reload();
  await settled(page);
  assert.equal(await page.evaluate(() => localStorage.getItem('cagecast-guide')), 'seen');
  await passed(page, 1500);
  assert.equal(await guide.count(), 0);
  await page.locator('#method summary').click();
  await page.getByTestId('show-guide').click();
  assert.match((await guide.textContent())!, /Step 1 of 3/);
  await page.keyboard.press('Escape');
  await guide.waitFor({ state: 'detached' });
  assert.equal(await page.evaluate(() => document.activeElement?.id), 'view');
  assert.deepEqual(complaints, []);
});
