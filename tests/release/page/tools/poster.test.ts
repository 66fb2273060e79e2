import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { difference, modelArea, shareOfHue } from '../../../support/picture';
import { kPlay, openSite } from '../../../support/site';

const site = await openSite('real');

const kScript = /\/index-[^/]*\.js$/;
const kOrange = 24;

/** The picture alone, without what lies on it. */
async function picture(page: Page): Promise<PNG> {
  await page.addStyleTag({ content: '#stage > :not(#view, #poster), .dock > * { opacity: 0 }' });
  return PNG.sync.read(await page.screenshot({ clip: await modelArea(page) }));
}

/** A picture with a pixel for each 8 × 8: how sharp it is, and half a pixel to the side, no longer matter. */
function coarse({ width, height, data }: PNG): PNG {
  const small = new PNG({ width: width >> 3, height: height >> 3 });
  const at = (x: number, y: number, channel: number): number => data[4 * (y * width + x) + channel]!;
  for (let y = 0; y < small.height; y++) {
    for (let x = 0; x < small.width; x++) {
      for (let channel = 0; channel < 4; channel++) {
        let sum = 0;
        for (let i = 0; i < 64; i++) sum += at(8 * x + (i & 7), 8 * y + (i >> 3), channel);
        small.data[4 * (y * small.width + x) + channel] = sum / 64;
      }
    }
  }
  return small;
}

/** Holds back what is asked for from an address, until it is let go. */
async function hold(page: Page, address: RegExp): Promise<() => void> {
  let letGo = (): void => {};
  const gate = new Promise<void>((done) => (letGo = done));
  await page.route(address, async (route) => {
    await gate;
    await route.continue();
  });
  return letGo;
}

for (const [screen, viewport] of [
  ['a desk', { width: 1440, height: 900 }],
  ['a phone', { width: 390, height: 844 }],
] as const) {
  test(`before any script runs, the poster image matches the first frame on ${screen}`, async () => {
    let early: PNG | undefined;
    const { page, complaints } = await site.visit({ viewport, deviceScaleFactor: 1 }, async (page) => {
      await page.addInitScript({ content: kPlay });
      const letGo = await hold(page, kScript);
      void page
        .waitForFunction(() => document.querySelector<HTMLImageElement>('#poster')?.complete)
        .then(async () => (early = await picture(page)))
        .finally(letGo);
    });
    await page.locator('#poster').waitFor({ state: 'detached' });
    const drawn = await picture(page);
    assert.ok(early && shareOfHue(early, kOrange) > 0.05, 'a painted lizard');
    const apart = difference(coarse(early), coarse(drawn));
    assert.ok(apart < 0.01, `${(100 * apart).toFixed(1)} % of the picture is another`);
    assert.deepEqual(complaints, []);
  });
}

test('the poster image fades out, or disappears at once with reduced motion', async () => {
  for (const [reducedMotion, fades] of [
    ['no-preference', 1],
    ['reduce', 0],
  ] as const) {
    const { page } = await site.visit(
      { reducedMotion },
      `globalThis.fades = 0
    Element.prototype.animate = new Proxy(Element.prototype.animate, {
      apply: (original, element, args) => ((globalThis.fades += element.id === 'poster' ? 1 : 0), Reflect.apply(original, element, args)),
    })`,
    );
    await page.locator('#poster').waitFor({ state: 'detached' });
    assert.equal(await page.evaluate('fades'), fades, reducedMotion);
  }
});

test('a link to another sample does not show the poster image of the first', async () => {
  let seen: number | undefined;
  await site.visit(
    {},
    async (page) => {
      const letGo = await hold(page, /\/samples\/.*\.glb$/);
      void page
        .waitForFunction(() => document.querySelector('[data-testid=status]')?.textContent === 'working')
        .then(async () => (seen = await page.locator('#poster').count()))
        .finally(letGo);
    },
    '#sample=car',
  );
  assert.equal(seen, 0);
});
