import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { init, type Mesh, transfer } from 'cagecast';
import type { Page } from 'playwright-core';
import { Box3, Vector3 } from 'three';
import { deform } from '../../../../web/src/state/deform';
import { islandCage, islandPaint, morphingBalls } from '../../../support/models';
import { difference, frames, look, modelArea, shareOfHue, watch } from '../../../support/picture';
import { primitivesOf, saved, validModel } from '../../../support/saved';
import { drop, Site, settled, shownCounts, shownError, type Upload } from '../../../support/site';

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

const slider = (page: Page, name: string) => page.getByTestId('morphs').getByLabel(name);

/** Waits until what was moved is on show. */
async function moved(page: Page): Promise<void> {
  await page.locator('#live[aria-busy=false]').waitFor();
  assert.equal(await shownError(page), '');
}

async function morph(page: Page, name: string, weight: number): Promise<void> {
  await slider(page, name).fill(String(weight));
  await moved(page);
}

async function open(page: Page, uploads: Upload[]): Promise<void> {
  await drop(page, uploads);
  assert.equal(await settled(page), 'ready', await shownError(page));
}

/** The balls, morphed as far as that, as arrays to transfer with. */
async function morphed({ buffer }: Upload, weights: readonly number[], bend = 0): Promise<Mesh> {
  const document = await new NodeIO().readBinary(new Uint8Array(buffer));
  const [positions, indices, groups] = [[] as number[], [] as number[], [] as number[]];
  document
    .getRoot()
    .listNodes()
    .forEach((node, n) => {
      const [primitive] = node.getMesh()!.listPrimitives();
      const first = positions.length / 3;
      const local = primitive!.getAttribute('POSITION')!.getArray()!;
      const translation = node.getTranslation();
      for (let at = 0; at < local.length; at++) {
        let change = 0;
        primitive!
          .listTargets()
          .forEach((target, t) => (change += weights[t]! * target.getAttribute('POSITION')!.getArray()![at]!));
        positions.push(Math.fround(Math.fround(local[at]! + translation[at % 3]!) + change));
        if (at % 3 === 0) groups.push(n);
      }
      for (const vertex of primitive!.getIndices()!.getArray()!) indices.push(first + vertex);
    });
  const moved = Float32Array.from(positions);
  if (bend !== 0) {
    const box = new Box3().setFromArray(
      (
        await morphed(
          { buffer } as Upload,
          weights.map(() => 0),
        )
      ).positions as Float32Array,
    );
    const extent = { center: box.getCenter(new Vector3()), half: (box.max.y - box.min.y) / 2 };
    const point = new Vector3();
    for (let at = 0; at < moved.length; at += 3) {
      deform(point.fromArray(moved, at), 'bend', bend, extent);
      point.toArray(moved, at);
    }
  }
  return { positions: moved, indices: Uint32Array.from(indices), groups: Uint32Array.from(groups) };
}

async function cageMesh({ buffer }: Upload): Promise<Mesh> {
  const [primitive] = primitivesOf(await new NodeIO().readBinary(new Uint8Array(buffer)));
  const floats = (semantic: string): Float32Array => primitive!.getAttribute(semantic)!.getArray() as Float32Array;
  return {
    positions: floats('POSITION'),
    indices: Uint32Array.from(primitive!.getIndices()!.getArray()!),
    uvs: floats('TEXCOORD_0'),
  };
}

test('a morphed model has the counts of a transfer of its morphed vertices; meshes with the same morph move together', async () => {
  await init();
  const { page, complaints } = await site.visit({ viewport: { width: 960, height: 500 } });
  const [target, cage] = [await morphingBalls(), await islandCage(0.8)];
  await open(page, [target, cage]);
  await page.getByTestId('preset').selectOption('paper');
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.getByTestId('deform-cage').setChecked(false);
  const seen = new Set<string>();
  for (const [grow, lower, bend] of [
    [0, 0, 0],
    [0.8, 0, 0],
    [0.8, 1, 0],
    [0.3, 1, 0.6],
    [0, 0.5, -0.4],
    [0, 0, 0],
  ] as const) {
    await morph(page, 'grow', grow);
    await morph(page, 'drop', lower);
    await page.getByTestId('amount').fill(String(bend));
    await moved(page);
    const { zones } = transfer(await cageMesh(cage), await morphed(target, [grow, lower], bend), { preset: 'paper' });
    const [cosmetic, occluded, uncovered, culled] = [0, 1, 2, 3].map(
      (zone) => zones.filter((other) => other === zone).length,
    );
    assert.deepEqual(await shownCounts(page), { cosmetic, occluded, uncovered, culled }, `${grow}, ${lower}, ${bend}`);
    seen.add(JSON.stringify(await shownCounts(page)));
  }
  assert.ok(seen.size >= 4, `they differ: ${[...seen].join(' ')}`);
  assert.deepEqual(complaints, []);
});

test('a morphed model is shown with its paint, and returns to the same pixels', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 600 } });
  await open(page, [await islandCage(1.1), await morphingBalls(), islandPaint()]);
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const rest = await look(page, area);
  for (const name of ['grow', 'drop']) {
    await morph(page, name, 0.8);
    const picture = await look(page, area);
    assert.ok(difference(rest, picture) > 0.02, `${name} is seen`);
    const [green, blue] = [shareOfHue(picture, 140), shareOfHue(picture, 230)];
    assert.ok(green > 0.05 && blue < 0.02, `the paint goes along: ${green} green, ${blue} of the model's own blue`);
  }
  await page.locator('#morphs-reset').click();
  await moved(page);
  assert.deepEqual([await slider(page, 'grow').inputValue(), await slider(page, 'drop').inputValue()], ['0', '0']);
  assert.ok(
    await slider(page, 'grow').evaluate((one) => one === document.activeElement),
    'the keyboard stays with the morphs',
  );
  assert.equal(difference(rest, await look(page, area)), 0);
  assert.deepEqual(complaints, []);
});

test('every morph has a slider, even without a name', async () => {
  const { page } = await site.visit();
  assert.equal(await page.getByTestId('morphs').isVisible(), false);
  await open(page, [await islandCage(1), await morphingBalls({ names: [], count: 20 })]);
  assert.equal(await page.getByTestId('morphs').isVisible(), true);
  assert.deepEqual(
    await page.locator('#morph-list span').allTextContents(),
    Array.from({ length: 20 }, (_, n) => `Morph ${n + 1}`),
  );
  await page.getByTestId('sample-select').selectOption('lizard');
  assert.equal(await settled(page), 'ready');
  assert.equal(await page.getByTestId('morphs').isVisible(), false);
});

test('morphs and an animation of the same morphs exclude each other', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 600 } });
  await open(page, [await islandCage(1.1), await morphingBalls({ animated: true }), islandPaint()]);
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const rest = await look(page, area);
  await morph(page, 'drop', 1);
  await page.getByTestId('animation').selectOption('0');
  await moved(page);
  assert.equal(await slider(page, 'drop').inputValue(), '0', 'the animation has the word');
  await watch(page, area, (picture) => difference(rest, picture) > 0.02);
  await morph(page, 'grow', 0.5);
  assert.equal(await page.getByTestId('animation').inputValue(), '-1', 'it has ended');
  const still = await look(page, area);
  await frames(page, 10);
  assert.equal(difference(still, await look(page, area)), 0);
  await page.locator('#morphs-reset').click();
  await moved(page);
  assert.equal(difference(rest, await look(page, area)), 0);
  assert.deepEqual(complaints, []);
});

test('a deformed model is saved undeformed, and the page says so', async () => {
  const { page } = await site.visit();
  const target = await morphingBalls();
  await open(page, [target, await islandCage(0.8)]);
  assert.equal(await page.getByTestId('pose-note').isVisible(), false);
  const atRest = await saved(page, 'export-glb');
  await morph(page, 'grow', 0.9);
  await page.getByTestId('pose-note').waitFor();
  assert.deepEqual((await saved(page, 'export-glb')).bytes, atRest.bytes);
  assert.deepEqual((await validModel(atRest.bytes)).getRoot().listMeshes()[0]!.getWeights(), [0, 0]);
  await morph(page, 'grow', 0);
  await page.getByTestId('pose-note').waitFor({ state: 'hidden' });
});

test('a morphed model stays morphed when its cage is replaced', async () => {
  await init();
  const { page } = await site.visit();
  const [target, wide] = [await morphingBalls(), await islandCage(0.95)];
  await open(page, [target, await islandCage(0.8)]);
  await page.getByTestId('preset').selectOption('paper');
  assert.equal(await settled(page), 'ready', await shownError(page));
  await morph(page, 'grow', 0.7);
  await page.getByTestId('cage-input').setInputFiles({ ...wide, name: 'wide.glb' });
  assert.equal(await settled(page), 'ready', await shownError(page));
  await moved(page);
  const count = async (grow: number): Promise<number> =>
    transfer(await cageMesh(wide), await morphed(target, [grow, 0]), { preset: 'paper' }).zones.filter(
      (zone) => zone === 0,
    ).length;
  assert.equal((await shownCounts(page)).cosmetic, await count(0.7));
  await page.locator('#morphs-reset').click();
  await moved(page);
  assert.equal((await shownCounts(page)).cosmetic, await count(0));
});

test('a link restores the deformation of a sample, and omits the rest shape', async () => {
  const [target, cage] = [await morphingBalls(), await islandCage(1.1)];
  // The samples that come with the page have no morphs: this one takes the place of the first.
  const samples = async (page: Page): Promise<void> => {
    for (const { name, buffer } of [target, cage])
      await page.route(`**/samples/lizard/${name}`, (route) => route.fulfill({ body: buffer }));
  };
  const options = { viewport: { width: 960, height: 500 } };
  const linkOf = async (page: Page): Promise<string> => {
    await page.getByTestId('share-link').focus();
    return page.getByTestId('share-link').evaluate((anchor) => (anchor as HTMLAnchorElement).hash);
  };
  const { page } = await site.visit(options, samples);
  assert.doesNotMatch(await linkOf(page), /deform|morph/);
  await page.getByTestId('deform').selectOption('twist');
  await page.getByTestId('deform-cage').setChecked(false);
  await page.getByTestId('amount').fill('-0.4');
  await morph(page, 'grow', 0.625);
  const area = await modelArea(page);
  const seen = { counts: await shownCounts(page), picture: await look(page, area) };
  const link = await linkOf(page);
  assert.match(link, /&deform=twist,-0.4,alone&morph=0.625,grow(&|$)/);

  const other = await site.visit(options, samples, link);
  await moved(other.page);
  assert.deepEqual(await shownCounts(other.page), seen.counts);
  assert.equal(await slider(other.page, 'grow').inputValue(), '0.625');
  assert.equal(await linkOf(other.page), link);
  assert.ok(difference(seen.picture, await look(other.page, await modelArea(other.page))) < 0.002);
  assert.deepEqual(other.complaints, []);
});
