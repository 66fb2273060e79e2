// Half a million triangles must not block the page's main thread for 100 ms.

import assert from 'node:assert/strict';
import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { islandCage, lumpyBall } from '../../../tests/support/models';
import { Site, settled, shownCounts, shownError } from '../../../tests/support/site';
import { kMaxMs, longestTask } from './processor-time';

const kSide = 500; // 500,000 triangles

let site: Site;
let folder: string;
let target: string;
before(async () => {
  site = await Site.open();
  folder = await mkdtemp(path.join(tmpdir(), 'cagecast-large-'));
  target = path.join(folder, 'target.glb');
  await writeFile(target, (await lumpyBall(kSide)).buffer);
});
after(async () => {
  await site?.close();
  await rm(folder, { recursive: true, force: true });
});

test('while half a million triangles are transferred, no task takes 100 ms', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 800, height: 500 } });
  await page.getByTestId('cage-input').setInputFiles(await islandCage(1));
  await settled(page);
  const open = async (): Promise<void> => {
    await page.getByTestId('target-input').setInputFiles(target);
    assert.equal(await settled(page), 'ready', await shownError(page));
    // Its first picture as well.
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  };
  const longest = await longestTask(page, open, async () => {});
  const { cosmetic, occluded, uncovered, culled } = await shownCounts(page);
  assert.ok(cosmetic + occluded + uncovered + culled > 250_000);
  assert.ok(longest < kMaxMs, `the longest task takes ${longest} ms`);
  assert.deepEqual(complaints, []);
});

test('while half a million triangles are cut at exact borders, no task takes 100 ms', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 800, height: 500 } });
  await page.getByTestId('cage-input').setInputFiles(await islandCage(1));
  await settled(page);
  await page.getByTestId('target-input').setInputFiles(target);
  assert.equal(await settled(page), 'ready', await shownError(page));
  const note = page.getByTestId('borders-note');
  const noteIs = (empty: boolean): Promise<unknown> =>
    page.waitForFunction(
      (empty) => (document.querySelector('[data-testid=borders-note]')!.textContent === '') === empty,
      empty,
    );
  const cut = async (): Promise<void> => {
    await page.getByTestId('exact-borders').check();
    await noteIs(false);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  };
  const longest = await longestTask(page, cut, async () => {
    await page.getByTestId('exact-borders').uncheck();
    await noteIs(true);
  });
  assert.match((await note.textContent())!, /^Adds [\d,]+ triangles\.$/);
  assert.ok(longest < kMaxMs, `the longest task takes ${longest} ms`);
  assert.deepEqual(complaints, []);
});
