import assert from 'node:assert/strict';
import { cpSync, readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import type { Browser, Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { build, type PreviewServer, preview } from 'vite';
import { launchChromium } from '../../support/chromium.js';
import { installPacked, linkPackages } from './install.js';

const folder = installPacked();
const faults: string[] = [];
let server: PreviewServer;
let browser: Browser;
let page: Page;

before(async () => {
  cpSync('examples/customizer', folder, { recursive: true });
  linkPackages(folder, ['three']);
  const options = {
    root: folder,
    publicDir: join(process.cwd(), 'examples/samples/lizard'),
    logLevel: 'warn',
  } as const;
  // What is linked lies outside of the folder.
  await build({ ...options, resolve: { preserveSymlinks: true } });
  server = await preview({ ...options, preview: { host: '127.0.0.1', port: 0 } });
  browser = await launchChromium({ drawing: true });
  page = await browser.newPage({ viewport: { width: 640, height: 400 } });
  page.setDefaultTimeout(120_000);
  page.on('pageerror', (error) => faults.push(String(error)));
  await page.goto(server.resolvedUrls!.local[0]!);
  await page.waitForFunction(() => document.title === '1 layers' || undefined, undefined, { timeout: 60000 });
});
after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(folder, { recursive: true, force: true });
});

/** The share of the picture that is green, as the brush and nothing else is. */
async function green(): Promise<number> {
  const { data } = PNG.sync.read(await page.screenshot());
  let count = 0;
  for (let at = 0; at < data.length; at += 4)
    if (data[at + 1]! > 80 && data[at + 1]! > 2 * Math.max(data[at]!, data[at + 2]!)) ++count;
  return count / (data.length / 4);
}

const drag = async (from: [number, number], to: [number, number]): Promise<void> => {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps: 4 });
  await page.mouse.up();
};

describe('examples/customizer, of the packed package, in Chromium', () => {
  test('has one script of less than 60 lines', () => {
    assert.ok(readFileSync('examples/customizer/main.js', 'utf8').trim().split('\n').length < 60);
  });

  test('paints, undoes, erases, and places a sticker on the model', { timeout: 600_000 }, async () => {
    await page.locator('#color').fill('#00cc33');
    await page.locator('#color').evaluate((input) => ((input as HTMLElement).hidden = true));
    assert.ok((await green()) < 0.001);
    await drag([290, 165], [350, 165]);
    assert.equal(await page.title(), '2 layers');
    const painted = await green();
    assert.ok(painted > 0.002, `${painted}`);
    await page.locator('#undo').click();
    assert.ok((await green()) < 0.001);
    await page.locator('#redo').click();
    assert.ok(Math.abs((await green()) - painted) < 0.001);
    await page.locator('#tool').selectOption('eraser');
    await drag([290, 165], [350, 165]);
    assert.ok((await green()) < 0.3 * painted);
    await page.locator('#tool').selectOption('sticker');
    // Each place that it is dragged to takes seconds where the processor draws.
    await page.mouse.click(320, 165);
    assert.ok((await green()) > 0.001);
    assert.deepEqual(faults, []);
  });

  test('shows the opacity that undo brings back, and fills a window that has changed', {
    timeout: 600_000,
  }, async () => {
    await page.locator('#stripes').fill('0.3');
    await page.locator('#undo').click();
    assert.equal(await page.locator('#stripes').inputValue(), '1');
    await page.setViewportSize({ width: 480, height: 400 });
    await page.waitForFunction(() => document.querySelector('canvas')!.clientWidth === innerWidth || undefined);
    await page.setViewportSize({ width: 640, height: 400 });
    assert.deepEqual(faults, []);
  });

  test('hides a layer, and saves the others in the model’s own texture', { timeout: 600_000 }, async () => {
    await page.locator('#stripes').fill('0');
    const download = page.waitForEvent('download');
    await page.locator('#save').click();
    const image = PNG.sync.read(readFileSync(await (await download).path()));
    assert.equal(image.width, 1024);
    const count = (isOf: (r: number, g: number, b: number) => boolean): number => {
      let found = 0;
      for (let at = 0; at < image.data.length; at += 4)
        if (isOf(image.data[at]!, image.data[at + 1]!, image.data[at + 2]!)) found++;
      return found;
    };
    const greens = count((r, g, b) => r < 40 && Math.abs(g - 204) < 20 && Math.abs(b - 51) < 20);
    assert.ok(greens > 100 && greens < 0.1 * 1024 * 1024, `${greens}`);
    const stripes = count((r, g, b) => r > 150 && r > 1.5 * g && r > 3 * b);
    assert.ok(stripes < 100, `${stripes} texels of the hidden layer`);
    assert.ok(
      image.data.every((byte, at) => at % 4 < 3 || byte === 255),
      'the texture below is there',
    );
    assert.deepEqual(faults, []);
  });
});
