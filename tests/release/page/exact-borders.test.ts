import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';
import type { Page } from 'playwright-core';
import { cancelOnceShown, kSlowWorker } from '../../support/cancel';
import { ball, islandCage, islandPaint } from '../../support/models';
import { difference, look, modelArea, shareOfHue } from '../../support/picture';
import { primitivesOf, saved, validModel } from '../../support/saved';
import {
  drop,
  glb,
  inRepository,
  Site,
  setThreshold,
  settled,
  shownCounts,
  shownError,
  type Visit,
} from '../../support/site';

const lizard = (name: string): string => inRepository('examples/samples/lizard', name);

let site: Site;
let visit: Visit;
let folder: string;
before(async () => {
  site = await Site.open();
  folder = await mkdtemp(path.join(tmpdir(), 'cagecast-exact-'));
  visit = await site.visit();
});
after(async () => {
  await site?.close();
  await rm(folder, { recursive: true, force: true });
});

const isCut = /^Adds [\d,]+ triangles\.$/;
const note = (page: Page): Promise<string | null> => page.getByTestId('borders-note').textContent();
const chooseMode = (page: Page, value: string): Promise<void> =>
  page.locator(`input[value=${value}]`).check({ force: true });

/** Waits until the model is shown as it was cut. */
async function cut(page: Page): Promise<void> {
  await page.waitForFunction(() => /Adds/.test(document.querySelector('[data-testid=borders-note]')!.textContent!));
  assert.equal(await settled(page), 'ready', await shownError(page));
}

test('exact borders are off by default, change the view, and keep the counts', async () => {
  const { page, complaints } = visit;
  const box = page.getByTestId('exact-borders');
  assert.equal(await box.isChecked(), false);
  await page.getByTestId('preset').selectOption('paper');
  assert.equal(await settled(page), 'ready');
  await chooseMode(page, 'result');
  const area = await modelArea(page);
  const [plain, counts] = [await look(page, area), await shownCounts(page)];
  await box.check();
  await cut(page);
  assert.match((await note(page))!, isCut);
  assert.deepEqual(await shownCounts(page), counts);
  // The rim of a jagged border comes back.
  assert.ok(difference(plain, await look(page, area)) > 0.002);
  await box.uncheck();
  assert.equal(await note(page), '');
  assert.ok(difference(plain, await look(page, area)) < 0.0005, 'off again, it is as it was');
  assert.deepEqual(complaints, []);
});

/** Notes what is said of borders, from now on. */
async function watchNote(page: Page): Promise<() => Promise<string[]>> {
  await page.evaluate(() => {
    const seen: string[] = [];
    Object.assign(globalThis, { seen });
    new MutationObserver(() => seen.push(document.querySelector('[data-testid=borders-note]')!.textContent!)).observe(
      document.querySelector('[data-testid=borders-note]')!,
      { childList: true },
    );
  });
  return () => page.evaluate(() => (globalThis as unknown as { seen: string[] }).seen);
}

test('another threshold, lock or paint is shown at once, and cut again if the zones change', async () => {
  const { page, complaints } = visit;
  await page.getByTestId('exact-borders').check();
  await cut(page);
  const area = await modelArea(page);
  const before = await look(page, area);
  const seen = await watchNote(page);
  await setThreshold(page, 0.49);
  assert.deepEqual(await seen(), [], 'nothing is decided otherwise: it stays');
  await setThreshold(page, 1);
  await page.waitForFunction(() => (globalThis as unknown as { seen: string[] }).seen.length >= 2);
  assert.equal((await seen())[0], '', 'its own triangles first');
  await cut(page);
  assert.ok(difference(before, await look(page, area)) > 0.05);
  await setThreshold(page, 0.5);
  await page.waitForFunction(() => (globalThis as unknown as { seen: string[] }).seen.length >= 4);
  await cut(page);
  assert.ok(difference(before, await look(page, area)) < 0.0005);
  await page.getByTestId('texture-input').setInputFiles(islandPaint());
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.match((await note(page))!, isCut);
  assert.deepEqual(complaints, []);
});

test('the saved model equals that of the command line shown, and a link restores the switch', async () => {
  const { page } = await site.visit();
  await page.getByTestId('exact-borders').check();
  await cut(page);
  const words = {
    three: /await applyTransfer\(target\.scene, cage\.scene, \{ texture, borders: 'cut' \}\)/,
    command: / --borders cut -o painted\.glb$/,
  };
  for (const [kind, expected] of Object.entries(words)) {
    await page.locator(`#export input[value=${kind}]`).check({ force: true });
    assert.match((await page.getByTestId('code').textContent())!, expected);
  }
  const { bytes } = await saved(page, 'export-glb');
  const out = path.join(folder, 'painted.glb');
  await promisify(execFile)(process.execPath, [
    inRepository('dist/cli.js'),
    'transfer',
    lizard('target.glb'),
    '--cage',
    lizard('cage.glb'),
    '--texture',
    lizard('paint-tiger.png'),
    '--borders',
    'cut',
    '-o',
    out,
  ]);
  const [found, wanted] = [primitivesOf(await validModel(bytes)), primitivesOf(await validModel(await readFile(out)))];
  assert.equal(found.length, wanted.length);
  found.forEach((primitive, p) => {
    for (const semantic of primitive.listSemantics())
      assert.deepEqual(
        primitive.getAttribute(semantic)!.getArray(),
        wanted[p]!.getAttribute(semantic)!.getArray(),
        `${p} ${semantic}`,
      );
    assert.deepEqual([...primitive.getIndices()!.getArray()!], [...wanted[p]!.getIndices()!.getArray()!]);
  });
  const link = new URL((await page.getByTestId('share-link').getAttribute('href'))!, page.url());
  assert.match(link.hash, /borders=cut/);
  const again = await site.visit({}, undefined, link.hash);
  assert.equal(await again.page.getByTestId('exact-borders').isChecked(), true);
  await cut(again.page);
  assert.deepEqual(again.complaints, []);
});

test('cancelling switches exact borders off and keeps the view', async () => {
  const { page, complaints } = await site.visit({}, kSlowWorker);
  await chooseMode(page, 'result');
  const area = await modelArea(page);
  const before = await look(page, area);
  const givenUp = cancelOnceShown(page, 'Escape');
  await page.getByTestId('exact-borders').check();
  await givenUp;
  assert.equal(await page.getByTestId('status').textContent(), 'ready');
  assert.equal(await page.getByTestId('exact-borders').isChecked(), false);
  await page.waitForTimeout(2000);
  assert.deepEqual([await page.getByTestId('status').textContent(), await note(page)], ['ready', '']);
  assert.ok(difference(before, await look(page, area)) < 0.0005);
  assert.deepEqual(complaints, []);
});

test('a change during cutting replaces the cut, once', async () => {
  const { page, complaints } = await site.visit({}, kSlowWorker);
  const seen = await watchNote(page);
  // Within the page: from outside it may come when all is done.
  const statuses = page.evaluate(
    () =>
      new Promise<string[]>((done) => {
        const [status, threshold] = ['status', 'threshold'].map(
          (id) => document.querySelector<HTMLInputElement>(`[data-testid=${id}]`)!,
        );
        const said: string[] = [];
        new MutationObserver(() => {
          said.push(status!.textContent!);
          if (said.length === 1) {
            threshold!.value = '1';
            threshold!.dispatchEvent(new Event('input', { bubbles: true }));
          } else if (said.filter((text) => text === 'ready').length === 2) done(said);
        }).observe(status!, { childList: true });
      }),
  );
  await page.getByTestId('exact-borders').check();
  assert.deepEqual(await statuses, ['working', 'ready', 'working', 'ready']);
  await page.waitForTimeout(1500);
  assert.equal((await seen()).filter((text) => text !== '').length, 1);
  assert.match((await note(page))!, isCut);
  assert.deepEqual(complaints, []);
});

for (const [name, options] of Object.entries({ mirrored: { mirrored: true }, 'skinned and morphed': { pose: true } })) {
  test(`a cut model is painted like a whole one: ${name}`, async () => {
    const { page, complaints } = await site.visit();
    await drop(page, [await ball(options), await islandCage(1), islandPaint()]);
    assert.equal(await settled(page), 'ready', await shownError(page));
    await chooseMode(page, 'result');
    const area = await modelArea(page);
    const hues = async (): Promise<number[]> => {
      const picture = await look(page, area);
      return [295, 237, 140].map((hue) => shareOfHue(picture, hue));
    };
    const [, , whole] = await hues();
    await page.getByTestId('exact-borders').check();
    await cut(page);
    const [violet, blue, green] = (await hues()) as [number, number, number];
    assert.ok(violet < 0.0005, `${violet} of the picture is smeared`);
    assert.ok(blue < 0.001, `${blue} of the picture shows through`);
    assert.ok(Math.abs(green - whole!) < 0.01, `${green} of the picture is painted, ${whole} before`);
    assert.deepEqual(complaints, []);
  });
}

test('what is marked to stay bare is bare with exact borders too', async () => {
  const { page, complaints } = await site.visit();
  const file = (name: string) =>
    glb(`scan-${name}.glb`, readFileSync(inRepository('examples/samples/human-fused', `${name}.glb`)));
  await drop(page, [file('target'), file('cage')]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  await chooseMode(page, 'result');
  await page.getByTestId('exact-borders').check();
  await cut(page);
  const area = await modelArea(page);
  const before = await look(page, area);
  await page.getByTestId('make-options').locator('summary').click();
  await page.getByTestId('bare-brush').click();
  await page.getByTestId('bare-size').fill('90');
  const [x, y] = [area.x + area.width / 2, area.y + area.height / 2];
  await page.mouse.move(x - 25, y - 20);
  await page.mouse.down();
  await page.mouse.move(x + 25, y - 20, { steps: 2 });
  await page.mouse.up();
  await page.locator('#bare-count', { hasText: 'stay bare' }).waitFor();
  await page.locator('#tools input[data-key=t]').check({ force: true }); // without the tool, its marks are not drawn
  await cut(page);
  const marked = await look(page, area);
  assert.ok(difference(before, marked) > 0.01, `${difference(before, marked)} of the picture has changed`);
  await page.getByTestId('undo').click();
  await cut(page);
  assert.ok(difference(before, await look(page, area)) < 0.0005, 'undone, it is as it was');
  assert.deepEqual(complaints, []);
});
