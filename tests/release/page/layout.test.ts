import assert from 'node:assert/strict';
import { test } from 'node:test';
import { PNG } from 'pngjs';
import { asset, fitted, head } from '../../support/cages';
import { stageFaults } from '../../support/page/stage-faults';
import { difference, look, modelArea } from '../../support/picture';
import { drop, glb, kPlay, openSite, ready, type Visit } from '../../support/site';

const site = await openSite();
let visit = await site.visit({ hasTouch: true });

const kSizes = [
  { name: 'phone', width: 390, height: 844 },
  { name: 'small phone', width: 320, height: 568 },
  { name: 'phone on its side', width: 844, height: 390 },
  { name: 'small phone on its side', width: 568, height: 320 },
  { name: 'desk at 400 %', width: 320, height: 256 },
  { name: 'tablet', width: 768, height: 1024 },
  { name: 'desk', width: 1440, height: 900 },
  { name: 'phone, large text', width: 390, height: 844, text: 24 },
  { name: 'phone, largest text', width: 390, height: 844, text: 32 },
  { name: 'small desk, large text', width: 1000, height: 700, text: 24 },
  { name: 'desk, large text', width: 1440, height: 900, text: 24 },
  { name: 'desk, largest text', width: 1280, height: 800, text: 32 },
];

/** Everything that is pressed or moved; for a box hidden behind its label, the label. */
const kControls =
  'select, button:not([hidden]), .file, .segmented label, .toggle, .paints label, .section-nav a, .rail label, .layer button, .paints button, .eye, .icon, #threshold, .knob, summary, #view';

/** Opens the cards that are closed at first. */
async function openAll({ page }: Visit, open = true): Promise<void> {
  await page
    .locator('details')
    .evaluateAll((all, open) => all.forEach((details) => details.toggleAttribute('open', open)), open);
}

for (const { name, text, ...viewport } of kSizes) {
  test(`${name}: no horizontal overflow, and every control is reachable and large enough`, async () => {
    const { page, complaints } = visit;
    const devTools = await page.context().newCDPSession(page);
    await devTools.send('Page.setFontSizes', { fontSizes: { standard: text ?? 16 } });
    await page.setViewportSize(viewport);
    await openAll(visit);
    assert.equal(
      await page.evaluate(() => parseFloat(getComputedStyle(document.documentElement).fontSize)),
      ((text ?? 16) * 15) / 16,
    );
    assert.equal(await page.evaluate(() => innerWidth), viewport.width);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert.equal(wide, 0, 'no horizontal scroll');
    const faults = await page.evaluate((controls) => {
      const faults: string[] = [];
      for (const control of document.querySelectorAll<HTMLElement>(controls)) {
        if (!control.checkVisibility()) continue;
        control.scrollIntoView({ block: 'center', behavior: 'instant' });
        const { left, right, top, bottom, width, height } = control.getBoundingClientRect();
        const label = control.id || control.textContent!.trim() || control.className;
        if (left < -0.5 || right > innerWidth + 0.5) faults.push(`${label} sticks out: ${left}..${right}`);
        if (Math.min(width, height) < 24) faults.push(`${label} is small: ${width} × ${height}`);
        const hit = document.elementFromPoint(
          (left + right) / 2,
          (Math.max(0, top) + Math.min(innerHeight, bottom)) / 2,
        );
        // The line lies over the middle of the picture, on purpose.
        if (control.id !== 'view' && !control.contains(hit))
          faults.push(`${label} is covered by ${hit?.outerHTML.slice(0, 60)}`);
      }
      return faults;
    }, kControls);
    assert.deepEqual(faults, []);
    assert.deepEqual(complaints, []);
    await devTools.send('Page.setFontSizes', { fontSizes: { standard: 16 } });
    await devTools.detach();
  });
}

test('the Tab key reaches every control, and each has a name', async () => {
  const { page } = visit;
  await page.setViewportSize({ width: 1440, height: 900 });
  await openAll(visit, false);
  await page.evaluate(() => document.body.focus());
  const reached: string[] = [];
  for (let presses = 0; presses < 120; presses++) {
    await page.keyboard.press('Tab');
    const id = await page.evaluate(
      () =>
        document.activeElement!.id ||
        (document.activeElement as HTMLInputElement).name ||
        document.activeElement!.tagName.toLowerCase(),
    );
    if (id === 'body') break;
    reached.push(id);
  }
  const expected = [
    'view',
    'half-left',
    'half-right',
    'divider',
    'view-mode',
    'show-paint',
    'show-cage',
    'summary',
    'preset',
    'threshold',
    'sample-select',
    'target-input',
    'cage-input',
    'texture-input',
    'summary',
    'paint',
    'summary',
  ];
  assert.deepEqual(
    reached.filter((id) => expected.includes(id)),
    expected,
  );
  for (const [role, name] of [
    ['slider', /Compare/],
    ['slider', /Threshold/],
    ['combobox', /Sample/],
    ['combobox', /Preset/],
    ['radio', /Result/],
    ['radio', /Zones/],
    ['checkbox', /Cage/],
    ['radiogroup', /View mode/],
  ] as const) {
    assert.equal(await page.getByRole(role, { name }).count(), 1, `${role} ${name}`);
  }
  for (const label of [/Open a model/, /Open a cage/, /Open a paint/]) {
    assert.ok((await page.getByLabel(label).and(page.locator('input[type=file]')).count()) === 1, String(label));
  }
});

for (const colorScheme of ['light', 'dark'] as const) {
  test(`${colorScheme}: text has a contrast of at least 4.5 to 1`, async () => {
    const { page } = visit;
    await page.emulateMedia({ colorScheme });
    await openAll(visit);
    const faint = await page.evaluate(`(${contrastFaults})()`);
    assert.deepEqual(faint, []);
  });
}

test('on a phone the view stays visible while the panel scrolls', async () => {
  const { page } = visit;
  await page.setViewportSize({ width: 390, height: 844 });
  await page.getByTestId('threshold').scrollIntoViewIfNeeded();
  const stage = (await page.locator('#stage').boundingBox())!;
  assert.ok(stage.y >= 0 && stage.y + stage.height < 844, `the stage is at ${stage.y}`);
  const slider = (await page.getByTestId('threshold').boundingBox())!;
  assert.ok(slider.y >= stage.y + stage.height, 'the slider is below it, not behind');
});

test('a finger turns the model and moves the divider', async () => {
  const { page } = await site.visit({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }, kPlay);
  const area = await modelArea(page);
  const session = await page.context().newCDPSession(page);
  const swipe = async (x: number, y: number, by: number): Promise<void> => {
    const touch = (type: string, at?: number): Promise<unknown> =>
      session.send(
        'Input.dispatchTouchEvent' as never,
        { type, touchPoints: at === undefined ? [] : [{ x: at, y }] } as never,
      );
    await touch('touchStart', x);
    for (let step = 1; step <= 4; step++) await touch('touchMove', x + (by * step) / 4);
    await touch('touchEnd');
  };
  const before = await look(page, area);
  await swipe(area.x + 40, area.y + area.height / 3, 90);
  assert.ok(difference(before, await look(page, area)) > 0.02, 'the model turned');

  const knob = (await page.locator('.knob').boundingBox())!;
  await swipe(knob.x + knob.width / 2, knob.y + knob.height / 2, 100);
  const value = Number(await page.getByTestId('compare-slider').getAttribute('aria-valuenow'));
  assert.ok(Math.abs(value - 100 * (295 / 390)) < 3, `the line is at ${value} %`);
});

// A text, as a function of its own would reach the page with the test compiler's helpers in it.
const contrastFaults = `() => {
  const channels = (color) => {
    const context = new OffscreenCanvas(1, 1).getContext('2d')
    context.fillStyle = color
    context.fillRect(0, 0, 1, 1)
    const [r, g, b, a] = context.getImageData(0, 0, 1, 1).data
    return { rgb: [r, g, b], alpha: a / 255 }
  }
  const luminance = (rgb) => {
    const [r, g, b] = rgb.map((value) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4))
    return 0.2126 * r + 0.7152 * g + 0.0722 * b
  }
  const ground = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const { rgb, alpha } = channels(getComputedStyle(at).backgroundColor)
      if (alpha > 0.7) return rgb
    }
    return [255, 255, 255]
  }
  const faults = []
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT)
  while (walker.nextNode()) {
    const text = walker.currentNode
    const element = text.parentElement
    if (!text.data.trim() || !element.checkVisibility() || element.closest('script, noscript, .unseen, .skip')) continue
    const [dark, light] = [luminance(channels(getComputedStyle(element).color).rgb), luminance(ground(element))].sort((a, b) => a - b)
    const ratio = (light + 0.05) / (dark + 0.05)
    if (ratio < 4.5) faults.push(text.data.trim().slice(0, 40) + ': ' + ratio.toFixed(2))
  }
  return faults
}`;

test('messages on the view are not covered by controls', async () => {
  const { page } = (visit = await site.visit({ hasTouch: true }));
  const covered: string[] = [];
  for (const [width, height] of [
    [667, 375],
    [844, 390],
    [900, 700],
    [1024, 768],
    [1440, 900],
    [390, 844],
    [568, 320],
  ] as const) {
    await page.setViewportSize({ width, height });
    for (const mode of ['Compare', 'Zones']) {
      await page.getByRole('radio', { name: mode, exact: true }).check({ force: true });
      const boxes = (
        selector: string,
      ): Promise<{ name: string; left: number; right: number; top: number; bottom: number }[]> =>
        page.locator(selector).evaluateAll((all) =>
          all
            .filter((one) => one.checkVisibility())
            .map((one) => {
              const { left, right, top, bottom } = one.getBoundingClientRect();
              return { name: one.id || one.className.toString(), left, right, top, bottom };
            }),
        );
      const pressed = await boxes('.toolbar > *, .rail');
      const pairs = (await boxes('.side, .legend')).flatMap((a) =>
        pressed
          .filter((b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)
          .map((b) => `${a.name} by ${b.name}`),
      );
      covered.push(...pairs.map((pair) => `${width} × ${height}, ${mode}: ${pair}`));
    }
  }
  await page.getByRole('radio', { name: 'Compare' }).check({ force: true });
  await page.setViewportSize({ width: 1440, height: 900 });
  assert.deepEqual(covered, []);
});

/** Those with room for a text between the columns of tools. */
const kPhoneSizes = [
  [390, 844],
  [412, 915],
] as const;

test('in Play, nothing that can be pressed on the stage is covered or cut off, with the sheet, too', async () => {
  const { page } = await site.visit({ hasTouch: true }, kPlay);
  await page.getByTestId('stage-verdict').waitFor();
  assert.deepEqual(await stageFaults(page), []);
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  assert.deepEqual(await stageFaults(page), [], 'while one paints');
  await page.locator('#section-nav a').filter({ visible: true }).first().click();
  assert.deepEqual(await stageFaults(page), [], 'with the sheet');
});

test('neither is what plays the clips of a model', async () => {
  const { page } = (visit = await site.visit({ hasTouch: true }, undefined, '#sample=avatar'));
  await page.getByTestId('clips').waitFor();
  await page.getByTestId('stage-verdict').waitFor();
  assert.deepEqual(await stageFaults(page), []);
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  assert.deepEqual(await stageFaults(page), [], 'while one paints');
});

test('on the stage, nothing that can be pressed is covered or cut off', async () => {
  const { page } = (visit = await site.visit({ hasTouch: true }));
  await page.getByTestId('stage-verdict').waitFor();
  assert.deepEqual(await stageFaults(page), []);
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  assert.deepEqual(await stageFaults(page), [], 'while one paints');
  await page.setViewportSize({ width: 390, height: 844 });
  await page.getByRole('radio', { name: 'Result', exact: true }).check({ force: true });
  await page.getByRole('radio', { name: 'Sticker' }).check({ force: true });
  await page.locator('#view').press(' ');
  await page.locator('.sticker-bar').waitFor();
  assert.deepEqual(await stageFaults(page, kPhoneSizes), [], 'with a sticker that is placed');
  await page.locator('#view').press('x');
  await page.locator('#view').press('Enter');
  const bubble = page.getByTestId('explain-bubble');
  for (const [width, height] of kPhoneSizes) {
    await page.setViewportSize({ width, height });
    const [box, stage] = [(await bubble.boundingBox())!, (await page.locator('#stage').boundingBox())!];
    assert.ok(box.x >= 0 && box.x + box.width <= width && box.y >= stage.y, 'it is seen whole');
    assert.ok(box.y + box.height <= stage.y + stage.height && box.height < stage.height / 2, 'beside its spot');
  }
  await bubble.getByRole('button', { name: 'Close' }).click();
  assert.ok(await bubble.isHidden());
  await drop(page, [head(), glb('cage.glb', asset('lizard', 'cage.glb'))]);
  await ready(page);
  await page.getByTestId('stage-remedy').waitFor();
  await page
    .getByTestId('ask')
    .getByRole('button', { name: /^Dismiss/ })
    .click(); // it goes by itself, too
  assert.deepEqual(await stageFaults(page), [], 'with a verdict that offers a remedy');
});

test('above the wardrobe, nothing on the stage is covered or cut off, on low screens too', async () => {
  const { page } = (visit = await site.visit({ hasTouch: true }));
  await page.getByTestId('open-wardrobe').click();
  await page.getByTestId('wardrobe-sample').waitFor();
  assert.deepEqual(await stageFaults(page), []);
  await page.getByTestId('wardrobe-sample').selectOption('human');
  await page.getByTestId('wardrobe-note').waitFor();
  assert.deepEqual(await stageFaults(page), [], 'with a note');
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true });
  assert.deepEqual(await stageFaults(page), [], 'while one paints');
});

test('with forced colours, chosen controls still look chosen', async () => {
  const { page } = visit;
  await page.emulateMedia({ forcedColors: 'active' });
  // As it is drawn: what a style is computed to be knows nothing of those colours.
  const groundOf = async (selector: string): Promise<string> => {
    const { x, y, height } = (await page.locator(selector).first().boundingBox())!;
    const { data } = PNG.sync.read(
      await page.screenshot({ clip: { x: x + 6, y: y + height / 2 - 2, width: 4, height: 4 } }),
    );
    return data.subarray(0, 3).join();
  };
  const grounds: [string, string][] = [];
  for (const group of ['.rail', '.segmented'])
    grounds.push([await groundOf(`${group} :checked + span`), await groundOf(`${group} :not(:checked) + span`)]);
  await page.emulateMedia({ forcedColors: null });
  for (const [chosen, other] of grounds) assert.notEqual(chosen, other);
});

test('the model has the pixels of the screen, also after the page was moved to another one', async () => {
  const { page } = visit;
  const session = await page.context().newCDPSession(page);
  for (const deviceScaleFactor of [1, 0.5]) {
    const screen = { ...page.viewportSize()!, deviceScaleFactor, mobile: false };
    await session.send('Emulation.setDeviceMetricsOverride', screen);
    // Chromium does not evaluate media queries for an emulated screen alone.
    await page.emulateMedia({ colorScheme: deviceScaleFactor === 1 ? 'dark' : 'light' });
    await page.waitForFunction((ratio) => {
      const { width, clientWidth } = document.querySelector<HTMLCanvasElement>('#view')!;
      return Math.abs(width - ratio * clientWidth) <= 1;
    }, deviceScaleFactor);
  }
});

test('with a seventh tool, too, nothing on a low stage is covered or cut off; the template that is fitted can be read', async () => {
  const { page } = (visit = await site.visit({ hasTouch: true, viewport: { width: 1280, height: 800 } }));
  await drop(page, [head()]);
  await ready(page);
  const roomFor = (selector: string) =>
    page.locator(selector).evaluate((select: HTMLSelectElement) => {
      const { width } = select.getBoundingClientRect();
      select.style.width = 'max-content';
      const { width: wanted } = select.getBoundingClientRect();
      select.style.width = '';
      return width - wanted;
    });
  assert.ok((await roomFor('#template-select')) >= 0, 'the template is not cut');
  await fitted(page);
  // What has no room can be scrolled to.
  const overlaps = async (size: [number, number]): Promise<string[]> =>
    (await stageFaults(page, [size])).filter((fault) => /overlaps/.test(fault));
  assert.deepEqual(await overlaps([320, 568]), []);
  await page.setViewportSize({ width: 640, height: 400 });
  await page.getByRole('radio', { name: 'Zones' }).check({ force: true });
  const tops = await page
    .locator('#legend .key')
    .evaluateAll((keys) => keys.map((key) => key.getBoundingClientRect().top));
  assert.deepEqual(new Set(tops).size, 1, 'the keys stand in a line');
  const low: [number, number] = [640, 360];
  assert.deepEqual(await overlaps(low), []);
  await page.getByTestId('open-wardrobe').click();
  await page.getByTestId('wardrobe-sample').waitFor();
  assert.deepEqual(await overlaps(low), [], 'with the wardrobe');
});
