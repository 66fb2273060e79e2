import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import type { Page } from 'playwright-core';
import { reportedCounts } from '../../support/command';
import { ball, islandCage, islandPaint } from '../../support/models';
import { difference, look, modelArea, shareOfHue } from '../../support/picture';
import {
  drop,
  inRepository,
  Site,
  setThreshold,
  settled,
  shownCounts,
  shownError,
  type Upload,
  type Visit,
} from '../../support/site';

const kViolet = 295; // between the islands of the paint
const kBlue = 237; // the ball that is painted
const kGreen = 140; // the islands

let site: Site;
let visit: Visit;
before(async () => {
  // Pixels at edges count here.
  site = await Site.open('real');
  visit = await site.visit();
});
after(() => site?.close());

async function choosePreset(page: Page, preset: 'default' | 'paper'): Promise<void> {
  await page.getByTestId('preset').selectOption(preset);
  assert.equal(await settled(page), 'ready', await shownError(page));
}

const chooseMode = (page: Page, value: string): Promise<void> =>
  page.locator(`input[value=${value}]`).check({ force: true });

/** Opens the ball in its cage, painted with islands. */
async function open(target: Upload): Promise<Visit> {
  const { page } = visit;
  await drop(page, [target, await islandCage(1), islandPaint()]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  return visit;
}

test('the preset starts as default; paper has other counts and fewer steps, and switching back restores both', async () => {
  const { page, complaints } = visit;
  const preset = page.getByTestId('preset');
  assert.equal(await preset.inputValue(), 'default');
  const steps = (): Promise<string[]> => page.locator('#timings dt').allTextContents();
  await chooseMode(page, 'result');
  const area = await modelArea(page);
  const [counts, picture] = [await shownCounts(page), await look(page, area)];
  assert.ok((await steps()).includes('seams'), 'default mends seams');

  await choosePreset(page, 'paper');
  assert.notDeepEqual(await shownCounts(page), counts);
  assert.deepEqual(await steps(), ['weld', 'build', 'project', 'occluded', 'covered', 'segments', 'classify']);
  assert.ok(difference(picture, await look(page, area)) > 0.001, 'the picture follows');

  await choosePreset(page, 'default');
  assert.deepEqual(await shownCounts(page), counts);
  assert.ok(difference(picture, await look(page, area)) < 0.0005, 'and back');
  await chooseMode(page, 'compare');
  assert.deepEqual(complaints, []);
});

test('with the default preset the threshold acts at once, as a new transfer would', async () => {
  const { page } = visit;
  const file = (name: string): string => inRepository('examples/samples/lizard', `${name}.glb`);
  for (const threshold of [0, 0.9, 1]) {
    await setThreshold(page, threshold);
    assert.deepEqual(
      await shownCounts(page),
      await reportedCounts(file('target'), file('cage'), { threshold, preset: 'default' }),
    );
    assert.equal(await page.getByTestId('status').textContent(), 'ready');
  }
  await setThreshold(page, 0.5);
});

for (const [name, options] of Object.entries({
  still: {},
  mirrored: { mirrored: true },
  'skinned and morphed': { pose: true },
})) {
  test(`${name}: no triangle stretches across UV charts, and the paint lies on the surface`, async () => {
    const { page, complaints } = await open(await ball(options));
    const area = await modelArea(page);
    const shares = async (): Promise<{ violet: number; blue: number; green: number }> => {
      const picture = await look(page, area);
      return {
        violet: shareOfHue(picture, kViolet),
        blue: shareOfHue(picture, kBlue),
        green: shareOfHue(picture, kGreen),
      };
    };
    await chooseMode(page, 'result');
    await page.locator('#show-paint').setChecked(false, { force: true });
    const bare = await shares();
    assert.ok(bare.blue > 0.1, `the ball fills ${bare.blue}`);
    await page.locator('#show-paint').setChecked(true, { force: true });

    const painted = await shares();
    assert.ok(painted.violet < 0.0005, `${painted.violet} of the picture is smeared`);
    assert.ok(painted.green > 0.85 * bare.blue, `${painted.green} of the picture is painted`);
    assert.ok(painted.blue < 0.01 * bare.blue, `${painted.blue} of the picture shows through`);

    await chooseMode(page, 'naive');
    const naive = await shares();
    assert.ok(naive.violet > 0.01, `naive smears ${naive.violet}`);
    assert.ok(naive.blue < 0.01 * bare.blue, `${naive.blue} of the picture shows through`);

    await chooseMode(page, 'result');
    await choosePreset(page, 'paper');
    assert.ok((await shares()).violet > 0.01, 'so does paper, whose UVs are per vertex');
    await choosePreset(page, 'default');
    await chooseMode(page, 'compare');
    assert.deepEqual(complaints, []);
  });
}
