// While a cage is made or a template fitted, the page must not be blocked for 100 ms.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { lumpyBall } from '../../../tests/support/models';
import { drop, glb, inRepository, Site, settled, shownError } from '../../../tests/support/site';
import { kMaxMs, longestTask } from './processor-time';

const kSide = 160; // 51,200 triangles

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

for (const [title, button, model] of [
  [
    'a cage is made for a head',
    'make-cage',
    async () => readFileSync(inRepository('examples/samples/human/target.glb')),
  ],
  ['a cage is made for 51,200 triangles', 'make-cage', async () => (await lumpyBall(kSide)).buffer],
  ['a template is fitted', 'fit-cage', async () => readFileSync(inRepository('examples/samples/human/target.glb'))],
] as const)
  test(`while ${title}, no task takes 100 ms`, async () => {
    const { page } = await site.visit({ viewport: { width: 800, height: 500 } });
    await drop(page, [glb('model.glb', await model())]);
    assert.equal(await settled(page), 'ready', await shownError(page));
    const work = async (): Promise<void> => {
      await page.getByTestId(button).click();
      assert.equal(await settled(page), 'ready', await shownError(page));
      await page.locator('#cage-note:not(:empty)').waitFor();
    };
    const longest = await longestTask(page, work, async () => {});
    console.log(`${title}: the longest task takes ${longest.toFixed(1)} ms`);
    assert.ok(longest < kMaxMs, `the longest task takes ${longest} ms`);
  });
