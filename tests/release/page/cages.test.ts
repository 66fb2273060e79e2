import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { faults } from '../../support/axe';
import { asset, fitted, head, heldBack, holdingBack, middleOf, ready, worked } from '../../support/cages';
import { GlbMaker, tetrahedron } from '../../support/glb';
import { names, rows } from '../../support/layers';
import { validModel } from '../../support/saved';
import { drop, glb, passed, Site, shownError, shownParts, violetPaint } from '../../support/site';

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

test('a cage is made with the chosen number of triangles and parts, again when these change', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head()]);
  await ready(page);
  await page.getByTestId('make-options').locator('summary').click();
  const parts = page.locator('#make-parts label');
  await parts.first().waitFor();
  assert.deepEqual(
    await parts.evaluateAll((rows) => rows.map((row) => [row.textContent, row.querySelector('input')!.checked])),
    [
      ['skin', true],
      ['l-eye', false],
      ['r-eye', false],
      ['upper-teeth', false],
      ['lower-teeth', false],
      ['tongue', false],
    ],
  );
  assert.deepEqual(await faults(page), []);
  await page.locator('#make-triangles').fill('5');
  assert.match((await page.locator('#make-triangles-value').textContent())!, /^about 1\d0$/);
  await page.locator('#make-offset').fill('20');
  await page.getByTestId('make-cage').click();
  const note = page.locator('#cage-note', { hasText: 'was made' });
  await note.waitFor();
  await ready(page);
  const first = Number(/\d+/.exec((await note.textContent())!)![0]);
  const cover = async () => parseInt((await shownParts(page)).find(({ name }) => /^l-eye/.test(name))!.covered, 10);
  const before = await cover();
  // The eyes are to be painted: no holes are cut for them.
  await page.getByRole('checkbox', { name: 'l-eye' }).check();
  await page.getByRole('checkbox', { name: 'r-eye' }).check();
  await worked(page);
  assert.ok(first < 300, `${first} triangles`);
  const now = await cover();
  assert.ok(before < 50 && now > 90, `the eye was covered to ${before} %, and is to ${now} %`);
  assert.deepEqual(complaints, []);
});

test('what the page says of a made cage that is poor, or that cannot be made, can be done there', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head()]);
  await ready(page);
  await page.getByTestId('make-options').locator('summary').click();
  // So close and so coarse that the model is outside.
  await page.locator('#make-offset').fill('1');
  await page.locator('#make-triangles').fill('1');
  await page.getByTestId('make-cage').click();
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await ready(page);
  await page.locator('#stage-verdict[data-verdict=unfit]').waitFor();
  assert.ok((await page.locator('#fit-findings li').count()) > 0);
  assert.equal(await page.getByRole('button', { name: /move the cage/i }).count(), 0, 'it is where it belongs');
  assert.ok(await page.getByTestId('stage-remedy').isHidden(), 'the same cage again is no remedy');

  const maker = new GlbMaker();
  for (const x of [0, 9]) maker.node({ name: 'rock', translation: [x, 0, 0], mesh: maker.mesh(tetrahedron()) });
  await drop(page, [glb('rocks.glb', maker.finish())]);
  await ready(page);
  await page.getByTestId('make-cage').click();
  await page.getByTestId('error').waitFor();
  assert.match(
    await shownError(page),
    /rocks\.glb: model is in pieces that lie too far apart for one cage: make one for each, leave out some,/,
  );
  assert.deepEqual(complaints, []);
});

test('a sample whose cage was moved into place keeps its paints, over a reload too, and the cage can be adjusted and saved', async () => {
  const { page, complaints } = await site.visit();
  await page.getByTestId('sample-select').selectOption('human-misaligned');
  await ready(page);
  const paints = page.locator('#paints input[type=radio]');
  const names = (): Promise<string[]> =>
    paints.evaluateAll((all) => all.map((one) => one.closest('label')!.textContent!));
  const before = await names();
  assert.ok(before.length > 1, `the sample has ${before.length} paints`);
  const remedy = page.getByTestId('stage-remedy').filter({ hasText: 'Move the cage' });
  await remedy.click();
  await page.locator('#cage-note', { hasText: 'was moved into place' }).waitFor();
  await ready(page);
  assert.equal(await page.locator('#cage-name').textContent(), 'cage.glb');
  const holds = async (when: string): Promise<void> => {
    assert.deepEqual(await names(), before, when);
    for (const id of ['save-cage', 'adjust-cage']) assert.ok(await page.getByTestId(id).isVisible(), `${id} ${when}`);
    assert.doesNotMatch((await page.locator('#hint').textContent())!, /still the sample/, when);
  };
  await holds('after the move');
  await page.getByTestId('kept-note').filter({ hasText: 'is kept on this device' }).waitFor();
  await page.reload();
  await page.getByTestId('kept').filter({ hasText: 'Your last work is back.' }).waitFor();
  await ready(page);
  await holds('after a reload');

  await page.getByTestId('make-cage').click();
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await ready(page);
  assert.equal(await page.locator('#cage-name').textContent(), 'target-cage.glb');
  assert.deepEqual(await names(), before.slice(-1), 'a cage with other UVs has the checker alone');
  assert.deepEqual(complaints, []);
});

test('a cage made for one model never reaches another that is loading, or that waits for its own cage', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head()]);
  await page.locator('#target-name', { hasText: 'bust.glb' }).waitFor();
  await ready(page);
  await fitted(page);
  await page.locator('[data-landmark=nose_tip]').press('ArrowDown');
  await worked(page);
  const sample = page.getByTestId('sample-select');
  const bustAgain = async (): Promise<void> => {
    await drop(page, [head(), glb('bust-cage.glb', asset('human', 'cage.glb'))]);
    await page.locator('#target-name', { hasText: 'bust.glb' }).waitFor();
    await ready(page);
  };
  for (const work of ['undo', 'fit-cage', 'make-cage']) {
    let letGo = (): void => {};
    const held = new Promise<void>((done) => (letGo = done));
    await page.route(/car/, (route) => held.then(() => route.continue()));
    await sample.selectOption('car');
    await page.getByTestId(work).click();
    await passed(page, 500); // for work that must not begin
    letGo();
    await page.locator('#target-name', { hasText: 'target.glb' }).waitFor();
    await ready(page);
    await passed(page, 1000);
    await ready(page);
    assert.equal(await page.locator('#cage-name').textContent(), 'cage.glb', `${work} while the car was loading`);
    assert.equal(await sample.inputValue(), 'car');
    await page.unroute(/car/);
    await bustAgain();
  }

  await drop(page, [glb('lizard.glb', asset('lizard', 'target.glb')), glb('own.glb', asset('lizard', 'cage.glb'))]);
  await page.getByTestId('make-cage').click();
  await page.locator('#target-name', { hasText: 'lizard.glb' }).waitFor();
  await ready(page);
  await passed(page, 1000);
  await ready(page);
  assert.match((await page.locator('#cage-name').textContent())!, /^(own|lizard-cage)\.glb$/);

  // A model whose cage cannot be read waits for another one.
  await bustAgain();
  await drop(page, [glb('lizard.glb', asset('lizard', 'target.glb')), glb('own-cage.glb', Buffer.from('glTF'))]);
  await page.getByTestId('error').waitFor();
  await page.getByTestId('make-cage').click();
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await ready(page);
  assert.equal(await page.locator('#target-name').textContent(), 'bust.glb');
  assert.deepEqual(complaints, []);
});

test('a model dropped alone: a cage is made, it is painted, and the model is saved with the paint', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head()]);
  await ready(page);
  const remedy = page.getByTestId('stage-remedy');
  await remedy.waitFor();
  await remedy.press('Enter');
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await ready(page);
  await remedy.waitFor({ state: 'hidden' });
  assert.equal(await page.evaluate(() => document.activeElement?.id), 'stage-verdict-text', 'the focus is not lost');
  assert.deepEqual(await faults(page), []);
  await page.locator('#tools input[data-key=b]').check({ force: true });
  await page.getByTestId('brush-color').fill('#12ff34');
  const { x, y } = await middleOf(page);
  await page.mouse.move(x - 20, y);
  await page.mouse.down();
  await page.mouse.move(x + 20, y + 10, { steps: 3 });
  await page.mouse.up();
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId('stage-save').click()]);
  const saved = await validModel(readFileSync(await download.path()));
  const overlay = saved
    .getRoot()
    .listMaterials()
    .find((material) => material.getName() === 'Cagecast overlay')!;
  const { data } = PNG.sync.read(Buffer.from(overlay.getBaseColorTexture()!.getImage()!));
  let painted = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i]! < 40 && data[i + 1]! > 240 && data[i + 2]! < 70) painted++;
  assert.ok(painted > 100, `${painted} texels have the colour of the brush`);
  assert.deepEqual(complaints, []);
});

async function stroke(page: Page): Promise<void> {
  await page.locator('#tools input[data-key=b]').check({ force: true });
  const { x, y } = await middleOf(page);
  await page.mouse.move(x - 20, y);
  await page.mouse.down();
  await page.mouse.move(x + 20, y + 10, { steps: 3 });
  await page.mouse.up();
}

test('paint for earlier cages is kept put away, however often the cage is made again, and over a reload', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head()]);
  await ready(page);
  await page.getByTestId('make-options').locator('summary').click();
  await page.getByTestId('make-cage').click();
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await ready(page);
  /** The layers, those that are hidden in brackets, and what is offered. */
  const state = async (): Promise<string[]> => {
    const shown = await rows(page)
      .locator('input[name=visible]')
      .evaluateAll((boxes) => boxes.map((box) => (box as HTMLInputElement).checked));
    const offer = page.getByTestId('put-away');
    const layers = (await names(page)).map((name, i) => (shown[i] ? name : `(${name})`));
    return [...layers, (await offer.isVisible()) ? (await offer.locator('p').textContent())! : 'nothing'];
  };
  const makeWith = async (triangles: string): Promise<void> => {
    await page.locator('#make-triangles').fill(triangles);
    await worked(page);
  };
  await stroke(page);
  assert.deepEqual(await state(), ['Painting 1', '(UV checker)', 'nothing']);
  await makeWith('8');
  assert.deepEqual(await state(), ['UV checker', 'One layer of an earlier cage put away.']);
  await makeWith('9');
  assert.deepEqual(await state(), ['UV checker', 'One layer of an earlier cage put away.']);
  await stroke(page);
  await makeWith('10');
  assert.deepEqual(await state(), ['UV checker', '2 layers of earlier cages put away.']);
  await page.getByTestId('undo').click();
  assert.deepEqual(await state(), ['Painting 1', '(UV checker)', 'One layer of an earlier cage put away.']);
  await page.getByTestId('redo').click();
  assert.deepEqual(await state(), ['UV checker', '2 layers of earlier cages put away.']);

  await page.waitForFunction(() => dispatchEvent(new Event('beforeunload', { cancelable: true })));
  await page.reload();
  await page.getByTestId('kept').filter({ hasText: 'Your last work is back.' }).waitFor();
  await ready(page);
  assert.deepEqual(await state(), ['UV checker', '2 layers of earlier cages put away.']);
  assert.ok(await page.getByTestId('save-cage').isVisible(), 'the cage that was made can still be saved');
  await page.getByRole('button', { name: 'Bring back' }).click();
  assert.deepEqual(await state(), ['Painting 1', 'Painting 1', '(UV checker)', 'nothing']);
  assert.deepEqual(complaints, []);
});

test('a cage that is being made comes, though rules are chosen meanwhile, and by these', async () => {
  const { page, complaints } = await site.visit({}, holdingBack('makeCage'));
  await drop(page, [head()]);
  await ready(page);
  await page.getByTestId('make-cage').click();
  await heldBack(page);
  await page.getByTestId('preset').selectOption('paper');
  await page.locator('#exact-borders').check({ force: true });
  await page.getByTestId('threshold').fill('0.9');
  await passed(page, 1000);
  await page.evaluate('window.letGo()');
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await page.locator('#borders-note', { hasText: 'Adds' }).waitFor();
  await ready(page);
  assert.equal(await page.getByTestId('preset').inputValue(), 'paper');

  // One that is cancelled leaves the rules to be followed.
  await page.evaluate('window.holds = true');
  await page.getByTestId('make-cage').click();
  await heldBack(page);
  await page.getByTestId('preset').selectOption('default');
  await page.getByTestId('cancel').click();
  await ready(page);
  assert.equal(await page.getByTestId('preset').inputValue(), 'paper');
  assert.deepEqual(complaints, []);
});

test('a cage that is being made comes, though paints are chosen and dropped meanwhile', async () => {
  const { page, complaints } = await site.visit({}, holdingBack('makeCage'));
  await drop(page, [head()]);
  await page.locator('#target-name', { hasText: 'bust.glb' }).waitFor();
  await ready(page);
  await page.getByTestId('make-cage').click();
  await heldBack(page);
  const title = page.locator('#paints label .title').nth(1);
  const chosen = (await title.textContent())!;
  await title.click();
  await page.locator('#undo[title^="Undo: choosing"]').waitFor();
  assert.equal((await names(page)).at(-1), chosen);
  await drop(page, [violetPaint()]);
  await page.locator('#layers', { hasText: 'violet.png' }).waitFor();
  await drop(page, [{ name: 'broken.png', mimeType: 'image/png', buffer: Buffer.from('no image') }]);
  await page.locator('#error', { hasText: 'broken.png: the browser cannot read this image' }).waitFor();
  assert.equal(await page.getByTestId('status').textContent(), 'working');
  await page.evaluate('window.letGo()');
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await ready(page);
  assert.deepEqual(await names(page), ['UV checker']);
  await page.getByTestId('put-away').filter({ hasText: 'One layer of an earlier cage put away.' }).waitFor();
  assert.deepEqual(complaints, []);
});

test('where a cage comes again, the layers that were painted for it are brought back, without those of others', async () => {
  const { page, complaints } = await site.visit({}, undefined, '#sample=lizard');
  const add = async (name: string): Promise<void> => {
    await page.getByTestId('texture-input').setInputFiles({ ...violetPaint(), name });
    await page.locator('#layers', { hasText: name }).waitFor();
    await ready(page);
  };
  const open = async (name: string): Promise<void> => {
    await page.getByTestId('sample-select').selectOption(name);
    await ready(page);
  };
  await add('scales.png');
  await open('human');
  await add('skin.png');
  const [, base] = await names(page);
  await open('lizard');
  const [own] = await names(page);
  const offer = page.getByTestId('put-away');
  await offer.filter({ hasText: '2 layers of earlier cages put away.' }).waitFor();
  await page.locator('#bring-back').click();
  assert.deepEqual(await names(page), ['scales.png', own]);
  await offer.filter({ hasText: 'One layer of an earlier cage put away.' }).waitFor();
  await open('human');
  await page.locator('#bring-back').click();
  assert.deepEqual(await names(page), ['skin.png', base]);
  // Where none is of the cage, all of them come.
  await open('car');
  await page.locator('#bring-back').click();
  assert.deepEqual((await names(page)).slice(0, 2).sort(), ['scales.png', 'skin.png']);
  assert.deepEqual(complaints, []);
});
