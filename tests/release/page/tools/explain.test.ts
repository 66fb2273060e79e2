import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import type { PNG } from 'pngjs';
import { type Report, report } from '../../../support/command';
import { glbOf, tetrahedron } from '../../../support/glb';
import { ball, islandCage } from '../../../support/models';
import { type Area, difference, frames, look, modelArea, shareOfHue } from '../../../support/picture';
import {
  drop,
  glb,
  inRepository,
  Site,
  setThreshold,
  settled,
  shownError,
  type Upload,
  type Visit,
  violetPaint,
} from '../../../support/site';

let site: Site;
let visit: Visit;
before(async () => {
  site = await Site.open();
  visit = await site.visit({ viewport: { width: 960, height: 600 }, deviceScaleFactor: 1 });
});
after(() => site?.close());

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

test('the explanation of a spot agrees with the view', async () => {
  const { page, complaints } = visit;
  const area = await modelArea(page);
  await page.getByTestId('texture-input').setInputFiles(violetPaint());
  assert.equal(await settled(page), 'ready', await shownError(page));
  await mode(page, 'zones');
  const zones = await look(page, area);
  await mode(page, 'result');
  const result = await look(page, area);

  await choose(page, 'Explain');
  const seen = new Set<string>();
  for (let row = 1; row < 9; row += 2) {
    for (let column = 3; column < 9; column++) {
      const [x, y] = [Math.round((area.width * column) / 10), Math.round((area.height * row) / 10)];
      const told = await ask(page, area.x + x, area.y + y);
      const verdict = /^(Painted|Not painted: (\w+))/.exec(told)?.[0] ?? 'nothing';
      seen.add(verdict);
      const at = (picture: PNG): number[] => [...picture.data.subarray(4 * (y * picture.width + x)).subarray(0, 3)];
      const [red, green, blue] = at(result) as [number, number, number];
      const where = `${told} at ${x}, ${y}: ${at(result)}`;
      assert.equal(verdict === 'Painted', red > green + 60 && blue > green + 60, where);
      const [r, , b] = at(zones) as [number, number, number];
      if (verdict === 'Not painted: occluded') assert.ok(b > r + 80, `blue: ${where}`);
      if (verdict === 'Not painted: uncovered') assert.ok(r > b + 80, `orange: ${where}`);
    }
  }
  for (const verdict of ['Not painted: occluded', 'Painted', 'nothing']) assert.ok(seen.has(verdict), [...seen].join());
  assert.deepEqual(complaints, []);
});

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
  await page.locator('#parts summary').click();
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

test('keyboard: X chooses the tool, Enter explains the centre, and screen readers get the whole text', async () => {
  const { page } = visit;
  await drop(page, [await ball(), await islandCage(1)]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.locator('#view').focus();
  await page.keyboard.press('x');
  assert.equal(await page.getByRole('radio', { name: 'Explain' }).isChecked(), true);
  assert.equal(await page.locator('.crosshair').isVisible(), true);
  await page.keyboard.press('Enter');
  assert.match(await bubble(page), /^Painted/);
  assert.match(await explanation(page), /meets the cage after \d.* %, with nothing of the model before it/);
  await page.waitForFunction(() => /^Painted: .*meets the cage/.test(document.querySelector('#summary')!.textContent!));
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Enter');
  assert.match(await bubble(page), /^Painted/);
});

test('a pinned explanation follows the model as it moves', async () => {
  const { page } = visit;
  await page.getByRole('button', { name: 'Explain the centre' }).click();
  const still = await explanation(page);
  const inflate = async (amount: string): Promise<void> => {
    await page.locator('#deform').selectOption('inflate');
    await page.getByTestId('amount').fill(amount);
    await page.waitForFunction(
      (amount) =>
        document.querySelector<HTMLOutputElement>('#amount-value')!.value === amount &&
        document.querySelector('#live')!.ariaBusy === 'false',
      Number(amount).toFixed(2),
    );
  };
  await inflate('-0.8');
  const away = (told: string): number => Number.parseFloat(/, (\S+) % of the model’s diagonal away/.exec(told)![1]!);
  assert.ok(
    away(await explanation(page)) > away(still) + 1,
    `${away(still)} % away, then ${away(await explanation(page))} %`,
  );
  await inflate('0');
  assert.equal(await explanation(page), still);
});

for (const [name, options] of Object.entries({ mirrored: { mirrored: true }, 'skinned and morphed': { pose: true } })) {
  test(`${name}: the visible surface is explained, not what lies behind it`, async () => {
    const { page } = visit;
    const nearest = async (target: Upload): Promise<string> => {
      await drop(page, [target, await islandCage(1)]);
      assert.equal(await settled(page), 'ready', await shownError(page));
      await page.getByRole('button', { name: 'Explain the centre' }).click();
      return /triangle is number \d+,/.exec(await explanation(page))![0];
    };
    // The side of the cage that faces the viewer is the fifth; each side is of two triangles.
    assert.match(await nearest(await ball(options)), /triangle is number (8|9),/);
  });
}

test('each reason for being painted or not has its own text', async () => {
  const { page } = visit;
  const open = async (size: number): Promise<string> => {
    await drop(page, [
      glb('thing.glb', glbOf(tetrahedron(size), 'thing')),
      glb('cage.glb', glbOf(tetrahedron(2), 'thing')),
    ]);
    assert.equal(await settled(page), 'ready', await shownError(page));
    await page.getByRole('button', { name: 'Explain the centre' }).click();
    return `${await bubble(page)} ${await explanation(page)}`;
  };
  assert.match(await open(1), /Painted.*the cage covers it, and nothing of the model lies between/s);
  assert.match(await open(4), /Not painted: uncovered.*it lies outside the cage/s);
  assert.match(await open(2.002), /Painted.*pokes out of the cage a little/s);

  await open(1);
  await page
    .getByTestId('segment-table')
    .locator('select')
    .first()
    .evaluate((select: HTMLSelectElement) => {
      select.value = 'exclude';
      select.dispatchEvent(new Event('change'));
    });
  assert.match(await bubble(page), /Not painted: culled\s+you excluded “thing”/);
});

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
