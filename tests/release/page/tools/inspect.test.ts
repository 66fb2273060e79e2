// Inspect, for those who study the method: ways to transfer side by side, with what is wrong of each, and tables of them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { faults } from '../../../support/axe';
import { asset } from '../../../support/cages';
import { columns, difference, look, modelArea } from '../../../support/picture';
import { saved } from '../../../support/saved';
import { drop, glb, kPlay, openSite, ready } from '../../../support/site';

const site = await openSite();
const kDesk = { viewport: { width: 1440, height: 900 } };

/** The cells of a method, once labels are known or not. */
async function row(page: Page, method: string, isLabelled = true): Promise<string[]> {
  const row = page.locator(`#method-rows [data-method=${method}]`);
  await row.filter(isLabelled ? { hasNotText: '–' } : { hasText: '–' }).waitFor();
  return row.locator('td').allTextContents();
}

test('it loads when it is opened; its columns stand beside the view, and go with it', async () => {
  const { page, complaints } = await site.visit(kDesk, kPlay);
  const scripts = () =>
    page.evaluate(() =>
      performance
        .getEntriesByType('resource')
        .map(({ name }) => name)
        .filter((name) => name.endsWith('.js')),
    );
  const before = await scripts();
  await page.getByTestId('face').click();
  await page.getByTestId('half-left').waitFor();
  assert.ok((await scripts()).length > before.length, 'its scripts come now');
  const box = async (id: string) => (await page.locator(`#${id}`).boundingBox())!;
  const [parts, stage, panel, film] = [
    await box('parts'),
    await box('stage'),
    await box('controls'),
    await box('method'),
  ];
  assert.ok(parts.x === 0 && parts.x + parts.width <= stage.x && stage.x + stage.width <= panel.x);
  assert.ok(film.y >= stage.y + stage.height && film.y + film.height <= 900);
  for (const { width } of await page
    .locator('#steps canvas')
    .evaluateAll((all) => all.map((one) => one.getBoundingClientRect())))
    assert.ok(width > 110 && width <= 120, `${width} pixels a step`);
  assert.deepEqual(await faults(page), []);
  await page.getByTestId('face').click();
  assert.ok(await page.locator('#parts').isHidden());
  assert.deepEqual(complaints, []);
});

test('each half shows a way to transfer, and a link keeps them', async () => {
  const { page, complaints } = await site.visit({ ...kDesk, deviceScaleFactor: 0.5 }, undefined, '#sample=lizard');
  await row(page, 'default');
  const area = await modelArea(page);
  const before = await look(page, area);
  await page.getByTestId('half-left').selectOption('occlusion');
  const rays = await look(page, area);
  assert.ok(difference(columns(before, 0, 0.45), columns(rays, 0, 0.45)) > 0.005, 'the left half is another one');
  assert.ok(difference(columns(before, 0.55, 1), columns(rays, 0.55, 1)) < 0.002, 'the right half is the same');
  await page.getByTestId('half-right').selectOption('paper');
  const paper = await look(page, area);
  assert.ok(difference(columns(rays, 0.55, 1), columns(paper, 0.55, 1)) > 0.002);
  await page.getByTestId('half-right').selectOption('default');
  assert.ok(difference(rays, await look(page, area)) < 0.002, 'the default rules are what is set');
  await page.locator('#share-link[href*="left=occlusion&right=default"]').waitFor({ state: 'attached' });
  assert.deepEqual(complaints, []);
});

test('labels say what is wrong of each method, in a table to save; a model of one’s own gets them from a file', async () => {
  const { page, complaints } = await site.visit({}, undefined, '#sample=lizard');
  // As bench/results/quality.md has it.
  assert.deepEqual(await row(page, 'naive'), ['4,141', '1,722', '100.0 %', '0.0 %']);
  assert.deepEqual((await row(page, 'occlusion'))[2], '23.9 %');
  assert.deepEqual((await row(page, 'paper'))[2], '0.7 %');
  const { name, bytes } = await saved(page, 'methods-csv');
  assert.equal(name, 'target.glb-methods.csv');
  assert.match(bytes.toString(), /^method,painted,wrong,wrongArea,bareArea\r\nnaive,4141,1722,1,0\r\n/);
  const parts = await saved(page, 'parts-csv');
  assert.match(parts.bytes.toString(), /^part,segment,area,.*\r\nskin,0,/);

  await drop(page, [glb('head.glb', asset('lizard', 'target.glb')), glb('cage.glb', asset('lizard', 'cage.glb'))]);
  await ready(page);
  assert.deepEqual((await row(page, 'naive', false)).slice(1), ['–', '–', '–']);
  const labels = (text: string) => ({ name: 'labels.json', mimeType: 'application/json', buffer: Buffer.from(text) });
  await page.getByTestId('labels-input').setInputFiles(labels('{"ncz": "01"}'));
  await page
    .getByTestId('error')
    .filter({ hasText: /^labels\.json: ncz: it has 2 values/ })
    .waitFor();
  await page.getByTestId('labels-input').setInputFiles(labels('{"ncz": ["*eye"]}'));
  assert.deepEqual((await row(page, 'naive')).slice(1, 3), ['254', '100.0 %']);
  assert.deepEqual(complaints, []);
});

test('on a phone one half is seen, and a switch shows the other', async () => {
  const phone = { viewport: { width: 390, height: 844 }, hasTouch: true };
  const { page, complaints } = await site.visit(phone, undefined, '#sample=lizard&view=compare');
  const [left, right] = [page.getByTestId('half-left'), page.getByTestId('half-right')];
  await right.waitFor();
  assert.ok((await left.isHidden()) && (await page.locator('#divider').isHidden()));
  const area = await modelArea(page);
  const before = await look(page, area);
  await page.getByTestId('other-half').click();
  await left.waitFor();
  assert.ok(await right.isHidden());
  assert.ok(difference(before, await look(page, area)) > 0.01, 'the naive transfer');
  assert.deepEqual(await faults(page), []);
  await page.setViewportSize({ width: 1000, height: 700 });
  await page.locator('#divider').waitFor();
  assert.equal(await page.locator('#divider').getAttribute('aria-valuenow'), '50');
  assert.deepEqual(complaints, []);
});
