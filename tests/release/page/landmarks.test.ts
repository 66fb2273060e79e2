import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { faults } from '../../support/axe';
import {
  asset,
  drag,
  fitted,
  head,
  heldBack,
  holdingBack,
  placeOf,
  savedCage,
  worked,
  workedFor,
} from '../../support/cages';
import { difference, look, modelArea } from '../../support/picture';
import { drop, glb, openSite, ready, type Visit } from '../../support/site';

const site = await openSite();

test('after a fit, landmarks can be dragged and moved by keys, in pairs; the fit follows, and the cage is saved with them', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head()]);
  await ready(page);
  assert.ok(
    await page.locator('[data-landmark=nose_tip]').isHidden(),
    'they are out of the way until they are asked for',
  );
  await fitted(page);
  const found = await savedCage(page);
  assert.deepEqual(await faults(page), []);

  await page.locator('#view-mode input[value=distance]').check({ force: true });
  const area = await modelArea(page);
  const picture = await look(page, area);
  const [left, right] = [await placeOf(page, 'mouth_corner_left'), await placeOf(page, 'mouth_corner_right')];
  await drag(page, 'mouth_corner_left', 0, 12);
  await ready(page);
  const label = (name: string) => page.locator(`[data-landmark=${name}]`).getAttribute('aria-label');
  const lower = await placeOf(page, 'mouth_corner_left');
  assert.ok(Math.abs(lower.y - left.y - 12) < 4, `it stays where it was dropped: from ${left.y} to ${lower.y}`);
  assert.ok((await placeOf(page, 'mouth_corner_right')).y > right.y + 8, 'as does the other of the pair');
  assert.deepEqual(await Promise.all(['mouth_corner_left', 'mouth_corner_right', 'nose_tip'].map(label)), [
    'left mouth corner, placed by you',
    'right mouth corner, placed by you',
    'nose tip, found',
  ]);
  assert.ok(difference(picture, await look(page, area)) > 0.001, 'the cage has changed');
  const moved = await savedCage(page);
  assert.notDeepEqual(moved.landmarks.mouth_corner_right, found.landmarks.mouth_corner_right);

  // One step back, the pair and the fit are as they were found; and one step on as they were moved.
  assert.equal(await page.getByTestId('undo').getAttribute('title'), 'Undo: moving the left mouth corner');
  await workedFor(page, () => page.keyboard.press('Control+z'));
  assert.deepEqual(await savedCage(page), found);
  assert.equal(await label('mouth_corner_left'), 'left mouth corner, found');
  await workedFor(page, () => page.keyboard.press('Control+Shift+z'));
  assert.deepEqual(await savedCage(page), moved);

  // By the keyboard, and without the other of the pair; what was not found is asked for.
  await page.locator('#landmark-mirror').uncheck();
  await page.getByRole('button', { name: 'Left', exact: true }).click();
  // At once: what is pressed later is a step of its own.
  await page.locator('[data-landmark=mouth_corner_left]').evaluate((dot: HTMLElement) => {
    dot.focus();
    const press = { key: 'ArrowUp', bubbles: true, cancelable: true };
    for (let i = 0; i < 2; i++) dot.dispatchEvent(new KeyboardEvent('keydown', press));
  });
  await worked(page);
  await page.locator('#landmark-place').click();
  assert.match((await page.getByTestId('landmark-ask').textContent())!, /^Click on the model: nape\./);
  const [ask, ...others] = await Promise.all(
    ['#landmark-ask', '#shortcuts', '.stage-head'].map(async (what) => (await page.locator(what).boundingBox())!),
  );
  for (const { x, y, width, height } of others)
    assert.ok(x + width <= ask!.x || x >= ask!.x + ask!.width || y + height <= ask!.y, 'it can be read');
  assert.deepEqual(await faults(page), []);
  const [ear, back, jaw] = [
    await placeOf(page, 'ear_lobe_left'),
    await placeOf(page, 'occiput'),
    await placeOf(page, 'menton'),
  ];
  await page.mouse.click(ear.x + 0.4 * (back.x - ear.x), jaw.y);
  assert.ok(await page.getByTestId('landmark-ask').isHidden());
  await ready(page);
  const last = await savedCage(page);
  assert.ok(last.landmarks.nape);
  assert.notDeepEqual(last.landmarks.mouth_corner_left, moved.landmarks.mouth_corner_left);
  assert.deepEqual(last.landmarks.mouth_corner_right, moved.landmarks.mouth_corner_right);
  await page.locator('#landmark-reset').click();
  await worked(page);
  assert.deepEqual(await savedCage(page), found);
  const undo = page.getByTestId('undo');
  for (const name of ['forgetting your landmarks', 'placing the nape', 'moving the left mouth corner']) {
    assert.equal(await undo.getAttribute('title'), `Undo: ${name}`);
    await workedFor(page, () => page.keyboard.press('Control+z'));
  }
  assert.deepEqual(await savedCage(page), moved, 'keys in quick succession are one step');
  await page.locator('#tools input[data-key=t]').check({ force: true });
  assert.ok(await page.locator('#landmark-spots').isHidden());
  assert.deepEqual(complaints, []);
});

test('with the keyboard alone: a model is opened, a template fitted, a landmark moved, and the model saved', async () => {
  const { page, complaints } = await site.visit();
  /** Goes on with the Tab key. */
  const tabTo = async (selector: string): Promise<void> => {
    for (let i = 0; i < 150; i++) {
      if (await page.evaluate((wanted) => document.activeElement!.matches(wanted), selector)) return;
      await page.keyboard.press('Tab');
    }
    assert.fail(`${selector} is not reached by Tab`);
  };
  await tabTo('#target-input');
  // The dialog that follows is the browser's own.
  await page.getByTestId('target-input').setInputFiles([head()]);
  await page.locator('#target-name', { hasText: 'bust.glb' }).waitFor();
  await ready(page);
  await tabTo('#fit-cage');
  await page.keyboard.press('Enter');
  await page.locator('[data-landmark=nose_tip]').waitFor({ state: 'attached' });
  await ready(page);
  await tabTo('[data-landmark=nose_tip]');
  await page.keyboard.press('ArrowDown');
  await worked(page);
  assert.ok(
    await page.evaluate(() => document.activeElement!.matches('[data-landmark=nose_tip]')),
    'it keeps the focus when the fit has followed',
  );
  await tabTo('#stage-share');
  await page.keyboard.press('Enter');
  await tabTo('#export-glb');
  const [download] = await Promise.all([page.waitForEvent('download'), page.keyboard.press('Enter')]);
  assert.equal(download.suggestedFilename(), 'bust-painted.glb');
  assert.deepEqual(complaints, []);
});

test('an avatar’s landmarks are out of reach for undo and redo once another one is on the stage', async () => {
  const { page, complaints } = await site.visit();
  const names = ['one', 'two', 'three'];
  await drop(
    page,
    names.map((name) => glb(`${name}.glb`, asset('human', 'target.glb'))),
  );
  const cards = page.locator('.avatars .avatar');
  await cards.nth(2).waitFor();
  await page.waitForFunction(
    () => !/Reading|Fitting|Waiting|Being painted/.test(document.querySelector('.avatars')!.textContent!),
    undefined,
    { timeout: 60_000 },
  );
  await ready(page);
  const go = async (name: string) => {
    await cards.nth(names.indexOf(name)).click();
    await page.locator('#target-name', { hasText: name }).waitFor();
    await ready(page);
  };
  const move = async (landmark: string) => {
    await page.locator('#landmark-show').click();
    await workedFor(page, () => page.locator(`[data-landmark=${landmark}]`).press('ArrowDown'));
  };
  await go('two');
  await move('menton');
  const two = await savedCage(page);
  await go('one');
  await move('nose_tip');
  await go('two');
  const title = () => page.getByTestId('undo').getAttribute('title');
  await page.waitForFunction(() => !/moving/.test(document.querySelector<HTMLElement>('#undo')!.title));
  for (const keys of ['Control+z', 'Control+z', 'Control+Shift+z', 'Control+Shift+z']) {
    await page.keyboard.press(keys);
    await ready(page);
    assert.doesNotMatch((await title())!, /moving/);
  }
  assert.deepEqual(await savedCage(page), two);
  assert.deepEqual(complaints, []);
});

test('keys that leave a dot for another tool leave the focus on the stage, where more of them are heard', async () => {
  const { page, complaints } = await site.visit();
  await drop(page, [head()]);
  await ready(page);
  await fitted(page);
  const dot = page.locator('[data-landmark=nose_tip]');
  const focus = () => page.evaluate(() => document.activeElement!.id);
  await dot.press('Escape');
  assert.equal(await focus(), 'view');
  await page.keyboard.press('l');
  await dot.press('b');
  await page.keyboard.press('e');
  assert.ok(await page.locator('#tools input[data-key=e]').isChecked(), 'the eraser is chosen');
  assert.equal(await focus(), 'view');

  await page.getByTestId('adjust-cage').click();
  await page.locator('[data-handle=x]').press('Escape');
  assert.equal(await focus(), 'view');
  assert.deepEqual(complaints, []);
});

/** A head to which a template was fitted; while `window.holds` is set, further fits are held back. */
async function fittedHead(): Promise<Visit> {
  const visit = await site.visit({}, holdingBack('fitCage'));
  const { page } = visit;
  await page.evaluate('window.holds = false');
  await drop(page, [head()]);
  await ready(page);
  await fitted(page);
  return visit;
}

test('a landmark that is being dragged when an earlier fit comes is not lost', async () => {
  const { page, complaints } = await fittedHead();
  const found = await savedCage(page);
  await page.evaluate('window.holds = true');
  await drag(page, 'nose_tip', 0, 8);
  await heldBack(page);
  const { x, y } = await placeOf(page, 'mouth_corner_left');
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x, y + 6);
  await page.mouse.move(x, y + 12);
  await workedFor(page, () => page.evaluate('window.letGo()') as Promise<void>);
  const stays = await placeOf(page, 'mouth_corner_left');
  assert.ok(Math.abs(stays.y - y - 12) < 4, `it is where it was dragged: from ${y} to ${stays.y}`);
  await workedFor(page, () => page.mouse.up());
  const { landmarks } = await savedCage(page);
  for (const name of ['nose_tip', 'mouth_corner_left', 'mouth_corner_right'])
    assert.notDeepEqual(landmarks[name], found.landmarks[name], name);
  assert.deepEqual(complaints, []);
});

/** Puts fingers on the stage, moves and lifts them. */
const finger = (page: Page, type: 'down' | 'move' | 'up', pointerId: number, at: { x: number; y: number }) =>
  page.locator('#view').evaluate(
    (view, { type, pointerId, at }) => {
      view.setPointerCapture = () => {}; // there is no such pointer
      const place = { clientX: at.x, clientY: at.y, buttons: type === 'up' ? 0 : 1 };
      view.dispatchEvent(
        new PointerEvent(`pointer${type}`, { ...place, pointerId, pointerType: 'touch', bubbles: true }),
      );
    },
    { type, pointerId, at },
  );

test('a second finger or Escape ends the drag of a landmark: all is as before it, with a fit that came meanwhile', async () => {
  const { page, complaints } = await fittedHead();
  const count = () => page.locator('#landmark-count').textContent();
  const label = () => page.locator('[data-landmark=mouth_corner_left]').getAttribute('aria-label');
  const begin = async () => {
    const { x, y } = await placeOf(page, 'mouth_corner_left');
    await finger(page, 'down', 1, { x, y });
    await finger(page, 'move', 1, { x, y: y + 12 });
    assert.equal(await label(), 'left mouth corner, placed by you');
    return { x, y };
  };
  const cancel = async ({ x, y }: { x: number; y: number }) => {
    await finger(page, 'down', 2, { x: x + 100, y });
    for (const id of [2, 1]) await finger(page, 'up', id, { x, y });
    assert.equal(await label(), 'left mouth corner, found');
    assert.ok(Math.abs((await placeOf(page, 'mouth_corner_left')).y - y) < 2, 'it is back');
  };
  const found = await count();
  await cancel(await begin());
  assert.equal(await count(), found);
  const { x, y } = await begin();
  await page.locator('#view').press('Escape');
  await finger(page, 'up', 1, { x, y: y + 12 });
  assert.equal(await count(), found);
  assert.ok(await page.getByTestId('undo').isDisabled(), 'nothing was done');
  await page.keyboard.press('l');

  await page.evaluate('window.holds = true');
  await drag(page, 'nose_tip', 0, 8);
  await heldBack(page);
  const moved = await count();
  const place = await begin();
  await workedFor(page, () => page.evaluate('window.letGo()') as Promise<void>);
  await cancel(place);
  assert.equal(await count(), moved);
  // The step has that fit: no other is made.
  const cage = await savedCage(page);
  await page.evaluate('window.holds = true');
  for (const keys of ['Control+z', 'Control+Shift+z']) await workedFor(page, () => page.keyboard.press(keys));
  assert.deepEqual(await savedCage(page), cage);
  assert.deepEqual(complaints, []);
});
