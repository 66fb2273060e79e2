import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { saved } from '../../../support/saved';
import { openSite, passed, ready, shownError } from '../../../support/site';

const site = await openSite();

const kWorker = /\/export-worker-[^/]*\.js$/;
/** Lives, as it says by its lock, and never answers. */
const kSilent = 'onmessage = ({ data }) => void navigator.locks.request(data.lock, () => new Promise(() => {}))';
/** Lets a test end workers as a browser does that has no memory left: without a word. */
const kWorkers = `const Before = Worker;
window.workers = [];
Worker = class extends Before {
  constructor(...all) {
    super(...all);
    if (String(all[0]).includes('export-worker')) window.workers.push(this);
  }
}`;

/** Bakes, by a worker of the test. */
async function begin(page: Page): Promise<void> {
  await page.locator('#paint-into [value=texture]').check({ force: true });
  await page.getByTestId('export-glb').click();
}

const isBusy = (page: Page): Promise<string | null> => page.getByTestId('export-glb').getAttribute('aria-busy');

test('a bake whose worker fails, ends without a word, or never answers leaves a word, and no button that is busy', async () => {
  const { page } = await site.visit({ viewport: { width: 700, height: 600 } }, kWorkers);
  const says = async (pattern: RegExp): Promise<void> => {
    await page.locator('#error', { hasText: pattern }).waitFor();
    assert.match(await shownError(page), /Save it with the paint as an overlay, or by “cagecast bake”/);
    await ready(page);
    assert.equal(await isBusy(page), null);
    await page.locator('#alert-close').click();
  };
  await page.route(kWorker, (route) => route.abort());
  await begin(page);
  await says(/^target\.glb: a worker could not be started/);

  await page.unroute(kWorker);
  await page.route(kWorker, (route) => route.fulfill({ contentType: 'text/javascript', body: kSilent }));
  await begin(page);
  while ((await page.evaluate('window.workers.length')) !== 2) await passed(page, 100);
  await page.getByTestId('progress').waitFor();
  await passed(page, 4000); // it was seen to live
  await page.evaluate('window.workers.at(-1).terminate()');
  await says(/^target\.glb: the browser has ended a worker, likely for lack of memory/);

  for (const cancel of [
    () => page.keyboard.press('Escape'),
    () => page.getByTestId('progress').getByRole('button').click(),
  ]) {
    await begin(page);
    await page.getByTestId('progress').filter({ hasText: 'Saving the model' }).waitFor();
    assert.equal(await isBusy(page), 'true');
    await cancel();
    await page.getByTestId('export-note').filter({ hasText: 'The model was not saved.' }).waitFor();
    assert.equal(await isBusy(page), null);
    await ready(page);
  }
  // Nor does another model that comes meanwhile.
  await begin(page);
  await page.getByTestId('sample-select').selectOption('human');
  await page.locator('#export-glb:not([aria-busy])').waitFor();
  await ready(page);

  await page.unroute(kWorker);
  assert.ok((await saved(page, 'export-glb')).bytes.length > 1000);
  assert.equal(await shownError(page), '');
});
