import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import path from 'node:path';
import { test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import type { Page } from 'playwright-core';
import { inRepository, openSite, ready, shownCounts } from '../../support/site';
import { temporaryFolder } from '../../support/temporary';

const site = await openSite();
const { folder } = temporaryFolder('keyboard');

/** Goes on with the Tab key until an element has the keyboard. */
async function tabTo(page: Page, id: string): Promise<void> {
  for (let i = 0; i < 120; i++) {
    await page.keyboard.press('Tab');
    if (await page.evaluate((id) => document.activeElement?.id === id, id)) return;
  }
  assert.fail(`the Tab key does not reach #${id}`);
}

const focused = (page: Page): Promise<string> => page.evaluate(() => document.activeElement!.id);

/** Chooses a file by the field that has the keyboard. */
async function chooseFile(page: Page, file: string): Promise<void> {
  const chooser = page.waitForEvent('filechooser');
  await page.keyboard.press('Space');
  await (await chooser).setFiles(file);
}

test('keyboard only: load files, change the rules, and save the model', async () => {
  const { page, complaints } = await site.visit();
  // Choosers are caught as long as somebody listens. Who begins to listen just before a key is pressed may be too late.
  page.on('filechooser', () => {});
  const sample = await shownCounts(page);
  await tabTo(page, 'target-input');
  await chooseFile(page, inRepository('examples/samples/human/target.glb'));
  await ready(page);
  await tabTo(page, 'cage-input');
  await chooseFile(page, inRepository('examples/samples/human/cage.glb'));
  await ready(page);
  const loaded = await shownCounts(page);
  assert.notDeepEqual(loaded, sample);

  await tabTo(page, 'preset');
  await page.keyboard.press('p'); // for “Paper”
  assert.equal(await page.getByTestId('preset').inputValue(), 'paper');
  await ready(page);
  assert.notDeepEqual(await shownCounts(page), loaded);
  await tabTo(page, 'threshold');
  await page.keyboard.press('End');
  assert.equal(await page.getByTestId('threshold').inputValue(), '1');
  const counts = await shownCounts(page);

  await tabTo(page, 'export-glb');
  const coming = page.waitForEvent('download');
  await page.keyboard.press('Enter');
  const file = path.join(folder, 'painted.glb');
  await (await coming).saveAs(file);
  const document = await new NodeIO().readBinary(new Uint8Array(await readFile(file)));
  const zones = document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives())
    .flatMap((primitive) => [...(primitive.getAttribute('_NCZ')?.getArray() ?? [])]);
  // Seams add copies of vertices, in the preset `paper` they do not.
  assert.equal(zones.filter((zone) => zone === 0).length, counts.cosmetic);
  assert.equal(zones.length, counts.cosmetic + counts.occluded + counts.uncovered + counts.culled);
  await page.locator('#export-glb:not([aria-busy])').waitFor();
  assert.equal(await focused(page), 'export-glb', 'the keyboard stays where it was');
  assert.deepEqual(complaints, []);
});
