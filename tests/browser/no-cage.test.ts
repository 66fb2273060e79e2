import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { glbOf, tetrahedron } from '../support/glb';
import { drop, glb, inRepository, Site, settled, shownCounts, shownError, type Visit } from '../support/site';

let site: Site;
let visit: Visit;
before(async () => {
  site = await Site.open();
  visit = await site.visit();
});
after(() => site?.close());

const human = (): Buffer => readFileSync(inRepository('build/assets/human/target.glb'));

/** Clicks, and waits until the cage that comes of it is shown. @returns What the page says of it. */
async function made(button: string): Promise<string> {
  const { page } = visit;
  const before = await page.locator('#cage-note').textContent();
  await page.getByTestId(button).click();
  await page.waitForFunction(
    (text) =>
      document.querySelector('#cage-note')!.textContent !== text ||
      !document.querySelector<HTMLElement>('#alert')!.hidden,
    before,
  );
  assert.equal(await settled(page), 'ready', await shownError(page));
  return (await page.locator('#cage-note').textContent())!;
}

async function verdict(): Promise<string> {
  await visit.page.waitForFunction(() => document.querySelector('#fit-verdict')!.textContent !== '');
  return (await visit.page.locator('#fit-verdict').textContent())!;
}

test('a model without a cage gets one: made for it, or a template’s; it is saved as a file that fits', async () => {
  const { page, complaints } = visit;
  assert.ok(await page.locator('#no-cage').isHidden(), 'a sample has a cage');
  await drop(page, [glb('figure.glb', human())]);
  assert.equal(await settled(page), 'ready', await shownError(page));

  assert.match(await made('make-cage'), /^A cage of \d+ triangles was made/);
  assert.equal(await page.locator('#cage-name').textContent(), 'figure-cage.glb');
  assert.notEqual(await verdict(), 'unfit');
  const counts = await shownCounts(page);
  assert.ok(counts.cosmetic > counts.uncovered && counts.uncovered > 0, JSON.stringify(counts));
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId('save-cage').click()]);
  assert.equal(download.suggestedFilename(), 'figure-cage.glb');
  const bytes = await readFile(await download.path());

  await page.locator('#template-select').selectOption('human-head');
  assert.match(await made('fit-cage'), /^The template was fitted/);
  assert.notEqual(await verdict(), 'unfit');
  assert.notDeepEqual(await shownCounts(page), counts);

  await drop(page, [glb('figure.glb', human()), glb('figure-cage.glb', bytes)]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.deepEqual(await shownCounts(page), counts, 'the saved cage is the one that was shown');
  assert.deepEqual(complaints, []);
});

test('a cage that cannot be made is an error that names the model; cancelling leaves everything as it was', async () => {
  const { page } = visit;
  const before = await page.locator('#cage-name').textContent();
  await page.getByTestId('make-cage').click();
  await page.getByTestId('cancel').click();
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(await page.locator('#cage-name').textContent(), before);

  await drop(page, [glb('pyramid.glb', glbOf(tetrahedron()))]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.locator('#template-select').selectOption('human-body');
  await page.getByTestId('fit-cage').click();
  assert.equal(await settled(page), 'error');
  assert.match(await shownError(page), /^pyramid\.glb: /);
});
