import assert from 'node:assert/strict';
import { test } from 'node:test';
import { faults } from '../../support/axe';
import { image } from '../../support/layers';
import { islandCage, morphingBalls } from '../../support/models';
import { saved } from '../../support/saved';
import { drop, glb, openSite, ready, settled } from '../../support/site';

const site = await openSite();

const kVisits = [
  { name: 'desk, light', viewport: { width: 1440, height: 900 } },
  { name: 'desk, dark', viewport: { width: 1440, height: 900 }, colorScheme: 'dark' },
  { name: 'phone', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
] as const;

for (const { name, ...options } of kVisits) {
  test(`${name}: axe finds no problems in any state of the page`, async () => {
    const { page } = await site.visit(options);
    assert.deepEqual(await faults(page), [], 'as it opens');

    await page.locator('details').evaluateAll((all) => all.forEach((details) => details.setAttribute('open', '')));
    await page.locator('#view-mode input[value=distance]').check({ force: true });
    await page.locator('#view').press('x');
    await page.locator('#view').press('Enter');
    await page.waitForFunction(() => document.querySelector('#fit-verdict')!.textContent !== '');
    assert.deepEqual(await faults(page), [], 'with all cards open, a legend, a story, and a verdict on the cage');

    await page.locator('#view').press('Escape');
    await page.locator('#view-mode input[value=zones]').check({ force: true });
    await page.getByTestId('target-input').setInputFiles(glb('poem.glb', Buffer.from('no model')));
    assert.equal(await settled(page), 'error');
    assert.deepEqual(await faults(page), [], 'with an error');
  });
}

test('axe finds no problems with any tool chosen', async () => {
  const { page } = await site.visit({ viewport: { width: 700, height: 480 } });
  for (const tool of await page.locator('#tools input').all()) {
    await tool.check({ force: true });
    assert.deepEqual(await faults(page), [], `with the tool ${await tool.getAttribute('data-key')}`);
  }
});

test('axe finds no problems with own files: morphs, an animation, layers, notes, and work in progress', async () => {
  const { page } = await site.visit({ viewport: { width: 700, height: 480 }, colorScheme: 'dark' });
  await drop(page, [
    await islandCage(1.1),
    await morphingBalls({ animated: true }),
    image('paint.png', 8, () => [200, 60, 30, 255]),
  ]);
  await ready(page);
  await page.getByTestId('add-painting').click();
  await page.getByTestId('segment-table').locator('tbody select').first().selectOption('exclude');
  await page.getByTestId('amount').fill('0.5');
  await page.locator('#live[aria-busy=false]').waitFor();
  await saved(page, 'export-glb');
  for (const id of ['morphs', 'animation', 'swap', 'pose-note'])
    assert.equal(await page.locator(`#${id}`).isVisible(), true, id);
  assert.deepEqual(await faults(page), []);

  let letGo = (): void => {};
  const gate = new Promise<void>((done) => (letGo = done));
  await page.route(/\/samples\/.*\.glb$/, (route) => gate.then(() => route.continue()));
  await page.getByTestId('sample-select').selectOption('human');
  await page.getByTestId('progress').waitFor();
  assert.deepEqual(await faults(page), [], 'while it works');
  letGo();
  await ready(page);
});

test('axe finds no problems without WebGL', async () => {
  const { page } = await site.visit(
    { viewport: { width: 390, height: 844 } },
    `HTMLCanvasElement.prototype.getContext = new Proxy(HTMLCanvasElement.prototype.getContext, {
    apply: (original, canvas, args) => (String(args[0]).startsWith('webgl') ? null : Reflect.apply(original, canvas, args)),
  })`,
  );
  assert.deepEqual(await faults(page), []);
});
