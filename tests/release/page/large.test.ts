import assert from 'node:assert/strict';
import { writeFile } from 'node:fs/promises';
import path from 'node:path';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { cancelOnceShown, kSlowWorker } from '../../support/cancel';
import { islandCage, lumpyBall } from '../../support/models';
import { openSite, ready, settled, shownCounts } from '../../support/site';
import { temporaryFolder } from '../../support/temporary';

const kSide = 150; // 45,000 triangles; bench/web/page measures with 500,000

const site = await openSite();
const { folder } = temporaryFolder('large');
const target = path.join(folder, 'target.glb');
await writeFile(target, (await lumpyBall(kSide)).buffer);

/** Notes what the bar says, from now on. */
async function watchProgress(page: Page): Promise<() => Promise<string[]>> {
  await page.evaluate(() => {
    const stages: string[] = [];
    Object.assign(globalThis, { stages });
    const bar = document.querySelector<HTMLElement>('#progress')!;
    new MutationObserver(
      () => !bar.hidden && stages.push(document.querySelector('#progress-stage')!.textContent!),
    ).observe(bar, { subtree: true, childList: true, attributes: true });
  });
  return () => page.evaluate(() => [...new Set((globalThis as unknown as { stages: string[] }).stages)]);
}

test('while a large model is transferred, progress is shown', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 800, height: 500 } }, kSlowWorker);
  await page.getByTestId('cage-input').setInputFiles(await islandCage(1));
  await settled(page);
  const stages = await watchProgress(page);
  await page.getByTestId('target-input').setInputFiles(target);
  await ready(page);
  const { cosmetic, occluded, uncovered, culled } = await shownCounts(page);
  assert.ok(cosmetic + occluded + uncovered + culled > kSide ** 2);
  assert.ok((await stages()).length >= 2, (await stages()).join());
  assert.equal(await page.getByTestId('progress').isVisible(), false);
  assert.deepEqual(complaints, []);
});

for (const way of ['button', 'Escape'] as const) {
  test(`${way} cancels long work and keeps the current model`, async () => {
    const { page, complaints } = await site.visit({ viewport: { width: 800, height: 500 } }, kSlowWorker);
    const before = await shownCounts(page);
    const givenUp = cancelOnceShown(page, way);
    await page.getByTestId('target-input').setInputFiles(target);
    await givenUp;
    assert.equal(await page.getByTestId('status').textContent(), 'ready');
    assert.equal(await page.getByTestId('progress').isVisible(), false);
    assert.deepEqual(await shownCounts(page), before);
    // It is no loss: another sample opens at once.
    await page.getByTestId('sample-select').selectOption({ index: 1 });
    await ready(page);
    assert.notDeepEqual(await shownCounts(page), before);
    assert.deepEqual(complaints, []);
  });
}
