import assert from 'node:assert/strict';
import { test } from 'node:test';
import { head } from '../../support/cages';
import { difference, frames, look, modelArea, watch } from '../../support/picture';
import { drop, openSite, ready } from '../../support/site';

const kFrames = 30; // in which whatever moves does

const site = await openSite();
const visit = await site.visit();

test('transfers are timed, once the browser has compiled them, and what was read apart from them', async () => {
  const { page } = visit;
  await page.getByTestId('time-again').click(); // by itself only what is quick
  await page
    .getByTestId('time-note')
    .filter({ hasText: /^The median of 20 transfers .* The fastest took [\d.]+ ms, the slowest [\d.]+ ms/ })
    .waitFor();
  assert.match(await page.locator('#loads').innerText(), /^model\s+[\d.]+\s+cage\s+[\d.]+$/);
  const [total, ...steps] = await page
    .locator('#time-total, #timings td')
    .evaluateAll((shown) => shown.map(({ textContent }) => Number(textContent)));
  assert.ok(steps.reduce((sum, step) => sum + step) <= 1.01 * total!, 'the steps are of the same run');
});

test('the divider moves with the pointer and the keyboard', async () => {
  const { page } = visit;
  const divider = page.getByTestId('compare-slider');
  const value = async (): Promise<number> => Number(await divider.getAttribute('aria-valuenow'));
  assert.equal(await value(), 50);
  await divider.focus();
  await page.keyboard.press('ArrowLeft');
  assert.equal(await value(), 45);
  await page.keyboard.press('End');
  assert.equal(await value(), 100);

  const knob = (await page.locator('.knob').boundingBox())!;
  const stage = (await page.locator('#stage').boundingBox())!;
  await page.keyboard.press('Home');
  await page.keyboard.press('PageUp');
  assert.equal(await value(), 20);
  const from = { x: stage.x + 0.2 * stage.width, y: knob.y + knob.height / 2 };
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(stage.x + 0.7 * stage.width, from.y, { steps: 4 });
  await page.mouse.up();
  assert.ok(Math.abs((await value()) - 70) <= 1, `dragged to ${await value()}`);
});

test('the camera angle stays when the height of the view changes', async () => {
  const { page } = visit;
  const angle = async (): Promise<string[]> => {
    await page.locator('#share-link').focus();
    return /angle=[^&]*/.exec((await page.locator('#share-link').getAttribute('href'))!)![0].match(/-?[\d.]+/g)!;
  };
  const size = page.viewportSize()!;
  await page.locator('#view').focus();
  for (const key of ['ArrowLeft', 'ArrowLeft', 'ArrowUp', '+', '+']) await page.keyboard.press(key);
  await frames(page, 3);
  const before = await angle();
  for (const height of [size.height - 60, size.height]) {
    await page.setViewportSize({ ...size, height });
    await frames(page, 3);
    const now = await angle();
    now.forEach((number, i) =>
      assert.ok(
        Math.abs(Number(number) - Number(before[i])) <= 0.02 * Math.max(1, Math.abs(Number(before[i]))),
        `${now} instead of ${before}`,
      ),
    );
  }
  await page.locator('#view').focus();
  await page.keyboard.press('Home');
});

test('the content security policy forbids other hosts, inline scripts and eval', async () => {
  const { page } = visit;
  const outcome = await page.evaluate(async () => {
    const breaches: string[] = [];
    document.addEventListener('securitypolicyviolation', ({ effectiveDirective }) => breaches.push(effectiveDirective));
    const refused = await fetch('https://example.org/').then(
      () => false,
      () => true,
    );
    const script = document.createElement('script');
    script.textContent = 'globalThis.inlineRan = true';
    document.head.append(script);
    // It is told of both a little later.
    for (const end = performance.now() + 10_000; breaches.length < 2 && performance.now() < end; )
      await new Promise((done) => setTimeout(done));
    return { refused, breaches, ran: 'inlineRan' in globalThis };
  });
  assert.equal(outcome.refused, true);
  assert.equal(outcome.ran, false);
  assert.ok(
    outcome.breaches.includes('connect-src') && outcome.breaches.includes('script-src-elem'),
    outcome.breaches.join(),
  );
  const policy = await page.locator('meta[http-equiv="Content-Security-Policy"]').getAttribute('content');
  assert.match(policy!, /script-src 'self' 'wasm-unsafe-eval';/);
});

test('the model turns by itself until it is touched, but not while a file is read, nor with reduced motion', async () => {
  const moving = await site.visit({ reducedMotion: 'no-preference', viewport: { width: 800, height: 700 } });
  await moving.page.locator('#poster').waitFor({ state: 'detached' });
  const area = await modelArea(moving.page);
  const first = await look(moving.page, area);
  await watch(moving.page, area, (picture) => difference(first, picture) > 0.01);

  let letGo = (): void => {};
  const gate = new Promise<void>((done) => (letGo = done));
  await moving.page.route(/cagecast-cages.*\.wasm/, async (route) => {
    await gate;
    await route.continue();
  });
  await drop(moving.page, [head()]);
  await moving.page.locator('#progress').waitFor();
  const waiting = await look(moving.page, area);
  await frames(moving.page, kFrames);
  assert.ok(difference(waiting, await look(moving.page, area)) < 0.002, 'it leaves the processor to what is read');
  letGo();
  await ready(moving.page);
  const other = await look(moving.page, area);
  await watch(moving.page, area, (picture) => difference(other, picture) > 0.01);
  await moving.page.locator('#view').focus();
  await moving.page.keyboard.press('ArrowUp');
  const touched = await look(moving.page, area);
  await frames(moving.page, kFrames);
  assert.ok(difference(touched, await look(moving.page, area)) < 0.002, 'it stands still once touched');

  const still = await site.visit({ viewport: { width: 800, height: 700 } });
  const before = await look(still.page, area);
  await frames(still.page, kFrames);
  assert.equal(difference(before, await look(still.page, area)), 0);
});
