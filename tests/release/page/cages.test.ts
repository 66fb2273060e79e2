import assert from 'node:assert/strict';
import { test } from 'node:test';
import { faults } from '../../support/axe';
import { asset, head, worked } from '../../support/cages';
import { GlbMaker, tetrahedron } from '../../support/glb';
import { difference, look, modelArea } from '../../support/picture';
import { drop, glb, openSite, ready, shownError, shownParts } from '../../support/site';

const site = await openSite();

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

test('the paint of the cage before is carried over to a made cage, by one click', async () => {
  const { page, complaints } = await site.visit();
  const paint = { name: 'paint.png', mimeType: 'image/png', buffer: asset('human', 'paint-harlequin.png') };
  await drop(page, [head(), glb('cage.glb', asset('human', 'cage.glb')), paint]);
  await ready(page);
  const seen = async () => {
    await page.mouse.move(5, 5);
    return look(page, await modelArea(page));
  };
  const before = await seen();
  await page.getByTestId('make-cage').click();
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await ready(page);
  const checker = difference(before, await seen());
  const offer = page.getByTestId('carry-over');
  await offer.click();
  await page.locator('#layer-list', { hasText: 'carried over' }).waitFor();
  await ready(page);
  const carried = difference(before, await seen());
  assert.ok(
    carried < 0.2 * checker,
    `${carried} of the picture is other than before; with the checker, ${checker} was`,
  );
  assert.equal(await offer.isVisible(), false);
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
