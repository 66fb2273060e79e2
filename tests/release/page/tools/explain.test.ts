import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { type Report, report } from '../../../support/command';
import { type Area, difference, frames, look, modelArea, shareOfHue } from '../../../support/picture';
import { inRepository, openSite, setThreshold } from '../../../support/site';

const site = await openSite();
const visit = await site.visit({ viewport: { width: 960, height: 600 }, deviceScaleFactor: 1 });

const kLizard = (file: string): string => inRepository('examples/samples/lizard', `${file}.glb`);
const bubble = (page: Page): Promise<string> => page.getByTestId('explain-bubble').innerText();
const explanation = (page: Page): Promise<string> => page.getByTestId('explain-text').innerText();
const choose = (page: Page, title: string): Promise<void> =>
  page.getByRole('radio', { name: title, exact: true }).check({ force: true });
const mode = (page: Page, value: string): Promise<void> =>
  page.locator(`#view-mode input[value=${value}]`).check({ force: true });

/** Asks about a spot, and returns what the bubble says; nothing beside the model. */
async function ask(page: Page, x: number, y: number): Promise<string> {
  await page.mouse.click(x, y);
  return (await page.getByTestId('explain-bubble').isVisible()) ? bubble(page) : '';
}

test('the explanation follows the mouse, is pinned by a click, follows the threshold, and ends with Escape without a trace', async () => {
  const { page } = await site.visit({ viewport: { width: 760, height: 500 }, deviceScaleFactor: 1 });
  visit.page = page;
  await mode(page, 'result');
  const area = await modelArea(page);
  const before = await look(page, area);
  await choose(page, 'Explain');
  const eye = await findEye(page, area);
  assert.match(await explanation(page), /Part\s+It belongs to “l-eye”/);
  assert.ok(shareOfHue(await look(page, area), 41) > 0.002, 'its ray is orange');
  assert.ok(difference(before, await look(page, area)) > 0.005, 'the explanation is drawn');

  const told = await bubble(page);
  await page.mouse.move(eye.x - 60, eye.y + 40);
  await frames(page, 5);
  assert.equal(await bubble(page), told, 'another spot under the mouse changes nothing');

  const { segments } = await report(kLizard('target'), kLizard('cage'));
  const facts = segments.find(({ part }: Report['segments'][number]) => part === 'l-eye')!;
  const coverage = Math.round((100 * facts.coveredArea) / facts.exposedArea);
  assert.match(await explanation(page), new RegExp(`F = C / E\\s+${coverage} %, culled`));
  await setThreshold(page, (coverage - 5) / 100);
  assert.match(await explanation(page), new RegExp(`Threshold\\s+${coverage - 5} %`));
  await setThreshold(page, 0.5);

  await page.locator('#view').focus();
  await page.keyboard.press('Escape');
  assert.equal(await page.getByTestId('explain-bubble').isVisible(), false);
  assert.equal(await page.getByRole('radio', { name: 'Turn' }).isChecked(), true);
  assert.ok(difference(before, await look(page, area)) < 0.0005, 'no trace is left');
});

/** Asks about the eye: its row in the table lights it up, and tells where it is. */
async function findEye(page: Page, area: Area): Promise<{ x: number; y: number }> {
  const row = page.getByTestId('segment-table').getByRole('combobox', { name: 'Override for l-eye', exact: true });
  await row.focus();
  const lit = await look(page, area);
  await row.blur();
  const dark = await look(page, area);
  // Some of it shines through the lids.
  const pixels = [...Array(lit.width * lit.height).keys()].filter(
    (i) => Math.abs(lit.data[4 * i]! - dark.data[4 * i]!) > 40,
  );
  for (let i = 0; i < pixels.length; i += Math.ceil(pixels.length / 20)) {
    const at = { x: area.x + (pixels[i]! % lit.width), y: area.y + Math.floor(pixels[i]! / lit.width) };
    await ask(page, at.x, at.y);
    if (/“l-eye”/.test(await explanation(page))) return at;
  }
  throw new Error(`none of ${pixels.length} pixels is on the eye`);
}

test('on a phone a tap explains, and a swipe still turns the model', async () => {
  const { page } = await site.visit({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  await choose(page, 'Explain');
  const area = await modelArea(page);
  await page.touchscreen.tap(area.x + area.width / 2, area.y + area.height / 2);
  assert.match(await bubble(page), /painted/i);
  const told = await bubble(page);
  const before = await look(page, area);
  const session = await page.context().newCDPSession(page);
  const touch = (type: string, x?: number): Promise<unknown> =>
    session.send(
      'Input.dispatchTouchEvent' as never,
      { type, touchPoints: x === undefined ? [] : [{ x, y: area.y + 60 }] } as never,
    );
  await touch('touchStart', 120);
  for (const x of [150, 180, 210]) await touch('touchMove', x);
  await touch('touchEnd');
  assert.ok(difference(before, await look(page, area)) > 0.02, 'it turned');
  assert.equal(await bubble(page), told);
});
