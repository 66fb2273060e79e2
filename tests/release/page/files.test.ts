import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';
import type { Page } from 'playwright-core';
import type { PNG } from 'pngjs';
import { type Report, report, reportedCounts } from '../../support/command';
import { GlbMaker, glbOf, tetrahedron } from '../../support/glb';
import { columns, difference, look, modelArea, shareOfHue } from '../../support/picture';
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
  type Upload,
  type Visit,
  violetPaint,
} from '../../support/site';

/** Pairs of a target and its cage: the samples, and the folders of env CAGECAST_ASSETS that hold one. */
function pairs(): { name: string; target: string; cage: string }[] {
  const list: { name: string; target: string; cage: string }[] = JSON.parse(
    readFileSync(inRepository('examples/samples/index.json'), 'utf8'),
  );
  const samples = list.map(({ name, target, cage }) => ({
    name,
    target: inRepository('examples/samples', target),
    cage: inRepository('examples/samples', cage),
  }));
  const root = process.env.CAGECAST_ASSETS;
  const others = (root ? readdirSync(root) : []).map((name) => ({
    name,
    target: path.join(root!, name, 'target.glb'),
    cage: path.join(root!, name, 'cage.glb'),
  }));
  return [...samples, ...others.filter(({ target, cage }) => existsSync(target) && existsSync(cage))];
}

const read = (file: string): Upload => glb(path.basename(file), readFileSync(file));
const kLizard = inRepository('examples/samples/lizard');

let site: Site;
// One page for all of it: a file's result must not depend on the files before.
let visit: Visit;
before(async () => {
  site = await Site.open();
  visit = await site.visit();
});
after(() => site?.close());

/** What the table says of parts, as far as a report knows it: without the numbers after their names, in some order. */
async function shownRows(page: Page): Promise<string[]> {
  const parts = await shownParts(page);
  return parts
    .map(({ name, points, culled }) => `${name.replace(/( \d+)?(, \d+ pieces)?$/, '')}: ${points}, ${culled}`)
    .toSorted();
}

/** The same of a report: one row for each segment, and one for all of a part of which nothing is covered, or nothing even exposed. */
function reportedRows(segments: Report['segments']): string[] {
  const rows = new Map<string, Report['segments'][number]>();
  segments.forEach((segment, s) => {
    if (segment.area === 0) return;
    const key = segment.coveredArea > 0 ? String(s) : `${segment.part} ${segment.exposedArea > 0}`;
    const row = rows.get(key) ?? { ...segment, points: 0, area: 0 };
    rows.set(key, { ...row, points: row.points + segment.points, area: row.area + segment.area });
  });
  const largest = [...rows.values()].toSorted((a, b) => b.area - a.area).slice(0, 50);
  return largest.map(({ part, points, culled }) => `${part.replace(/ \d+$/, '')}: ${points}, ${culled}`).toSorted();
}

/** Goes back to what the page opens with. */
async function fresh(): Promise<Visit> {
  const { page } = visit;
  await page.getByTestId('sample-select').selectOption({ index: 0 });
  await setThreshold(page, 0.5);
  await page.getByTestId('preset').selectOption('default');
  await page.locator('input[value=compare]').check({ force: true });
  assert.equal(await settled(page), 'ready', await shownError(page));
  return visit;
}

for (const { name, target, cage } of pairs()) {
  test(`${name}: the page shows the counts and segments of the command line, with both presets`, async () => {
    const { page, complaints } = await fresh();
    await drop(page, [read(target), read(cage)]);
    for (const preset of ['default', 'paper'] as const) {
      await page.getByTestId('preset').selectOption(preset);
      assert.equal(await settled(page), 'ready', await shownError(page));
      const { counts, segments } = await report(target, cage, { preset });
      assert.deepEqual(await shownCounts(page), counts, preset);
      assert.deepEqual(await shownRows(page), reportedRows(segments), preset);
    }
    assert.deepEqual(complaints, []);
  });
}

test('a model with an overlay opens without it', async () => {
  const { page, complaints } = await fresh();
  const cage = path.join(kLizard, 'cage.glb');
  const folder = await mkdtemp(path.join(tmpdir(), 'cagecast-painted-'));
  const painted = path.join(folder, 'painted.glb');
  await promisify(execFile)(process.execPath, [
    inRepository('dist/cli.js'),
    'transfer',
    path.join(kLizard, 'target.glb'),
    '--cage',
    cage,
    '--texture',
    path.join(kLizard, 'paint-tiger.png'),
    '-o',
    painted,
  ]);
  await drop(page, [read(painted), read(cage)]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await shownCounts(page), await reportedCounts(painted, cage));
  await rm(folder, { recursive: true });
  assert.deepEqual(complaints, []);
});

test('the threshold changes the counts at once, as a new transfer would', async () => {
  const { page, complaints } = await fresh();
  const [target, cage] = [path.join(kLizard, 'target.glb'), path.join(kLizard, 'cage.glb')];
  const seen = new Set<string>();
  for (const threshold of [0, 0.25, 0.5, 0.75, 1]) {
    await setThreshold(page, threshold);
    const counts = await shownCounts(page);
    assert.deepEqual(counts, await reportedCounts(target, cage, { threshold }), `threshold ${threshold}`);
    assert.equal(await page.getByTestId('status').textContent(), 'ready');
    seen.add(JSON.stringify(counts));
  }
  assert.ok(seen.size > 1, 'the threshold makes a difference on the sample');
  assert.deepEqual(complaints, []);
});

test('a sample can be chosen again after own files, with the same result', async () => {
  const { page } = await fresh();
  const before = await shownCounts(page);
  const area = await modelArea(page);
  const picture = await look(page, area);
  await page.getByTestId('target-input').setInputFiles(glb('thing.glb', glbOf(tetrahedron(), 'thing')));
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(await page.getByTestId('sample-select').inputValue(), 'own');
  assert.notDeepEqual(await shownCounts(page), before);
  await page.getByTestId('cage-input').setInputFiles(glb('cage.glb', glbOf(tetrahedron(2), 'thing')));
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 });

  await page.getByTestId('sample-select').selectOption({ index: 0 });
  assert.equal(await settled(page), 'ready');
  assert.deepEqual(await shownCounts(page), before);
  assert.ok(difference(picture, await look(page, area)) < 0.002);
});

test('a model is drawn by the programs of the one before, if it is of the same kind', async () => {
  const { page } = await fresh();
  await page.evaluate(() => {
    const { linkProgram } = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.linkProgram = function (program) {
      document.body.dataset['linked'] = String(Number(document.body.dataset['linked'] ?? 0) + 1);
      linkProgram.call(this, program);
    };
  });
  const area = await modelArea(page);
  /** Shows a sample. @returns How many programs were linked so far, and the picture. */
  const show = async (sample: string): Promise<[linked: number, picture: PNG]> => {
    await page.getByTestId('sample-select').selectOption(sample);
    assert.equal(await settled(page), 'ready', await shownError(page));
    const picture = await look(page, area);
    return [Number(await page.evaluate(() => document.body.dataset['linked'] ?? 0)), picture];
  };
  const [linked, human] = await show('human');
  const [linkedThen, misaligned] = await show('human-misaligned');
  assert.ok(difference(human, misaligned) > 0.01, 'the paint is seen elsewhere');
  assert.equal(linkedThen, linked);
});

test('of two dropped models with neutral names the simpler one is the cage, and they can be swapped', async () => {
  const { page } = await fresh();
  const target = { ...read(path.join(kLizard, 'target.glb')), name: 'b.glb' };
  const cage = { ...read(path.join(kLizard, 'cage.glb')), name: 'a.glb' };
  const expected = await shownCounts(page);
  await drop(page, [cage, target]);
  assert.equal(await settled(page), 'ready');
  assert.deepEqual(await shownCounts(page), expected);
  await page.locator('#swap').click();
  await settled(page);
  assert.notDeepEqual(await shownCounts(page), expected);
  await page.locator('#swap').click();
  assert.equal(await settled(page), 'ready');
  assert.deepEqual(await shownCounts(page), expected);
});

test('the last of several files wins', async () => {
  const { page } = await fresh();
  const input = page.getByTestId('target-input');
  await page.getByTestId('cage-input').setInputFiles(glb('cage.glb', glbOf(tetrahedron(2), 'thing')));
  for (let i = 0; i < 3; i++) await input.setInputFiles(read(path.join(kLizard, 'target.glb')));
  await input.setInputFiles(glb('thing.glb', glbOf(tetrahedron(), 'thing')));
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 });
});

test('an own paint, PNG or JPEG, is drawn on the model', async () => {
  const { page, complaints } = await fresh();
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  assert.ok(shareOfHue(await look(page, area), 295) < 0.01);
  await page.getByTestId('texture-input').setInputFiles(violetPaint());
  assert.equal(await settled(page), 'ready', await shownError(page));
  const violet = shareOfHue(await look(page, area), 295);
  assert.ok(violet > 0.1, `${violet} of the picture is violet`);

  const jpeg = await page.evaluate(() => {
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = 16;
    const context = canvas.getContext('2d')!;
    context.fillStyle = '#00c040';
    context.fillRect(0, 0, 16, 16);
    return canvas.toDataURL('image/jpeg', 1).split(',')[1]!;
  });
  await page
    .getByTestId('texture-input')
    .setInputFiles({ name: 'green.jpg', mimeType: 'image/jpeg', buffer: Buffer.from(jpeg, 'base64') });
  assert.equal(await settled(page), 'ready', await shownError(page));
  const green = shareOfHue(await look(page, area), 140);
  assert.ok(green > 0.1, `${green} of the picture is green`);
  assert.deepEqual(complaints, []);
});

test('of a mesh with instances the first one lies in the cage, and all of them show its paint', async () => {
  const { page, complaints } = await fresh();
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const maker = new GlbMaker();
  const TRANSLATION = maker.accessor(new Float32Array([0, 0, 0, 1.8, 0, 0]), 'VEC3');
  const extensions = { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION } } };
  maker.node({ mesh: maker.mesh(tetrahedron()), name: 'thing', extensions });
  maker.json.extensionsUsed = Object.keys(extensions);
  await drop(page, [glb('things.glb', maker.finish()), glb('cage.glb', glbOf(tetrahedron(2), 'thing'))]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 });
  await page.getByTestId('texture-input').setInputFiles(violetPaint());
  assert.equal(await settled(page), 'ready', await shownError(page));
  const picture = await look(page, area);
  const [first, second] = [columns(picture, 0.3, 0.6), columns(picture, 0.8, 1)].map((part) => shareOfHue(part, 295));
  assert.ok(first! > 0.1 && second! > 0.1, `${first} of the first and ${second} of the second are violet`);
  assert.deepEqual(complaints, []);
});

test('a glTF finds its buffer among the dropped files, or asks for it', async () => {
  const { page } = await fresh();
  const whole = glbOf(tetrahedron(), 'thing');
  const jsonLength = whole.readUInt32LE(12);
  const json = JSON.parse(whole.subarray(20, 20 + jsonLength).toString());
  json.buffers[0].uri = 'thing data.bin';
  const gltf = {
    name: 'thing.gltf',
    mimeType: 'model/gltf+json',
    buffer: Buffer.from(JSON.stringify({ ...json, buffers: [{ ...json.buffers[0], uri: 'thing%20data.bin' }] })),
  };
  const bin = { name: 'thing data.bin', mimeType: 'application/octet-stream', buffer: whole.subarray(28 + jsonLength) };
  await page.getByTestId('cage-input').setInputFiles(glb('cage.glb', glbOf(tetrahedron(2), 'thing')));
  await settled(page);
  await drop(page, [gltf]);
  assert.equal(await settled(page), 'error');
  assert.match(await shownError(page), /thing\.gltf: .*thing data\.bin/);
  await drop(page, [bin, gltf]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 });
});

const formats = process.env.CAGECAST_ASSETS && path.join(process.env.CAGECAST_ASSETS, 'formats');
for (const name of formats && existsSync(formats) ? readdirSync(formats) : []) {
  test(`${name} opens, with the counts of the command line`, async () => {
    const { page, complaints } = await fresh();
    const target = path.join(formats!, name);
    const cage = path.join(kLizard, 'cage.glb');
    await page.getByTestId('target-input').setInputFiles({ ...read(target), name });
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.deepEqual(await shownCounts(page), await reportedCounts(target, cage));
    assert.deepEqual(complaints, []);
  });
}
