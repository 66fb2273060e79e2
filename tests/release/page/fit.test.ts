import assert from 'node:assert/strict';
import { test } from 'node:test';
import { reportedCounts } from '../../support/command';
import { glbOf, tetrahedron } from '../../support/glb';
import { difference, look, modelArea } from '../../support/picture';
import {
  drop,
  glb,
  inRepository,
  openSite,
  passed,
  ready,
  setThreshold,
  shownCounts,
  shownParts,
} from '../../support/site';

const site = await openSite();
const visit = await site.visit({ viewport: { width: 700, height: 500 } });

const asset = (...names: string[]): string => inRepository('examples/samples', ...names);

/** What the page finds, once it has looked. */
async function found(): Promise<{ verdict: string; findings: { sentence: string; advice: string }[] }> {
  const panel = visit.page.getByTestId('inspect-panel');
  await visit.page.waitForFunction(() => document.querySelector('#fit-verdict')!.textContent !== '');
  const items = await panel
    .locator('li')
    .evaluateAll((all) => all.map((item) => [...item.querySelectorAll('p')].map(({ textContent }) => textContent!)));
  return {
    verdict: (await panel.locator('#fit-verdict').textContent())!,
    findings: items.map(([sentence, advice]) => ({ sentence: sentence!.replace(/\.$/, ''), advice: advice! })),
  };
}

test('a finding highlights its part, and locks it as proposed', async () => {
  const { page } = visit;
  await page.getByTestId('sample-select').selectOption({ index: 0 });
  await page.getByTestId('preset').selectOption('paper');
  await setThreshold(page, 0.36);
  await ready(page);
  const eye = page
    .getByTestId('inspect-panel')
    .locator('li')
    .filter({ hasText: /"l-eye" is not painted, but only just/ });
  await eye.waitFor();
  const area = await modelArea(page);
  await page.mouse.move(5, 5);
  const before = await look(page, area);
  await eye.hover();
  assert.ok(difference(before, await look(page, area)) > 0.002, 'it lights up');
  await page.mouse.move(5, 5);
  assert.ok(difference(before, await look(page, area)) < 0.0005);

  await eye.getByRole('button', { name: 'Keep it' }).click();
  assert.deepEqual(
    await shownCounts(page),
    await reportedCounts(asset('lizard', 'target.glb'), asset('lizard', 'cage.glb'), {
      preset: 'paper',
      threshold: 0.36,
      keep: 'l-eye',
    }),
  );
  assert.equal((await shownParts(page)).find(({ name }) => name === 'l-eye')!.lock, 'keep');
  await eye.waitFor({ state: 'detached' });
  await page.getByTestId('preset').selectOption('default');
  await setThreshold(page, 0.5);
  await ready(page);
});

test('where a part only falls below the threshold, the stage offers to keep it, and not another cage', async () => {
  const { page } = visit;
  await page.getByTestId('sample-select').selectOption('human');
  await ready(page);
  await setThreshold(page, 1);
  const remedy = page.getByTestId('stage-remedy');
  await remedy.waitFor();
  assert.equal(await page.locator('#stage-verdict').getAttribute('data-verdict'), 'unfit');
  assert.equal(await remedy.textContent(), 'Keep “skin”');
  assert.ok(await page.getByRole('button', { name: 'Make a cage' }).isHidden(), 'another cage would not help');
  await remedy.click();
  await remedy.waitFor({ state: 'hidden' });
  await page.locator('#stage-verdict:not([data-verdict=""])').waitFor();
  assert.notEqual(await page.locator('#stage-verdict').getAttribute('data-verdict'), 'unfit');
  assert.ok((await shownCounts(page)).cosmetic > 0, 'the part is painted');
  await setThreshold(page, 0.5);
  await ready(page);
});

test('a large model is inspected on request', async () => {
  const { page } = visit;
  const small = tetrahedron();
  // Most of them without area, which cost no time to draw.
  const indices = Uint16Array.from({ length: 3 * 130_000 }, (_, i) => small.indices[i] ?? 0);
  await drop(page, [
    glb('target.glb', glbOf({ ...small, indices }, 'thing')),
    glb('cage.glb', glbOf(tetrahedron(2), 'thing')),
  ]);
  await ready(page);
  await passed(page, 1500);
  assert.equal(await page.locator('#fit-verdict').textContent(), '');
  await page.getByRole('button', { name: 'Inspect the cage' }).click();
  assert.match((await found()).verdict, /^(good|usable|unfit)$/);
});
