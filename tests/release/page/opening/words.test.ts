import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page, Route } from 'playwright-core';
import { fitted, head } from '../../../support/cages';
import { saved } from '../../../support/saved';
import { drop, openSite, ready, settled } from '../../../support/site';

const site = await openSite();

/** The page's words on the shown model: all visible notes and counts, without those on this visit. */
async function words(page: Page): Promise<string[]> {
  await page.locator('#stage-verdict:not([data-verdict=""])').waitFor();
  await page.locator('#threshold-flips:not(:empty)').waitFor({ state: 'attached' }); // it is sought a while later
  return page
    .locator(
      '[role=status], .hint, .note, .total, .verdict, .name, .landmark-spots button, #part-menu-text, #stage-notice, .landmark-ask',
    )
    .evaluateAll((all) =>
      all
        .filter((one) => one.checkVisibility() && !['ask', 'summary', 'time-note'].includes(one.id))
        .map((one) => `${one.id || one.className}: ${one.textContent}`),
    );
}

const notes = (page: Page): Promise<string[]> =>
  page
    .locator('#cage-note, #cage-missing, #landmarks, .landmark-spots button, #export-note, #put-away, #borders-note')
    .evaluateAll((all) =>
      all.filter((one) => one.checkVisibility() && (one.textContent || one.ariaLabel)).map((one) => one.id),
    );

async function work(page: Page): Promise<void> {
  await drop(page, [head()]);
  await ready(page);
  await page.locator('#more').evaluate((more) => ((more as HTMLDetailsElement).open = true));
  await fitted(page);
  await page
    .locator('#paint-into [value=texture]:enabled, #no-texture:not([hidden])')
    .first()
    .waitFor({ state: 'attached' });
  await page.getByTestId('exact-borders').check({ force: true });
  await page.locator('#borders-note', { hasText: 'Adds' }).waitFor();
  await ready(page);
  await saved(page, 'export-glb');
  await ready(page);
  await page.getByTestId('exact-borders').uncheck({ force: true });
}

test('nothing that is said of a model is said of the next one, nor while that is being loaded', async () => {
  const options = { viewport: { width: 1000, height: 700 } };
  const first = await site.visit(options);
  await first.page.locator('#more').evaluate((more) => ((more as HTMLDetailsElement).open = true));
  await first.page.getByTestId('sample-select').selectOption('car');
  await ready(first.page);
  const fresh = await words(first.page);

  const { page, complaints } = await site.visit(options);
  await work(page);
  const before = await notes(page);
  for (const id of ['cage-note', 'landmarks', '']) assert.ok(before.includes(id), `${before} have ${id}`);
  const held: Route[] = [];
  await page.route(/\/car\/target\.glb/, (route) => void held.push(route));
  await page.getByTestId('sample-select').selectOption('car');
  await page.locator('#status[data-state=working]').waitFor({ state: 'attached' });
  assert.deepEqual(await notes(page), [], 'while it is being loaded');
  for (const route of held.splice(0)) await route.abort();
  assert.equal(await settled(page), 'error');
  assert.deepEqual(await notes(page), before, 'what is shown is what it was');
  await page.getByTestId('ask').getByRole('button', { name: 'Try again' }).waitFor();

  await page.unroute(/\/car\/target\.glb/);
  await page.getByTestId('ask').getByRole('button', { name: 'Try again' }).click();
  await page.locator('#target-name', { hasText: 'target.glb' }).waitFor();
  await ready(page);
  assert.deepEqual(await words(page), fresh);
  assert.deepEqual(
    complaints.filter((complaint) => !complaint.includes('ERR_FAILED')),
    [],
  );
});
