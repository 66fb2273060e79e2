import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { test } from 'node:test';
import type { Locator } from 'playwright-core';
import { image, names, rows, savedTexture } from '../../support/layers';
import { modelArea } from '../../support/picture';
import { openSite, ready } from '../../support/site';

const site = await openSite();
let visit = await site.visit({ viewport: { width: 900, height: 600 } });
for (const [name, red] of [
  ['red.png', 255],
  ['blue.png', 0],
] as const) {
  await visit.page.getByTestId('texture-input').setInputFiles(image(name, 64, (x) => [red, x, 255 - red, 200]));
  await ready(visit.page);
  await rows(visit.page).filter({ hasText: name }).waitFor();
}

const control = (role: 'slider' | 'combobox' | 'checkbox' | 'button', name: string): Locator =>
  visit.page.getByTestId('layer-list').getByRole(role, { name });
const undoTitle = async (): Promise<string> => (await visit.page.getByTestId('undo').getAttribute('title'))!;

/** The texture, and what the list says. */
async function state(): Promise<object> {
  const { page } = visit;
  const texture = createHash('sha256')
    .update((await savedTexture(page)).data)
    .digest('hex');
  const said = await rows(page).evaluateAll((items) =>
    items.map((item) => [
      item.querySelector('.name')!.textContent,
      ...[...item.querySelectorAll('input, select')].map((input) =>
        (input as HTMLInputElement).type === 'checkbox'
          ? (input as HTMLInputElement).checked
          : (input as HTMLInputElement).value,
      ),
    ]),
  );
  return { said, texture };
}

/** Two things that a hand does are not done within a moment. */
const pause = (): Promise<void> =>
  visit.page.evaluate(() => {
    const now = performance.now.bind(performance);
    performance.now = () => now() + 700;
  });

test('every edit of a layer is an undo step, also between strokes', async () => {
  const { page, complaints } = visit;
  const tint = (color: string): Promise<void> => page.getByLabel('Tint of blue.png').fill(color);
  const area = await modelArea(page);
  const stroke = async (): Promise<void> => {
    await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
    await page.mouse.move(area.x + 0.45 * area.width, area.y + 0.4 * area.height);
    await page.mouse.down();
    await page.mouse.move(area.x + 0.5 * area.width, area.y + 0.45 * area.height, { steps: 3 });
    await page.mouse.up();
  };
  const steps: [string, () => Promise<unknown>][] = [
    ['changing the opacity of blue.png', () => control('slider', 'Opacity of blue.png').fill('40')],
    ['changing the tint of blue.png', () => tint('#ff8020')],
    ['changing the blending of blue.png', () => control('combobox', 'Blending of blue.png').selectOption('multiply')],
    ['changing the visibility of red.png', () => control('checkbox', 'Show red.png').uncheck({ force: true })],
    ['stroke', stroke],
    ['moving blue.png', () => control('button', 'Reorder blue.png').press('ArrowDown')],
    [
      'adding War paint',
      async () => {
        await page.getByRole('button', { name: 'Add War paint as a layer' }).click();
        await rows(page).filter({ hasText: 'War paint' }).waitFor();
      },
    ],
    [
      'choosing UV checker',
      async () => {
        await page.getByRole('radio', { name: 'UV checker' }).check({ force: true });
        await ready(page);
      },
    ],
    ['adding a painting', () => page.getByTestId('add-painting').click()],
    ['removing red.png', () => control('button', 'Remove red.png').click()],
    [
      'changing the visibility of red.png',
      async () => {
        await page.keyboard.press('Control+z');
        await control('checkbox', 'Show red.png').check({ force: true });
      },
    ],
  ];
  const states = [await state()];
  for (const [name, act] of steps) {
    await act();
    assert.match(await undoTitle(), new RegExp(`: ${name}$`));
    states.push(await state());
  }
  // The last but one was undone for the sake of the last.
  states.splice(-2, 1);
  const done = steps.filter(([name]) => name !== 'removing red.png');
  for (const [at, [name]] of [...done.entries()].toReversed()) {
    assert.notDeepEqual(states[at], states[at + 1], `${name} does something`);
    await page.keyboard.press('Control+z');
    assert.deepEqual(await state(), states[at], `${name}, undone`);
  }
  assert.match(await undoTitle(), /adding blue.png/);
  for (const [at, [name]] of done.entries()) {
    await page.getByTestId('redo').click();
    assert.deepEqual(await state(), states[at + 1], `${name}, redone`);
  }
  await page.waitForFunction(
    () => document.querySelector('#summary')!.textContent === 'Redone: changing the visibility of red.png.',
  );
  assert.deepEqual(complaints, []);
});

test('a drag is one undo step, and so is a held key', async () => {
  const { page } = visit;
  await rows(page).filter({ hasText: 'red.png' }).locator('.choose').click();
  const slider = control('slider', 'Opacity of red.png');
  const box = (await slider.boundingBox())!;
  const before = await slider.inputValue();
  await page.mouse.move(box.x + 0.9 * box.width, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + box.height / 2, { steps: 5 });
  await pause(); // one may think in the middle of it
  await page.mouse.move(box.x + 0.2 * box.width, box.y + box.height / 2, { steps: 5 });
  await page.mouse.up();
  const dragged = await slider.inputValue();
  assert.ok(Number(dragged) < 30, dragged);
  await pause();
  // What a key held down makes the browser say, but at its pace and not that of a busy machine.
  await slider.evaluate((input: HTMLInputElement) => {
    for (let i = 0; i < 5; i++) {
      input.stepUp();
      for (const type of ['input', 'change']) input.dispatchEvent(new Event(type, { bubbles: true }));
    }
  });
  assert.equal(await slider.inputValue(), String(Number(dragged) + 5));
  await page.keyboard.press('Control+z');
  assert.equal(await slider.inputValue(), dragged);
  await page.keyboard.press('Control+z');
  assert.equal(await slider.inputValue(), before);

  // Dragged past two rows, and back again: the one is a step, the other none.
  const order = await names(page);
  const middle = async (name: string): Promise<[number, number]> => {
    const { x, y, width, height } = (await control('button', `Reorder ${name}`).boundingBox())!;
    return [x + width / 2, y + height / 2];
  };
  const [first, third] = [order[0]!, order[2]!];
  await page.mouse.move(...(await middle(first)));
  await page.mouse.down();
  const [x, y] = await middle(third);
  await page.mouse.move(x, y + 12, { steps: 8 });
  await page.mouse.up();
  assert.equal((await names(page))[2], first);
  const title = await undoTitle();
  assert.match(title, /moving/);
  await page.mouse.move(...(await middle(third)));
  await page.mouse.down();
  await page.mouse.move(x, y + 30, { steps: 8 });
  await page.mouse.move(...(await middle(order[1]!)), { steps: 8 });
  await page.mouse.up();
  await page.keyboard.press('Control+z');
  assert.deepEqual(await names(page), order);
});

test('undo is blocked during an edit, which is kept', async () => {
  const { page, complaints } = visit;
  const area = await modelArea(page);
  const before = [await undoTitle(), await state()];
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  await page.mouse.move(area.x + 0.45 * area.width, area.y + 0.4 * area.height);
  await page.mouse.down();
  await page.mouse.move(area.x + 0.5 * area.width, area.y + 0.45 * area.height, { steps: 3 });
  await page.keyboard.press('Control+z');
  await page.mouse.move(area.x + 0.5 * area.width, area.y + 0.5 * area.height, { steps: 3 });
  // What comes meanwhile is undone with it.
  await page.getByTestId('add-painting').evaluate((button: HTMLButtonElement) => button.click());
  await page.mouse.up();
  assert.match(await undoTitle(), /: stroke$/);
  const painted = await state();
  assert.notDeepEqual(painted, before[1]);
  await page.keyboard.press('Control+z');
  assert.deepEqual([await undoTitle(), await state()], before);
  await page.keyboard.press('Control+y');
  assert.deepEqual(await state(), painted);
  await page.keyboard.press('Control+z');

  // A layer on its way to another place.
  const grip = (await control('button', 'Reorder blue.png').boundingBox())!;
  await page.mouse.move(grip.x + grip.width / 2, grip.y + grip.height / 2);
  await page.mouse.down();
  await page.mouse.move(grip.x + grip.width / 2, grip.y + 90, { steps: 5 });
  for (let time = 0; time < 3; time++) await page.keyboard.press('Control+z');
  await page.mouse.move(grip.x + grip.width / 2, grip.y + 300, { steps: 5 });
  await page.mouse.up();
  assert.match(await undoTitle(), /: moving blue.png$/);
  await page.keyboard.press('Control+z');
  assert.deepEqual([await undoTitle(), await state()], before);

  // An opacity that ends where it began.
  await rows(page).filter({ hasText: 'red.png' }).locator('.choose').click();
  const slider = (await control('slider', 'Opacity of red.png').boundingBox())!;
  const opacity = Number(await control('slider', 'Opacity of red.png').inputValue());
  const x = slider.x + 8 + (opacity / 100) * (slider.width - 16);
  await page.mouse.move(x, slider.y + slider.height / 2);
  await page.mouse.down();
  await page.mouse.move(slider.x + 0.3 * slider.width, slider.y + slider.height / 2, { steps: 3 });
  await page.mouse.move(x, slider.y + slider.height / 2, { steps: 3 });
  await page.mouse.up();
  await pause();
  const title = await undoTitle();
  await page.keyboard.press('Control+z');
  assert.notEqual(await undoTitle(), title);
  await page.keyboard.press('Control+y');
  while ((await undoTitle()) !== before[0]) await page.keyboard.press('Control+z');
  assert.deepEqual(await state(), before[1]);

  // One of a layer that is removed by a key meanwhile.
  await page.mouse.move(slider.x + 0.9 * slider.width, slider.y + slider.height / 2);
  await page.mouse.down();
  await page.mouse.move(slider.x + 0.3 * slider.width, slider.y + slider.height / 2, { steps: 3 });
  await page.keyboard.press('Control+z');
  await control('button', 'Remove red.png').evaluate((button: HTMLButtonElement) => button.click());
  await page.mouse.up();
  assert.ok(!(await names(page)).includes('red.png'));
  await page.keyboard.press('Control+z');
  assert.deepEqual([await undoTitle(), await state()], before);
  assert.deepEqual(complaints, []);
});

test('undo does not affect the paint of a model opened since', async () => {
  const { page } = visit;
  await page.getByRole('radio', { name: 'Tiger stripes' }).check({ force: true });
  await ready(page);
  assert.match(await undoTitle(), /choosing Tiger stripes/);
  await control('button', 'Reorder red.png').focus();
  const before = await names(page);
  await page.keyboard.press('ArrowDown');
  const after = await names(page);
  assert.notDeepEqual(after, before);
  await page.getByTestId('sample-select').selectOption('human');
  await ready(page);
  await page.locator('#undo[title*="replacing "]').waitFor({ state: 'attached' }); // once the work is stored
  await page.keyboard.press('Control+z');
  await page.getByTestId('layer-list').getByText('Tiger stripes').first().waitFor();
  await ready(page);
  assert.deepEqual(await names(page), after);
  assert.match(await undoTitle(), /^Undo$/, 'as after a reload');
});

test('undoing the stroke that created a layer removes it, and so does cancelling', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 900, height: 600 }, hasTouch: true });
  visit = { page, complaints, foreign: [] };
  const area = await modelArea(page);
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  const before = await state();
  const [x, y] = [area.x + 0.45 * area.width, area.y + 0.4 * area.height];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 20, y + 10, { steps: 3 });
  assert.deepEqual(await names(page), ['Painting 1', 'Tiger stripes']);
  await page.mouse.up();
  const after = await state();
  await page.keyboard.press('Control+z');
  assert.deepEqual(await state(), before);
  await page.keyboard.press('Control+y');
  assert.deepEqual(await state(), after);
  await page.keyboard.press('Control+z');

  // A second finger turns the model: what the first had begun is not meant.
  const session = await page.context().newCDPSession(page);
  const touch = (
    type: 'touchStart' | 'touchMove' | 'touchEnd',
    ...touchPoints: { x: number; y: number; id: number }[]
  ): Promise<unknown> => session.send('Input.dispatchTouchEvent', { type, touchPoints });
  await touch('touchStart', { x, y, id: 0 });
  await touch('touchMove', { x: x + 10, y, id: 0 });
  assert.equal((await names(page)).length, 2);
  await touch('touchStart', { x: x + 10, y, id: 0 }, { x: x + 60, y, id: 1 });
  await touch('touchEnd');
  assert.deepEqual(await state(), before);
  assert.deepEqual(complaints, []);
});
