import assert from 'node:assert/strict';
import { test } from 'node:test';
import { cageGlb } from 'cagecast/cages';
import type { Page } from 'playwright-core';
import { faults } from '../../../support/axe';
import { glbOf, tetrahedron } from '../../../support/glb';
import { drop, glb, kNoWebGl, openSite, ready, type Upload } from '../../../support/site';

const site = await openSite();

const thing = (name: string, size = 1): Upload => glb(name, glbOf(tetrahedron(size), 'thing'));
const shown = (page: Page, slot: 'target' | 'cage', name: string): Promise<void> =>
  page.locator(`#${slot}-name`, { hasText: name }).waitFor();

test('of two models that come together, neither is taken as the cage of the other: the page asks, and the keyboard answers', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 700, height: 600 } });
  const box = page.getByRole('dialog', { name: 'Open both?' });
  const answers = () => box.getByRole('button').allTextContents();
  await page.locator('#view').focus();
  await drop(page, [thing('a.glb'), thing('b.glb', 2)]);
  await box.waitFor();
  assert.deepEqual(await answers(), ['Wardrobe: one paint on both', 'Only a.glb', 'Only b.glb', '✕']);
  assert.equal(await page.evaluate(() => document.activeElement!.textContent), 'Wardrobe: one paint on both');
  assert.deepEqual(await faults(page), []);
  await page.keyboard.press('Escape');
  assert.ok(await box.isHidden());
  assert.equal(await page.evaluate(() => document.activeElement!.id), 'view');
  await shown(page, 'target', 'target.glb');

  // In the field, too.
  await page.getByTestId('target-input').setInputFiles([thing('a.glb'), thing('b.glb', 2)]);
  await box.waitFor();
  for (const key of ['Tab', 'Tab', 'Enter']) await page.keyboard.press(key);
  await shown(page, 'target', 'b.glb');
  await ready(page);
  await shown(page, 'cage', 'b-cage.glb');

  await drop(page, [thing('a.glb'), thing('c.glb', 2)]);
  await box.waitFor();
  await page.keyboard.press('Enter');
  await page.waitForFunction(() => document.querySelectorAll('.avatars .avatar').length >= 2);
  await page.locator('.avatars .name', { hasText: /^c$/ }).waitFor();
  assert.deepEqual(complaints, []);
});

test('a cage is known by its name, or by what is in it; of two cages, the page asks which is the model', async () => {
  const { page } = await site.visit({ viewport: { width: 700, height: 600 } }, kNoWebGl);
  await drop(page, [thing('a.glb'), thing('a-cage.glb', 2)]);
  await shown(page, 'cage', 'a-cage.glb');
  await ready(page);
  const { indices, ...mesh } = tetrahedron(3);
  const made = cageGlb({ ...mesh, indices: Uint32Array.from(indices) });
  await drop(page, [glb('wrap.glb', Buffer.from(made)), thing('b.glb')]);
  await shown(page, 'cage', 'wrap.glb');
  await shown(page, 'target', 'b.glb');
  await ready(page);
  await drop(page, [thing('cage-1.glb'), thing('cage-2.glb', 2)]);
  const box = page.getByRole('dialog', { name: 'cage-1.glb and cage-2.glb are both cages. Which one is the model?' });
  await box.getByRole('button', { name: 'cage-1.glb' }).click();
  await shown(page, 'target', 'cage-1.glb');
  await shown(page, 'cage', 'cage-2.glb');
  await drop(page, [thing('a.glb'), thing('b.glb')]);
  await page.getByRole('dialog', { name: 'Which one?' }).waitFor(); // there is no wardrobe
});

test('a message that comes while the page asks waits for the answer', async () => {
  // Storage that answers when it is told to.
  const slow = `const stored = new Promise((resolve) => Object.assign(globalThis, { store: resolve }));
    Object.defineProperty(IDBTransaction.prototype, 'oncomplete', {
      set(then) { this.addEventListener('complete', (event) => stored.then(() => then.call(this, event))); },
    });`;
  const { page } = await site.visit({ viewport: { width: 700, height: 600 } }, kNoWebGl + slow);
  for (const name of ['a', 'b']) {
    await drop(page, [thing(`${name}.glb`), thing(`${name}-cage.glb`, 2)]);
    await shown(page, 'target', `${name}.glb`);
    await ready(page);
  }
  await drop(page, [thing('cage-1.glb'), thing('cage-2.glb', 2)]);
  const question = page.getByRole('dialog', { name: /Which one is the model/ });
  await question.waitFor();
  await page.evaluate('store()');
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  await question.getByRole('button', { name: 'Dismiss the message' }).click();
  await page.locator('#ask[role=status]', { hasText: 'Replaced a.' }).waitFor();
});
