import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { names } from '../support/layers';
import { Site, settled, shownCounts, shownError, shownParts } from '../support/site';

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

test('one stack: undo goes back over rules, overrides, the shape and layers in their order, and redo does them again', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 } });
  await page.locator('#parts summary').click();
  const part = (await shownParts(page))[0]!.name;
  const amount = page.getByTestId('amount');
  const moving = page.locator('#live[aria-busy=true]');
  const state = async () => {
    await moving.waitFor({ state: 'detached' });
    assert.equal(await settled(page), 'ready', await shownError(page));
    return {
      counts: await shownCounts(page),
      locks: (await shownParts(page)).flatMap(({ name, lock }) => (lock === 'auto' ? [] : [[name, lock]])),
      amount: await amount.inputValue(),
      deform: await page.getByTestId('deform').inputValue(),
      threshold: await page.getByTestId('threshold').inputValue(),
      preset: await page.getByTestId('preset').inputValue(),
      layers: await names(page),
    };
  };
  const steps: [string, () => Promise<unknown>][] = [
    ['changing the threshold', () => page.getByTestId('threshold').fill('0.9')],
    [`excluding ${part}`, () => page.getByLabel(`Override for ${part}`, { exact: true }).selectOption('exclude')],
    ['adding a painting', () => page.getByTestId('add-painting').click()],
    ['changing the shape', () => amount.fill('0.5')],
    ['choosing rules', () => page.getByTestId('preset').selectOption('paper')],
    [`keeping ${part}`, () => page.getByLabel(`Override for ${part}`, { exact: true }).selectOption('keep')],
  ];
  const states = [await state()];
  for (const [name, act] of steps) {
    await act();
    states.push(await state());
    assert.equal(await page.getByTestId('undo').getAttribute('title'), `Undo: ${name}`);
  }
  for (const [at, [name]] of [...steps.entries()].toReversed()) {
    assert.notDeepEqual(states[at], states[at + 1], `${name} does something`);
    await page.keyboard.press('Control+z');
    assert.deepEqual(await state(), states[at], `${name}, undone`);
  }
  for (const [at, [name]] of steps.entries()) {
    await page.keyboard.press('Control+Shift+z');
    assert.deepEqual(await state(), states[at + 1], `${name}, redone`);
  }

  // What was chosen for the parts of one model says nothing about another.
  await page.getByTestId('sample-select').selectOption({ index: 1 });
  for (const name of ['Undo: putting layers away', 'Undo: adding a painting', 'Undo']) {
    await page.waitForFunction((title) => document.querySelector<HTMLElement>('#undo')!.title === title, name);
    assert.equal(await settled(page), 'ready', await shownError(page));
    await page.keyboard.press('Control+z');
  }
  assert.deepEqual(complaints, []);
});
