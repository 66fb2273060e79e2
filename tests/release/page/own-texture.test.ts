import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Document, Primitive } from '@gltf-transform/core';
import type { Page } from 'playwright-core';
import { ball, islandCage } from '../../support/models';
import { difference, look, modelArea } from '../../support/picture';
import { primitivesOf, saved, validModel } from '../../support/saved';
import { drop, glb, openSite, ready, shownError } from '../../support/site';

const site = await openSite(); // texels around an island

/** Saves the model with the paint in its own textures. */
async function savedInTexture(page: Page): Promise<{ document: Document; bytes: Buffer; note: string }> {
  await page.locator('#paint-into [value=texture]').check({ force: true });
  const { bytes } = await saved(page, 'export-glb');
  assert.equal(await shownError(page), '');
  return { document: await validModel(bytes), bytes, note: (await page.getByTestId('export-note').textContent())! };
}

const isOverlay = (primitive: Primitive): boolean => primitive.getMaterial()?.getName() === 'Cagecast overlay';

test('a saved model with baked paint looks like the painted model on the page', async () => {
  const { page } = await site.visit();
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const painted = await look(page, area);
  const { bytes } = await savedInTexture(page);
  await page.getByTestId('target-input').setInputFiles(glb('painted.glb', bytes));
  await ready(page);
  await page.locator('#show-paint').uncheck({ force: true });
  const again = await look(page, area);
  assert.ok(difference(painted, again) < 0.03, `${difference(painted, again)} of the picture differs`);
  await page.locator('#show-paint').check({ force: true });
  await page.getByTestId('sample-select').selectOption({ index: 0 });
  await ready(page);
  await page.locator('#show-paint').uncheck({ force: true });
  assert.ok(difference(painted, await look(page, area)) > 0.1, 'the paint is no small thing');
});

test('parts without a texture keep an overlay and are named; the choice is disabled without any texture', async () => {
  const { page } = await site.visit();
  await page.getByTestId('sample-select').selectOption('car');
  await ready(page);
  const { document, note } = await savedInTexture(page);
  assert.match(
    note,
    /^The paint is in one of the model’s own textures\. On [\w, -]*bumpers[\w, -]* it is an overlay, because there is no suitable texture\.$/,
  );
  const overlays = primitivesOf(document).filter(isOverlay);
  assert.ok(overlays.length > 0);
  const bases = document
    .getRoot()
    .listMeshes()
    .filter((mesh) => mesh.listPrimitives().some(isOverlay))
    .flatMap((mesh) => mesh.listPrimitives().filter((primitive) => !isOverlay(primitive)));
  assert.ok(bases.every((primitive) => primitive.getMaterial()?.getBaseColorTexture() === null));

  await drop(page, [await islandCage(1), { ...(await ball()), name: 'target.glb' }]);
  await ready(page);
  assert.equal(await page.locator('#paint-into [value=texture]').isDisabled(), true);
  assert.equal(await page.locator('#paint-into [value=overlay]').isChecked(), true);
  assert.equal(primitivesOf(await validModel((await saved(page, 'export-glb')).bytes)).filter(isOverlay).length, 1);
});
