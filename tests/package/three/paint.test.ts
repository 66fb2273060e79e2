// Opens one page in Chromium and runs each scene of it as a test.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { after, test } from 'node:test';
import { build } from 'esbuild';
import { launchChromium } from '../../support/chromium.js';
import { serve } from '../../support/serve.js';
import { temporaryFolder } from '../../support/temporary.js';

/** The three.js of these scenes, as package.json names it; `oldest-three.test.ts` gives another. */
const three = process.env['CAGECAST_THREE'] ?? 'three';
const { folder, at } = temporaryFolder('three');

await build({
  entryPoints: ['tests/package/three/page.ts'],
  bundle: true,
  format: 'esm',
  outdir: folder,
  logLevel: 'warning',
  define: { 'import.meta.url': 'location.href' },
  ...(three !== 'three' && { alias: { three } }),
});

writeFileSync(at('index.html'), '<!doctype html><script type="module" src="page.js"></script>');
// Isolated pages may read the clock exactly.
const server = await serve([folder, 'dist'], {
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
  // The renderer frees what a lost context had, too.
  const harmless = /404|GPU stall|object does not belong to this context/;
  if (['error', 'warning'].includes(message.type()) && !harmless.test(message.text())) complaints.push(message.text());
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
