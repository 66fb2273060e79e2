import assert from 'node:assert/strict';
import { test } from 'node:test';
import { faults } from '../../support/axe';
import { asset, dragBy, head, savedCage, workedFor } from '../../support/cages';
import { difference, look, modelArea } from '../../support/picture';
import { saved, validModel } from '../../support/saved';
import { drop, glb, openSite, passed, ready, setThreshold, shownCounts, shownParts } from '../../support/site';

const site = await openSite();

test('a part that is kept says why the rest stays bare, and can be painted anyway; the slider has marks where parts change', async () => {
  const { page, complaints } = await site.visit();
  const tongue = page.getByRole('combobox', { name: 'Override for tongue' });
  await tongue.selectOption('keep');
  const note = page.getByTestId('keep-note');
  assert.match((await note.textContent())!, /“tongue” is kept: .* The rest stays bare: .*“Paint anyway” paints it too/);
  const painted = (await shownCounts(page)).cosmetic;
  const { points } = (await shownParts(page)).find(({ name }) => name === 'tongue')!;
  await tongue.selectOption('always');
  assert.ok(await note.isHidden());
  const anyway = (await shownCounts(page)).cosmetic;
  assert.ok(anyway > painted + points / 2, `${painted} points, then ${anyway}; the tongue has ${points}`);
  const document = await validModel((await saved(page, 'export-glb')).bytes);
  const node = document
    .getRoot()
    .listNodes()
    .find((one) => one.getName() === 'tongue')!;
  const zones = node.getMesh()!.listPrimitives()[0]!.getAttribute('_NCZ')!.getArray()!;
  assert.ok(
    [...zones].every((zone: number) => zone === 0),
    'the saved model has the same',
  );
  await tongue.selectOption('auto');

  const marks = page.getByTestId('threshold-marks').locator('option');
  await marks.first().waitFor({ state: 'attached' });
  const mark = await marks.first().evaluate((option) => Number((option as HTMLOptionElement).value));
  const title = /: (.+?)(, .*)? at /.exec((await page.locator('#threshold-flips').textContent())!)![1]!;
  const verdictAt = async (threshold: number) => {
    await setThreshold(page, threshold);
    return (await shownParts(page)).filter(({ name }) => name.startsWith(title)).map(({ culled }) => culled);
  };
  assert.notDeepEqual(await verdictAt(mark - 0.01), await verdictAt(mark), `${title} at ${mark}`);
  assert.deepEqual(await faults(page), []);
  assert.deepEqual(complaints, []);
});

test('the cage can be moved, turned and scaled by handles and keys, its corners moved, its holes opened and closed', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head(), glb('bust-cage.glb', asset('human', 'cage.glb'))]);
  await ready(page);
  const start = await shownCounts(page);
  await page.getByTestId('adjust-cage').click();
  const handle = (name: string) => page.locator(`[data-handle=${name}]`);
  await handle('x').waitFor();
  assert.deepEqual(await faults(page), []);
  const does = async (what: string, act: () => Promise<unknown>) => {
    await workedFor(page, act);
    assert.equal(await page.getByTestId('undo').getAttribute('title'), `Undo: ${what}`);
  };
  const undone = async () => {
    await page.getByTestId('undo').click();
    await ready(page);
    assert.deepEqual(await shownCounts(page), start);
  };
  // At once: what is pressed later is a step of its own.
  await does('moving the cage', () =>
    handle('x').evaluate((dot) => {
      const press = { key: 'ArrowRight', bubbles: true, cancelable: true };
      for (let i = 0; i < 9; i++) dot.dispatchEvent(new KeyboardEvent('keydown', press));
    }),
  );
  assert.notDeepEqual(await shownCounts(page), start, 'moved by keys');
  await undone();
  for (const [mode, name] of [
    ['turn', 'x'],
    ['scale', 'y'],
  ] as const) {
    await page.locator(`#adjust input[value=${mode}]`).check({ force: true });
    await does('moving the cage', () => dragBy(page, handle(name), 10, -30));
    assert.notDeepEqual(await shownCounts(page), start, mode);
    await undone();
  }
  await page.locator('#adjust input[value=corner]').check({ force: true });
  await page.locator('#view').press('Enter');
  await handle('corner').waitFor();
  assert.deepEqual(await faults(page), []);
  const area = await modelArea(page);
  const bare = await look(page, area);
  await does('moving a corner', () => dragBy(page, handle('corner'), 40, 60));
  assert.ok(difference(bare, await look(page, area)) > 0.0005);
  await undone();

  await page.locator('#adjust input[value=hole]').check({ force: true });
  const { indices } = JSON.parse(
    (await page.locator('#sizes').textContent())!.replace(/.*cage (\d+).*/, '{"indices":$1}'),
  );
  await does('opening a hole', () => page.locator('#view').press('Enter'));
  assert.match((await page.locator('#sizes').textContent())!, new RegExp(`cage ${indices - 1} `));
  assert.ok(await page.getByTestId('put-away').isHidden());
  await does('closing a hole', () => page.locator('#view').press('Enter'));
  assert.deepEqual(await shownCounts(page), start, 'the hole is closed');
  await savedCage(page);
  await page.locator('#adjust-done').press('Enter');
  assert.equal(await page.evaluate(() => document.activeElement?.id), 'adjust-cage');
  assert.ok(await page.getByTestId('adjust').isHidden());
  assert.deepEqual(complaints, []);
});

test('a change of the cage waits for the one before, and none reaches a cage that came otherwise, or of another model', async () => {
  const { page, complaints } = await site.visit();
  const open = async () => {
    await drop(page, [head(), glb('bust-cage.glb', asset('human', 'cage.glb'))]);
    await ready(page);
  };
  await open();
  const start = await page.locator('#sizes').textContent();
  const undo = page.getByTestId('undo');
  const does = async (what: string, act: () => Promise<unknown>) => {
    await workedFor(page, act);
    assert.equal(await page.getByTestId('undo').getAttribute('title'), `Undo: ${what}`);
  };
  await page.getByTestId('adjust-cage').click();
  await page.locator('[data-handle=x]').waitFor();
  await page.locator('#adjust input[value=hole]').check({ force: true });
  await does('opening a hole', () =>
    page.locator('#view').evaluate((view) => {
      for (let i = 0; i < 2; i++) view.dispatchEvent(new KeyboardEvent('keydown', { key: 'Enter' }));
    }),
  );
  await undo.click();
  await ready(page);
  assert.equal(await page.locator('#sizes').textContent(), start);
  assert.ok(await undo.isDisabled(), 'one change is one step');

  await page.locator('#adjust input[value=corner]').check({ force: true });
  await page.locator('#view').press('Enter');
  await does('moving a corner', () => dragBy(page, page.locator('[data-handle=corner]'), 40, 60));
  await page.locator('[data-handle=corner]').waitFor();
  await drop(page, [glb('other-cage.glb', asset('lizard', 'cage.glb'))]);
  await page.locator('[data-handle=corner]').waitFor({ state: 'detached' });
  await ready(page);
  assert.ok(await undo.isDisabled(), 'undoing would put the cage of before in the place of the one that came');
  await open();
  await page.locator('#undo[title^="Undo: replacing"]').waitFor();
  await passed(page, 1000);
  await ready(page);
  assert.match((await undo.getAttribute('title'))!, /^Undo: replacing/, 'nothing was done to the cage that came');
  assert.deepEqual(complaints, []);
});

test('what keys did to the cage is undone at once, before the steps that came before it, and done again', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head(), glb('bust-cage.glb', asset('human', 'cage.glb'))]);
  await ready(page);
  const start = await shownCounts(page);
  await page.getByTestId('add-painting').click();
  await page.getByTestId('adjust-cage').click();
  await page.locator('[data-handle=x]').waitFor();
  // At once: what is pressed later waits for the change.
  const titles = await page.locator('[data-handle=x]').evaluate((dot) => {
    const keys = [...Array(9).fill('ArrowRight'), 'z'];
    return keys.map((key) => {
      dot.dispatchEvent(new KeyboardEvent('keydown', { key, ctrlKey: key === 'z', bubbles: true, cancelable: true }));
      return document.querySelector<HTMLElement>('#undo')!.title;
    });
  });
  assert.deepEqual(titles.slice(-2), ['Undo: moving the cage', 'Undo: adding a painting']);
  await passed(page, 1000);
  await ready(page);
  assert.deepEqual(await shownCounts(page), start);
  await workedFor(page, () => page.keyboard.press('Control+Shift+z'));
  assert.notDeepEqual(await shownCounts(page), start);
  assert.equal(await page.getByTestId('undo').getAttribute('title'), 'Undo: moving the cage');
  await workedFor(page, () => page.keyboard.press('Control+z'));
  assert.deepEqual(await shownCounts(page), start);

  // While the cage is being changed.
  await page.evaluate(() => {
    new MutationObserver((_, observer) => {
      observer.disconnect();
      dispatchEvent(new KeyboardEvent('keydown', { key: 'z', ctrlKey: true, cancelable: true }));
    }).observe(document.querySelector('#status')!, { attributeFilter: ['data-state'] });
  });
  await workedFor(page, () => page.locator('[data-handle=x]').press('ArrowRight'));
  await passed(page, 1000);
  await ready(page);
  assert.deepEqual(await shownCounts(page), start);
  assert.equal(await page.getByTestId('undo').getAttribute('title'), 'Undo: adding a painting');
  assert.deepEqual(complaints, []);
});
