import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { init, type Mesh, transfer } from 'cagecast';
import type { Page } from 'playwright-core';
import type { PNG } from 'pngjs';
import { Box3, Vector3 } from 'three';
import { type Deform, deform, type Extent, kDeforms } from '../../../../web/src/state/deform';
import { ball, islandCage, islandPaint } from '../../../support/models';
import { difference, frames, look, modelArea, shareOfHue, watch } from '../../../support/picture';
import { drop, Site, settled, shownCounts, shownError, type Upload } from '../../../support/site';

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

/** Moves the model as far as that, and waits until it is on show. */
async function bend(page: Page, amount: number): Promise<void> {
  await page.getByTestId('amount').fill(String(amount));
  await page.locator('#live[aria-busy=false]').waitFor();
  assert.equal(await page.locator('#amount-value').textContent(), amount.toFixed(2));
  // A browser's clock may be too coarse for a ball.
  assert.match((await page.getByTestId('frame-time').textContent())!, /^\d/);
}

/** The only mesh of a model, as arrays to transfer with. */
async function meshOf({ buffer }: Upload): Promise<Mesh & { indices: Uint32Array }> {
  const primitive = (await new NodeIO().readBinary(new Uint8Array(buffer)))
    .getRoot()
    .listMeshes()[0]!
    .listPrimitives()[0]!;
  const floats = (semantic: string): Float32Array | undefined =>
    primitive.getAttribute(semantic)?.getArray() as Float32Array | undefined;
  return {
    positions: floats('POSITION')!,
    indices: Uint32Array.from(primitive.getIndices()!.getArray()!),
    uvs: floats('TEXCOORD_0'),
  };
}

/** A mesh moved as the page moves it. */
function moved(mesh: Mesh, how: Deform, amount: number, extent: Extent): Mesh {
  const positions = mesh.positions.slice();
  const point = new Vector3();
  for (let at = 0; at < positions.length; at += 3) {
    deform(point.fromArray(positions, at), how, amount, extent);
    point.toArray(positions, at);
  }
  return { ...mesh, positions };
}

test('a deformed model has the counts of a transfer of its deformed vertices, with the cage deformed or not', async () => {
  await init();
  const { page, complaints } = await site.visit({ viewport: { width: 960, height: 500 } });
  const [targetFile, cageFile] = [{ ...(await ball()), name: 'target.glb' }, await islandCage(0.85)];
  await drop(page, [targetFile, cageFile]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.getByTestId('preset').selectOption('paper');
  assert.equal(await settled(page), 'ready', await shownError(page));
  const [target, cage] = [await meshOf(targetFile), await meshOf(cageFile)];
  const box = new Box3().setFromArray(target.positions as Float32Array);
  const extent = { center: box.getCenter(new Vector3()), half: (box.max.y - box.min.y) / 2 };
  const seen = new Set<string>();
  for (const how of kDeforms) {
    for (const along of [true, false]) {
      await page.getByTestId('deform').selectOption(how);
      await page.getByTestId('deform-cage').setChecked(along);
      await bend(page, -0.7);
      const { zones } = transfer(moved(cage, how, along ? -0.7 : 0, extent), moved(target, how, -0.7, extent), {
        preset: 'paper',
      });
      const [cosmetic, occluded, uncovered, culled] = [0, 1, 2, 3].map(
        (zone) => zones.filter((other) => other === zone).length,
      );
      assert.deepEqual(await shownCounts(page), { cosmetic, occluded, uncovered, culled }, `${how}, ${along}`);
      seen.add(JSON.stringify(await shownCounts(page)));
    }
  }
  assert.ok(seen.size > 3, 'they differ');
  assert.deepEqual(complaints, []);
});

test('a deformed model is shown with its paint, and returns to the same pixels', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 600 } });
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const before = { counts: await shownCounts(page), picture: await look(page, area) };
  for (const how of kDeforms) {
    await page.getByTestId('deform').selectOption(how);
    await bend(page, 0.8);
    const picture = await look(page, area);
    assert.ok(difference(before.picture, picture) > 0.02, `${how} is seen`);
    await page.locator('#show-paint').uncheck({ force: true });
    assert.ok(difference(picture, await look(page, area)) > 0.02, `${how} is painted`);
    await page.locator('#show-paint').check({ force: true });
  }
  // So is the cage: as it is drawn anew by a transfer.
  await page.locator('#show-cage').check({ force: true });
  const bent = await look(page, area);
  for (const preset of ['paper', 'default']) {
    await page.getByTestId('preset').selectOption(preset);
    assert.equal(await settled(page), 'ready', await shownError(page));
    await page.locator('#live[aria-busy=false]').waitFor();
  }
  assert.ok(difference(bent, await look(page, area)) < 0.001, 'the cage is shown where it is moved to');
  await page.locator('#show-cage').uncheck({ force: true });
  await bend(page, 0);
  assert.deepEqual(await shownCounts(page), before.counts);
  assert.equal(difference(before.picture, await look(page, area)), 0);
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

test('the view follows every step in compare mode and after highlighting', async () => {
  const { page } = await site.visit({ viewport: { width: 1000, height: 600 } });
  const area = await modelArea(page);
  const paint = page.locator('#show-paint');
  const bare = async (): Promise<PNG> => {
    await paint.uncheck({ force: true });
    const picture = await look(page, area);
    await paint.check({ force: true });
    return picture;
  };
  await bend(page, 0.8);
  const at = await bare();
  for (const amount of [0.2, 0.5]) {
    await bend(page, amount);
    await look(page, area);
  }
  assert.ok(difference(at, await bare()) > 0.01);
  await bend(page, 0.8);
  assert.equal(difference(at, await bare()), 0);
});

test('the deformation is relative to the size of the model', async () => {
  const { page } = await site.visit({ viewport: { width: 1000, height: 600 } });
  await page.locator('input[value=naive]').check({ force: true });
  const pictures: PNG[] = [];
  for (const size of [1, 20]) {
    await drop(page, [await islandCage(size), { ...(await ball({ size })), name: 'target.glb' }]);
    assert.equal(await settled(page), 'ready', await shownError(page));
    await page.getByTestId('deform').selectOption('twist');
    await bend(page, 0.5);
    pictures.push(await look(page, await modelArea(page)));
  }
  assert.ok(
    difference(pictures[0]!, pictures[1]!) < 0.01,
    `${difference(pictures[0]!, pictures[1]!)} of the picture differs`,
  );
});

test('Animate runs until it is switched off or another model is opened', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 960, height: 500 } });
  const amount = (): Promise<string> => page.getByTestId('amount').inputValue();
  await page.getByTestId('deform-moves').check();
  await page.waitForFunction(() => {
    const all = globalThis as unknown as { amounts?: Set<string> };
    return (
      (all.amounts ??= new Set()).add(document.querySelector<HTMLInputElement>('[data-testid=amount]')!.value).size >= 3
    );
  });
  assert.ok(Number(await page.getByTestId('frame-time').textContent()) > 0);
  await page.getByTestId('deform-moves').uncheck();
  await page.locator('#live[aria-busy=false]').waitFor();
  const last = await amount();
  await frames(page, 30);
  assert.equal(await amount(), last, 'it has stopped');
  await page.getByTestId('deform-moves').check();
  await page.getByTestId('sample-select').selectOption({ index: 1 });
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.waitForFunction(() => !document.querySelector<HTMLInputElement>('#deform-moves')!.checked);
  assert.equal(await page.getByTestId('amount').inputValue(), '0');
  assert.deepEqual(complaints, []);
});

test('an animated model plays with its paint', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 600 } });
  const paint = islandPaint();
  await drop(page, [await islandCage(1), { ...(await ball({ animated: true })), name: 'target.glb' }, paint]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const rest = await look(page, area);
  assert.ok(shareOfHue(rest, 140) > 0.05, 'it is painted green');
  assert.equal(await page.getByTestId('animation').inputValue(), '-1', 'no motion for those who want none');

  await page.getByTestId('animation').selectOption('0');
  await watch(page, area, (picture) => {
    const [green, blue] = [shareOfHue(picture, 140), shareOfHue(picture, 230)];
    assert.ok(green > 0.05 && blue < 0.02, `the paint moves with it: ${green} green, ${blue} of the model's own blue`);
    return difference(rest, picture) > 0.02;
  });
  await page.getByTestId('animation').selectOption('-1');
  assert.ok(difference(rest, await look(page, area)) < 0.002, 'it goes back to rest');
  assert.deepEqual(complaints, []);
});
