// Words of other languages are longer, or of other letters: what is on the stage and in the panel has room for them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { stageFaults } from '../../../support/page/stage-faults';
import { kLanguages } from '../../../support/page/words';
import { kPlay, openSite } from '../../../support/site';

const site = await openSite();

const kSizes = [
  [390, 844],
  [844, 390],
  [1440, 900],
] as const;

/** Controls of the panel whose text is cut off or that stick out, and whether the page scrolls sideways. */
async function panelFaults(page: Page): Promise<string[]> {
  await page.locator('details').evaluateAll((all) => all.forEach((details) => details.setAttribute('open', '')));
  const found: string[] = [];
  for (const [width, height] of kSizes) {
    await page.setViewportSize({ width, height });
    const faults = await page.evaluate(() => {
      const faults = document.documentElement.scrollWidth > innerWidth ? ['the page scrolls sideways'] : [];
      for (const control of document.querySelectorAll<HTMLElement>(
        '.panel :is(button, summary, h2, h3, p, label, .segmented span, a, dt, th)',
      )) {
        if (!control.checkVisibility() || control.closest('.unseen, .paints, .layers')) continue;
        const { left, right } = control.getBoundingClientRect();
        const name = control.id || control.textContent!.trim();
        const isScrolled = control.closest('.section-nav, .scroll, .frames') !== null;
        if (!isScrolled && (left < -0.5 || right > innerWidth + 0.5)) faults.push(`${name} sticks out`);
        if (!isScrolled && control.scrollWidth > control.clientWidth + 1 && control.clientWidth > 0)
          if (getComputedStyle(control).display !== 'inline') faults.push(`${name} is cut off`);
      }
      return faults;
    });
    found.push(...faults.map((fault) => `${width} × ${height}: ${fault}`));
  }
  return found;
}

for (const language of kLanguages) {
  test(`${language}: in Play, nothing on the stage or in the panel is covered or cut off`, async () => {
    const { page } = await site.visit({ hasTouch: true, locale: language }, kPlay);
    await page.locator(`html[lang=${language}]`).waitFor();
    await page.getByTestId('stage-verdict').waitFor();
    assert.deepEqual(await stageFaults(page), []);
    await page.locator('#tools input[data-key=b]').check({ force: true });
    assert.deepEqual(await stageFaults(page), [], 'while one paints');
    await page.locator('#section-nav a').filter({ visible: true }).first().click();
    assert.deepEqual(await stageFaults(page), [], 'with the sheet');
    assert.deepEqual(await panelFaults(page), []);
  });

  test(`${language}: in Inspect, too`, async () => {
    const { page } = await site.visit({ hasTouch: true, locale: language });
    await page.locator(`html[lang=${language}]`).waitFor();
    await page.getByTestId('stage-verdict').waitFor();
    assert.deepEqual(await stageFaults(page), []);
    await page.locator('#tools input[data-key=b]').check({ force: true });
    assert.deepEqual(await stageFaults(page), [], 'while one paints');
    assert.deepEqual(await panelFaults(page), []);
  });
}
