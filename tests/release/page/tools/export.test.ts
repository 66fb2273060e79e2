import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';
import { NodeIO } from '@gltf-transform/core';
import { KHRDracoMeshCompression } from '@gltf-transform/extensions';
import draco3d from 'draco3dgltf';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { glbOf, tetrahedron } from '../../../support/glb';
import { ball, islandCage } from '../../../support/models';
import { difference, look, modelArea } from '../../../support/picture';
import { primitivesOf, saved, validModel } from '../../../support/saved';
import {
  drop,
  glb,
  inRepository,
  Site,
  setThreshold,
  settled,
  shownCounts,
  shownError,
  shownParts,
} from '../../../support/site';

let site: Site;
let folder: string;
before(async () => {
  site = await Site.open();
  folder = await mkdtemp(path.join(tmpdir(), 'cagecast-take-'));
});
after(async () => {
  await site?.close();
  await rm(folder, { recursive: true, force: true });
});

/** The command line that the page shows, run on the sample's own files; it writes a model and returns its path. */
async function runCommand(line: string): Promise<string> {
  const words = line
    .trim()
    .split('\n')
    .at(-1)!
    .replace('npx cagecast', '')
    .trim()
    .match(/'[^']*'|\S+/g)!
    .map((word) => word.replaceAll("'", ''));
  const files: Record<string, string> = {
    'target.glb': inRepository('examples/samples/lizard/target.glb'),
    'cage.glb': inRepository('examples/samples/lizard/cage.glb'),
    'paint.png': inRepository('examples/samples/lizard/paint-tiger.png'),
    'painted.glb': path.join(folder, 'painted.glb'),
  };
  await promisify(execFile)(process.execPath, [
    inRepository('dist/cli.js'),
    ...words.map((word) => files[word] ?? word),
  ]);
  return files['painted.glb']!;
}

test('the saved model equals that of the command line: zones, UVs and overlay, with the rules and locks of the page', async () => {
  const { page, complaints } = await site.visit();
  await page.getByTestId('preset').selectOption('paper');
  assert.equal(await settled(page), 'ready');
  await setThreshold(page, 0.3);
  await page.locator('#parts summary').click();
  const rows = page.getByTestId('segment-table').locator('tbody tr');
  const skin = (await shownParts(page)).findIndex(({ name }) => name === 'skin');
  await rows.nth(skin).locator('select').selectOption('exclude');

  const { name, bytes } = await saved(page, 'export-glb');
  assert.equal(name, 'target-painted.glb');
  const document = await validModel(bytes);

  await page.locator('#export input[value=command]').check({ force: true });
  const line = (await page.getByTestId('code').textContent())!;
  assert.match(line, /--preset paper --threshold 0.3 --exclude skin -o painted.glb$/);
  const expected = await validModel(await readFile(await runCommand(line)));
  const [found, wanted] = [primitivesOf(document), primitivesOf(expected)];
  assert.equal(found.length, wanted.length);
  found.forEach((primitive, p) => {
    const other = wanted[p]!;
    assert.deepEqual(primitive.listSemantics().toSorted(), other.listSemantics().toSorted());
    for (const semantic of primitive.listSemantics())
      assert.deepEqual(
        primitive.getAttribute(semantic)!.getArray(),
        other.getAttribute(semantic)!.getArray(),
        `${p} ${semantic}`,
      );
    assert.deepEqual([...primitive.getIndices()!.getArray()!], [...other.getIndices()!.getArray()!], `${p} indices`);
  });
  const overlay = found.find((primitive) => primitive.getMaterial()?.getName() === 'Cagecast overlay')!;
  const image = PNG.sync.read(Buffer.from(overlay.getMaterial()!.getBaseColorTexture()!.getImage()!));
  const paint = PNG.sync.read(await readFile(inRepository('examples/samples/lizard/paint-tiger.png')));
  assert.ok(difference(image, paint) < 0.001);
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

test('saving keeps skins, morphs and animations, and works for multi-file and compressed models', async () => {
  const { page, complaints } = await site.visit();
  const cage = await islandCage(1);
  await drop(page, [cage, { ...(await ball({ pose: true })), name: 'target.glb' }]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  const skinned = await validModel((await saved(page, 'export-glb')).bytes);
  const [base, overlay] = primitivesOf(skinned);
  assert.equal(skinned.getRoot().listSkins().length, 1);
  assert.equal(base!.listTargets().length, 1);
  assert.equal(overlay!.listTargets().length, 1);
  assert.ok(overlay!.getAttribute('JOINTS_0') && overlay!.getAttribute('WEIGHTS_0'));

  const whole = glbOf(tetrahedron(0.9), 'thing');
  const jsonLength = whole.readUInt32LE(12);
  const json = JSON.parse(whole.subarray(20, 20 + jsonLength).toString());
  json.buffers[0].uri = 'thing%20data.bin';
  const gltf = { name: 'target.gltf', mimeType: 'model/gltf+json', buffer: Buffer.from(JSON.stringify(json)) };
  await drop(page, [
    gltf,
    { name: 'thing data.bin', mimeType: 'application/octet-stream', buffer: whole.subarray(28 + jsonLength) },
  ]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(primitivesOf(await validModel((await saved(page, 'export-glb')).bytes)).length, 2);

  const io = new NodeIO().registerExtensions([KHRDracoMeshCompression]);
  io.registerDependencies({ 'draco3d.encoder': await draco3d.createEncoderModule() });
  const packed = await new NodeIO().readBinary(new Uint8Array((await ball()).buffer));
  packed.createExtension(KHRDracoMeshCompression).setRequired(true);
  await page.getByTestId('target-input').setInputFiles(glb('packed.glb', Buffer.from(await io.writeBinary(packed))));
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(primitivesOf(await validModel((await saved(page, 'export-glb')).bytes)).length, 2);
  assert.deepEqual(complaints, []);
});

test('the saved zones equal those of the page', async () => {
  const { page } = await site.visit();
  const { name, bytes } = await saved(page, 'export-zones');
  assert.equal(name, 'target-zones.json');
  const { counts, zones, segments, parts, options } = JSON.parse(bytes.toString());
  assert.deepEqual(counts, await shownCounts(page));
  assert.equal(zones.filter((zone: number) => zone === 0).length, counts.cosmetic);
  assert.equal(zones.length, parts.at(-1).firstVertex + parts.at(-1).vertexCount);
  assert.ok(segments.some(({ culled }: { culled: boolean }) => culled));
  assert.deepEqual(options, { preset: 'default', threshold: 0.5, locks: { segments: {} } });
});

/** Changes the part of the address that says what to show. */
function goTo(page: Page, hash: string): Promise<void> {
  return page.evaluate(async (hash) => {
    const told = new Promise((done) => addEventListener('hashchange', done, { once: true }));
    location.hash = hash;
    await told;
  }, hash);
}

test('a link restores sample, paint, rules, locks, view and camera, in this visit and in another', async () => {
  const { page } = await site.visit();
  await page.getByTestId('sample-select').selectOption({ index: 1 });
  await settled(page);
  await page.locator('.paints label').nth(1).click();
  await settled(page);
  await page.getByTestId('preset').selectOption('paper');
  await settled(page);
  await setThreshold(page, 0.35);
  await page.locator('#parts summary').click();
  await page.getByTestId('segment-table').locator('tbody tr select').last().selectOption('exclude');
  await page.locator('input[value=result]').check({ force: true });
  await page.locator('#show-cage').check({ force: true });
  const area = await modelArea(page);
  const front = await look(page, area);
  for (const key of ['ArrowLeft', 'ArrowLeft', 'ArrowLeft', 'ArrowUp', '+', '+', '+'])
    await page.locator('#view').press(key);
  const seen = {
    counts: await shownCounts(page),
    parts: await shownParts(page),
    paint: await page.locator('.paints input').nth(1).isChecked(),
    picture: await look(page, area),
  };
  assert.ok(difference(front, seen.picture) > 0.1, 'it is turned');
  await page.getByTestId('share-link').focus();
  const link = await page.getByTestId('share-link').evaluate((anchor) => (anchor as HTMLAnchorElement).href);
  assert.ok(link.startsWith(`${site.url}#`), link);

  const check = async (page: Page): Promise<void> => {
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.deepEqual(await shownCounts(page), seen.counts);
    assert.deepEqual(await shownParts(page), seen.parts);
    assert.equal(await page.locator('.paints input').nth(1).isChecked(), seen.paint);
    assert.equal(await page.getByTestId('preset').inputValue(), 'paper');
    assert.equal(await page.getByTestId('threshold').inputValue(), '0.35');
    assert.equal(await page.locator('input[value=result]').isChecked(), true);
    assert.match(new URL(link).hash, /&angle=-4,74,1\.331$/, 'three steps to the left, one up, three nearer');
    const apart = difference(seen.picture, await look(page, area));
    assert.ok(apart < 0.002, `the pictures differ in ${apart}`);
  };
  const other = await site.visit({}, undefined, new URL(link).hash);
  await check(other.page);
  assert.deepEqual(other.complaints, []);
  // In a page that shows something else.
  await other.page.getByTestId('sample-select').selectOption({ index: 0 });
  await settled(other.page);
  for (const hash of ['#', new URL(link).hash]) await goTo(other.page, hash);
  await other.page.waitForFunction(
    () => document.querySelector<HTMLSelectElement>('#sample-select')!.selectedIndex === 1,
  );
  await check(other.page);
  // In one that shows it from elsewhere: it is turned, and not opened anew.
  await other.page.locator('#view').press('Home');
  assert.ok(difference(seen.picture, await look(other.page, area)) > 0.1);
  for (const hash of ['#', new URL(link).hash]) await goTo(other.page, hash);
  await check(other.page);
});

test('an invalid link opens as much as possible', async () => {
  const { page, complaints } = await site.visit(
    {},
    undefined,
    '#sample=lizard&layer=nothing.png,7,red&rules=none&threshold=9&keep=1,x,99999&view=none&split=-3&angle=1,x,-3',
  );
  assert.equal(await page.getByTestId('status').textContent(), 'ready', await shownError(page));
  assert.equal(await page.getByTestId('threshold').inputValue(), '0.5');
  assert.equal(await page.locator('input[value=compare]').isChecked(), true);
  const unknown = await site.visit({}, undefined, '#sample=unicorn');
  assert.equal(await unknown.page.getByTestId('status').textContent(), 'ready');
  assert.deepEqual([...complaints, ...unknown.complaints], []);
});

test('a click copies the link; own files have no link, and the page says why', async () => {
  const { page } = await site.visit({ permissions: ['clipboard-read', 'clipboard-write'] });
  await page.getByTestId('share-link').click();
  await page.locator('#copy-note', { hasText: 'copied' }).waitFor();
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  assert.equal(copied, page.url());
  assert.match(copied, /#sample=lizard&/);
  await drop(page, [glb('cage.glb', glbOf(tetrahedron(2), 'thing')), glb('target.glb', glbOf(tetrahedron(), 'thing'))]);
  await settled(page);
  await page.locator('#link-hint', { hasText: 'stay on this device' }).waitFor();
  assert.equal(await page.getByTestId('share-link').getAttribute('href'), null);
});

test('the three.js code has the current options', async () => {
  const { page } = await site.visit();
  const code = page.getByTestId('code');
  await page.locator('#code', { hasText: 'applyTransfer(target.scene, cage.scene, { texture })' }).waitFor();
  await setThreshold(page, 0.8);
  await page.getByTestId('preset').selectOption('paper');
  await settled(page);
  await page.locator('#code', { hasText: "{ texture, preset: 'paper', threshold: 0.8 }" }).waitFor();
  const file = path.join(folder, 'code.mjs');
  await writeFile(file, (await code.textContent())!);
  await promisify(execFile)(process.execPath, ['--check', file]);
});
