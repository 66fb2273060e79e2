// Play, what a first visitor gets: a model that is dropped is painted, said in words, changed by a tap, explained, and shared.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { faults } from '../../support/axe';
import { head, middleOf } from '../../support/cages';
import { difference, look, modelArea, watch } from '../../support/picture';
import { saved, validModel } from '../../support/saved';
import { drop, glb, kPlay, openSite, ready } from '../../support/site';

const site = await openSite();

const kDesk = { viewport: { width: 1440, height: 900 } };
const kPhone = { viewport: { width: 390, height: 844 }, hasTouch: true };
const mode = (page: Page): Promise<string> => page.locator('#view-mode input:checked').inputValue();
const face = (page: Page): Promise<string | undefined> => page.evaluate(() => document.documentElement.dataset.face);

test('a model that is dropped is painted all over, and the page says what stays bare; a tap says why, and changes it', async () => {
  const { page, complaints } = await site.visit(kDesk, kPlay);
  assert.equal(await mode(page), 'compare', 'the sample shows what the page is about');
  await drop(page, [head()]);
  await ready(page);
  await page.locator('#stage-verdict[data-verdict=good], #stage-verdict[data-verdict=usable]').waitFor();
  assert.equal(await mode(page), 'result');
  assert.match(
    (await page.locator('#stage-verdict-text').textContent())!,
    /^(Painted.* eyes.* bare|Looks off\? \d+ spots?)$/,
  );
  for (const hidden of ['#zones', '#fit', '#view-mode label:has([value=zones])', '#make-cage', '#code'])
    assert.ok(!(await page.locator(hidden).isVisible()), hidden);

  const area = await modelArea(page);
  const before = await look(page, area);
  const { x, y } = await middleOf(page);
  await page.mouse.click(x, y);
  const menu = page.getByTestId('part-menu');
  await menu.waitFor();
  await page
    .getByTestId('part-menu-text')
    .filter({ hasText: /^(Painted|Not painted): .+\.$/ })
    .waitFor();
  assert.deepEqual(await faults(page), []);
  await menu.getByRole('radio', { name: 'Keep bare' }).check({ force: true });
  await page
    .getByTestId('part-menu-text')
    .filter({ hasText: /^Not painted: you chose to keep .* bare/ })
    .waitFor();
  await page.keyboard.press('Escape');
  assert.ok(difference(before, await look(page, area)) > 0.02, 'the part is bare');
  await page.getByTestId('undo').click();
  assert.ok(difference(before, await look(page, area)) < 0.01, 'and painted again');
  assert.deepEqual(complaints, []);
});

test('Inspect has everything, is remembered, and comes by itself with what belongs to it', async () => {
  const { page } = await site.visit(kDesk, kPlay);
  assert.equal(await face(page), 'play');
  await page.getByTestId('face').click();
  assert.equal(await page.evaluate(() => localStorage.getItem('cagecast-face')), 'inspect');
  await page.locator('#zones').waitFor();
  await page.getByRole('radio', { name: 'Zones' }).check({ force: true });
  await page.getByTestId('face').click();
  assert.deepEqual([await face(page), await mode(page)], ['play', 'result'], 'Play has no view of zones');
  assert.equal(await page.evaluate(() => localStorage.getItem('cagecast-face')), 'play');

  const { page: linked } = await site.visit(kDesk, kPlay, '#sample=human&view=zones');
  assert.deepEqual([await face(linked), await mode(linked)], ['inspect', 'zones']);
});

for (const { name, size } of [
  { name: 'desktop', size: kDesk },
  { name: 'phone', size: kPhone },
])
  test(`${name}: the verdict opens a short list in place; a line turns the model to its place and marks it, and what helps is beside it`, async () => {
    const { page, complaints } = await site.visit(size, kPlay, '#sample=lizard&view=result');
    const verdict = page.locator('#stage-verdict[data-verdict=good], #stage-verdict[data-verdict=usable]');
    await verdict.waitFor();
    const area = await modelArea(page);
    const before = await look(page, area);
    await page.locator('#stage-verdict-text').click();
    const list = page.getByTestId('spots');
    await list.waitFor();
    assert.equal(await face(page), 'play');
    assert.ok(!/cage|%/i.test((await list.textContent())!));
    const { width, y, height } = (await list.boundingBox())!;
    const screen = page.viewportSize()!;
    assert.ok(width <= screen.width && y >= 0 && y + height <= screen.height && height < 0.6 * screen.height);
    assert.deepEqual(await faults(page), []);
    const eyes = list.getByRole('listitem').filter({ hasText: 'eyes' });
    await eyes.getByRole('button', { name: /^eyes/ }).click();
    await page.keyboard.press('Escape');
    await list.waitFor({ state: 'hidden' });
    const turned = await look(page, area);
    assert.ok(difference(before, turned) > 0.05, 'the eyes are looked at');
    await page.locator('#stage-verdict-text').press('Enter');
    await eyes.getByRole('button', { name: /^eyes/ }).focus();
    assert.ok(difference(turned, await look(page, area)) > 0.001, 'and marked');
    await eyes.getByRole('button', { name: 'Paint anyway' }).click();
    await list.waitFor({ state: 'hidden' });
    assert.ok(difference(turned, await look(page, area)) > 0.001, 'and painted');
    assert.deepEqual(complaints, []);
  });

test('on a desktop all is at hand: tools in a dock below the model, paints by kind beside it, and a menu behind its name', async () => {
  const { page, complaints } = await site.visit(kDesk, kPlay, '#sample=human&view=result');
  const boxOf = async (selector: string) => (await page.locator(selector).boundingBox())!;
  const [stage, dock] = [await boxOf('#stage'), await boxOf('.dock')];
  assert.equal(dock.height, 64);
  assert.ok(Math.abs(dock.x + dock.width / 2 - stage.width / 2) < 1, 'the dock is in the middle');
  const { top, bottom } = await page.evaluate(() => {
    const { style } = document.getElementById('stage')!;
    return { top: style.getPropertyValue('--stage-top'), bottom: style.getPropertyValue('--stage-bottom') };
  });
  assert.ok(parseFloat(bottom) >= stage.height - dock.y, `feet are above the dock: ${bottom}`);
  const head = await boxOf('#stage-verdict');
  assert.ok(parseFloat(top) >= head.y + head.height, `heads are below the verdict: ${top}`);

  const area = await modelArea(page);
  const body = await look(page, area);
  await page.locator('#angles').getByRole('button', { name: 'Face' }).click();
  assert.ok(difference(body, await look(page, area)) > 0.02, 'the face is near');
  const compare = page.getByRole('switch', { name: 'Compare' });
  await compare.check({ force: true });
  assert.equal(await mode(page), 'compare');
  await compare.uncheck({ force: true });
  assert.equal(await mode(page), 'result');

  const tiles = page.locator('.paints label').filter({ visible: true });
  await tiles.filter({ hasText: 'Scales' }).waitFor();
  const all = await tiles.count();
  assert.ok(await page.getByRole('radio', { name: 'Face' }).isHidden(), 'none needs what this cage lacks');
  await page.getByRole('radio', { name: 'Clothes' }).check({ force: true });
  assert.deepEqual(await tiles.locator('.title').allTextContents(), [
    'Tricolour',
    'Club colours',
    'Camouflage',
    'Carbon',
    'Harlequin',
  ]);
  await page.getByRole('radio', { name: 'All' }).check({ force: true });
  assert.equal(await tiles.count(), all);

  const menu = page.getByTestId('menu');
  assert.match((await menu.textContent())!, /Human/);
  assert.ok(await page.locator('#model').isHidden());
  await menu.press('Enter');
  assert.deepEqual(await faults(page), []);
  assert.ok(!/cage/i.test(await page.locator('#model').innerText()), 'Play knows no cages');
  await page.locator('#more > summary').click();
  await page.getByTestId('language').selectOption('de');
  await page.locator('html[lang=de]').waitFor();
  await page.keyboard.press('Escape');
  assert.ok(await page.locator('#model').isHidden());
  assert.deepEqual(complaints, []);
});

test('the side that is seen becomes the front', async () => {
  const { page } = await site.visit(kDesk, kPlay, '#sample=lizard&view=result');
  const area = await modelArea(page);
  await page.locator('#view').press('2');
  const left = await look(page, area);
  await page.getByTestId('menu').click();
  await page.locator('#more > summary').click();
  await page.getByTestId('set-front').click();
  await page.keyboard.press('Escape');
  await page.locator('#angles').getByRole('button', { name: 'Back' }).click();
  assert.ok(difference(left, await look(page, area)) > 0.02);
  await page.locator('#angles').getByRole('button', { name: 'Body' }).click();
  assert.ok(difference(left, await look(page, area)) < 0.01);
});

test('the film strip leads through the method on the model, is a link, and works with the keyboard', async () => {
  const { page, complaints } = await site.visit(kDesk, kPlay, '#sample=lizard&view=steps&step=2');
  const text = page.getByTestId('step-text');
  await text.filter({ hasText: /^A ray/ }).waitFor();
  await page.locator('#legend').waitFor();
  const area = await modelArea(page);
  const pictures = [await look(page, area)];
  await page.getByTestId('step').focus();
  await page.keyboard.press('Home');
  await text.filter({ hasText: /^A simple mesh/ }).waitFor();
  pictures.push(await look(page, area));
  for (const step of ['Closest point', 'Parts', 'Result']) {
    await page.locator('#steps').getByRole('button', { name: step }).click();
    assert.equal(await page.locator('#steps [aria-current=step]').textContent(), step);
    pictures.push(await look(page, area));
  }
  pictures.forEach((one, i) =>
    pictures.slice(i + 1).forEach((other) => assert.ok(difference(one, other) > 0.01, 'each frame is another one')),
  );
  const drawn = await page.locator('#steps canvas').evaluateAll((all) =>
    all.map((canvas) => {
      const { width, height } = canvas as HTMLCanvasElement;
      const { data } = (canvas as HTMLCanvasElement).getContext('2d')!.getImageData(0, 0, width, height);
      return data.some((value) => value > 0);
    }),
  );
  assert.deepEqual(drawn, [true, true, true, true, true], 'each has its picture');
  await page.locator('#stage-share').click();
  await page.locator('#share-link[href*="view=steps&step=4"]').waitFor();
  await page.keyboard.press('Escape');
  assert.deepEqual(await faults(page), []);
  await page.locator('#method > summary').click();
  assert.equal(await mode(page), 'result', 'closing it ends it');
  assert.deepEqual(complaints, []);
});

test('a link carries strokes; opened, they are where they were, and are carried on; damaged ones are left out', async () => {
  const { page } = await site.visit(kDesk, kPlay, '#sample=human&view=result');
  const area = await modelArea(page);
  const bare = await look(page, area);
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  const { x, y } = await middleOf(page);
  await page.mouse.move(x - 30, y);
  await page.mouse.down();
  await page.mouse.move(x + 30, y + 20, { steps: 5 });
  await page.mouse.up();
  const hint = page.locator('#link-hint', { hasText: 'your strokes and stickers' });
  await page.locator('#stage-share').click();
  await page.waitForFunction(() => document.querySelector<HTMLAnchorElement>('#share-link')!.hash.includes('strokes'));
  await hint.waitFor();
  await page.keyboard.press('Escape');
  await page.getByRole('radio', { name: 'Turn' }).check({ force: true });
  const painted = await look(page, area);
  assert.ok(difference(bare, painted) > 0.005, 'a stroke');
  const { hash } = new URL((await page.getByTestId('share-link').getAttribute('href'))!, site.url);
  assert.ok(hash.length < 4000, `${hash.length} characters`);

  const { page: linked, complaints } = await site.visit(kDesk, kPlay, hash);
  const same = await modelArea(linked);
  await watch(linked, same, (picture) => difference(picture, painted) < 0.01);
  await linked.locator('#stage-share').click();
  await linked.locator('#share-link[href*=strokes]').waitFor();
  assert.equal(new URL((await linked.getByTestId('share-link').getAttribute('href'))!, site.url).hash, hash);
  const { page: damaged } = await site.visit(kDesk, kPlay, hash.replace(/strokes:.{8}/, 'strokes:AAAAAAAA'));
  await watch(damaged, same, (picture) => difference(picture, bare) < 0.01);
  assert.deepEqual(complaints, []);
});

test('a photo of a face is put onto the face of the model by two dots, which the keyboard moves, too', async () => {
  const { page, complaints } = await site.visit(kDesk, kPlay);
  await drop(page, [head()]);
  await ready(page);
  await page.locator('#stage-verdict:not([data-verdict=""])').waitFor();
  const area = await modelArea(page);
  const before = await look(page, area);
  const photo = new PNG({ width: 60, height: 80 });
  photo.data.fill(255);
  await drop(page, [{ name: 'me.png', mimeType: 'image/png', buffer: PNG.sync.write(photo) }]);
  await page.getByRole('button', { name: 'It is a face' }).click();
  await page.getByRole('button', { name: 'Left eye in the picture' }).press('ArrowUp');
  assert.deepEqual(await faults(page, 5), []);
  await page.getByRole('button', { name: 'Put it on' }).click();
  await watch(page, area, (picture) => difference(picture, before) > 0.03);
  assert.ok(difference(await look(page, area), before) < 0.5, 'nothing but the face');
  await page.keyboard.press('Control+z');
  await watch(page, area, (picture) => difference(picture, before) < 0.005);
  assert.deepEqual(complaints, []);
});

test('on a phone the stage fills the screen, and the panel is a sheet: closed, or opened by its tabs and the keyboard', async () => {
  const { page, complaints } = await site.visit(kPhone, kPlay);
  const heights = () =>
    page.evaluate(() => ['stage', 'controls'].map((id) => document.getElementById(id)!.clientHeight));
  const [stage = 0, panel = 0] = await heights();
  assert.ok(stage > 0.8 * 844 && panel < 60, `${stage} and ${panel} pixels`);
  assert.deepEqual(await faults(page), []);
  await page.locator('#section-nav a', { hasText: 'Paint' }).click();
  const [less = 0, more = 0] = await heights();
  assert.ok(less < 0.6 * 844 && more > 0.4 * 844 && less + more <= 844, `${less} and ${more} pixels`);
  assert.deepEqual(await faults(page), []);
  await page.getByTestId('sheet').click();
  assert.deepEqual(await heights(), [stage, panel]);
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  assert.deepEqual(await heights(), [stage, panel], 'the stage has what the brush needs');
  await page.getByRole('radio', { name: 'Sticker' }).check({ force: true });
  assert.deepEqual(await heights(), [less, more], 'its text and image are in the sheet');
  await page.getByTestId('sheet').click();
  await page.locator('#sample-select').focus();
  assert.deepEqual(await heights(), [less, more], 'the keyboard gets there');
  await ready(page);
  assert.deepEqual(complaints, []);
});

test('a model that was saved goes on with its cage and its paint when it is dropped again; other programs see only the model', async () => {
  const { page, complaints } = await site.visit(kDesk, kPlay);
  await drop(page, [head()]);
  await ready(page);
  await page.locator('#stage-verdict:not([data-verdict=""])').waitFor();
  await page.locator('.paints label', { hasText: 'Harlequin' }).click();
  await ready(page);
  const area = await modelArea(page);
  const before = await look(page, area);
  await page.locator('#stage-share').click();
  const { name, bytes } = await saved(page, 'export-glb');
  await page.keyboard.press('Escape');
  assert.equal((await validModel(bytes)).getRoot().listScenes().length, 1);

  await drop(page, [glb(name, bytes)]);
  await ready(page);
  assert.equal(await page.locator('#target-name').textContent(), name);
  assert.equal(await page.locator('#texture-name').textContent(), 'paint.png');
  assert.ok(difference(before, await look(page, area)) < 0.02, 'it looks the same');
  assert.deepEqual(complaints, []);
});
