import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import type { Response } from 'playwright-core';
import { inRepository, openSite } from '../../support/site';

/** The built page; tests/run.mjs builds it. */
const kPage = process.env.CAGECAST_PAGE ?? inRepository('build/web');

test('the page begins without the cage module', () => {
  const begins = [...readFileSync(path.join(kPage, 'index.html'), 'utf8').matchAll(/assets\/([\w.-]+\.js)/g)];
  const names = begins.map(([, name]) => name!);
  assert.ok(names.some((name) => name.startsWith('cagecast-')) && names.length > 3, names.join(', '));
  assert.ok(!names.some((name) => name.startsWith('cages-')), names.join(', '));
});

/** The bytes of a script as it travels. */
const packed = (script: Buffer): number => gzipSync(script, { level: 9 }).length;

test('all scripts of the page are at most 512 KB gzipped, without the cage module, which loads when a cage is asked for', () => {
  const scripts = readdirSync(kPage, { recursive: true, withFileTypes: true })
    .filter(({ name }) => name.endsWith('.js'))
    .map(({ parentPath, name }) => ({ name, script: readFileSync(path.join(parentPath, name)) }));
  // By content, as other scripts may have its name. It starts two threads: one makes cages, one inspects them.
  const isCageModule = ({ name, script }: (typeof scripts)[number]) =>
    /^(cages-(sync|thread)|worker-thread)-/.test(name) ||
    (name.startsWith('cages-') && script.includes('cages-thread-'));
  // What opens FBX, OBJ, PLY, STL and USD loads when such a file is opened.
  const isOfFormats = ({ name }: (typeof scripts)[number]) =>
    /^((FBX|OBJ|MTL|PLY|STL|USD)Loader|formats-thread|fflate)/.test(name);
  const sum = (of: typeof scripts) => of.reduce((sum, { script }) => sum + packed(script), 0);
  const cages = scripts.filter(isCageModule);
  assert.equal(
    cages.length,
    4,
    `the cage module, with and without its thread, and what inspects cages: ${cages.map(({ name }) => name).join(', ')}`,
  );
  const total = sum(scripts.filter((one) => !isCageModule(one) && !isOfFormats(one)));
  assert.ok(total > 100_000, 'they were found');
  assert.ok(total <= 512_000, `${total} bytes`);
});

test('until the first sample is shown and judged, the browser requests at most 300 KB of scripts, gzipped', async () => {
  const site = await openSite();
  const context = await site.browser.newContext({ viewport: { width: 1000, height: 700 } });
  // When the verdict is there: all other features are requested at once then.
  await context.addInitScript(() => {
    new MutationObserver(() => {
      if (document.querySelector('#fit-verdict:not(:empty)'))
        document.documentElement.dataset.judged ??= String(Date.now());
    }).observe(document, { childList: true, subtree: true });
  });
  const responses: Response[] = [];
  context.on('response', (response) => void responses.push(response));
  const page = await context.newPage();
  await page.goto(site.url);
  const judged = await page.locator('[data-judged]').getAttribute('data-judged', { timeout: 60_000 });
  const first = responses.filter((response) => response.request().timing().startTime < Number(judged));
  const scripts = new Set(
    first.map((response) => new URL(response.url(), site.url).href.slice(new URL('.', site.url).href.length)),
  );
  const sizes = [...scripts]
    .filter((name) => name.endsWith('.js'))
    .map((name) => [name, packed(readFileSync(path.join(site.folder, name)))] as const);
  const list = sizes.map((size) => size.join(' ')).join(', ');
  assert.ok(
    sizes.some(([name]) => name.includes('transfer-worker')),
    `workers count, too: ${list}`,
  );
  const total = sizes.reduce((sum, [, size]) => sum + size, 0);
  assert.ok(total <= 300_000, `${total} bytes: ${list}`);
});
