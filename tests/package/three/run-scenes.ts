// Opens a page in Chromium and runs each of its scenes as a test.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { after, test } from 'node:test';
import { type BuildOptions, build } from 'esbuild';
import { launchChromium } from '../../support/chromium.js';
import { serve } from '../../support/serve.js';
import { temporaryFolder } from '../../support/temporary.js';

/** Warnings that say nothing here: the renderer frees what a lost context had, too. */
const kHarmless = /toImageData has the colours only|404|GPU stall|object does not belong to this context/;

/**
 * Makes a test of each scene of a page, which has them as `names` and `run(name)`.
 * @param script   The page's script.
 * @param options  For esbuild; `folders`: what else is served.
 */
export async function testScenes(
  script: string,
  { folders = [], harmless, ...options }: BuildOptions & { folders?: string[]; harmless?: RegExp } = {},
): Promise<void> {
  const { folder, at } = temporaryFolder('scenes');
  await build({
    entryPoints: { page: script },
    bundle: true,
    format: 'esm',
    outdir: folder,
    logLevel: 'warning',
    define: { 'import.meta.url': 'location.href', 'process.env.NODE_ENV': '"development"' },
    ...options,
  });
  writeFileSync(at('index.html'), '<!doctype html><script type="module" src="page.js"></script>');
  // Isolated pages may read the clock exactly.
  const server = await serve([folder, 'dist', ...folders], {
    'cross-origin-opener-policy': 'same-origin',
    'cross-origin-embedder-policy': 'require-corp',
  });
  const browser = await launchChromium({ drawing: true });
  after(async () => {
    await browser.close();
    server.close();
  });

  const page = await browser.newPage();
  const complaints: string[] = [];
  const session = await page.context().newCDPSession(page);
  await page.exposeFunction('collectGarbage', () => session.send('HeapProfiler.collectGarbage'));
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => {
    const text = message.text();
    if (!['error', 'warning'].includes(message.type()) || kHarmless.test(text) || harmless?.test(text)) return;
    complaints.push(text);
  });
  await page.goto(`${server.origin}/index.html`);
  await page.waitForFunction(() => 'run' in globalThis || undefined, undefined, { timeout: 60000 });

  for (const name of await page.evaluate(() => (globalThis as unknown as { names: string[] }).names)) {
    test(name, async () => {
      const error = await page.evaluate(
        (name) => (globalThis as unknown as { run(name: string): Promise<string | undefined> }).run(name),
        name,
      );
      assert.equal(error, undefined);
      assert.deepEqual(complaints.splice(0), []);
    });
  }
}
