// Paint with WebGPURenderer in Chromium, by its WebGL back end; with CAGECAST_BACKEND=webgpu by WebGPU. CAGECAST_PICTURES=folder keeps
// the pictures: bare and painted, each by WebGLRenderer and by WebGPURenderer.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { build, type Plugin } from 'esbuild';
import { launchChromium } from '../../support/chromium.js';
import { serve } from '../../support/serve.js';
import { temporaryFolder } from '../../support/temporary.js';

/** What three-vrm imports by a name that three.js has no more. */
const renamed: Plugin = {
  name: 'renamed',
  setup({ onLoad, onResolve }) {
    onResolve({ filter: /^three\/tsl$/ }, ({ importer }) =>
      importer.includes('three-vrm') ? { path: 'renamed', namespace: 'renamed' } : undefined,
    );
    const contents = "export * from 'three/tsl'; export { normalView as transformedNormalView } from 'three/tsl';";
    onLoad({ filter: /./, namespace: 'renamed' }, () => ({ contents, resolveDir: import.meta.dirname }));
  },
};

const backend = process.env['CAGECAST_BACKEND'] ?? 'webgl';
const { folder, at } = temporaryFolder('webgpu');
await build({
  entryPoints: ['tests/package/three/webgpu-page.ts'],
  bundle: true,
  format: 'esm',
  outdir: folder,
  logLevel: 'warning',
  define: { 'import.meta.url': 'location.href' },
  plugins: [renamed],
});
writeFileSync(at('index.html'), '<!doctype html><script type="module" src="webgpu-page.js"></script>');
const server = await serve([folder, 'dist', 'examples/samples']);
const browser = await launchChromium({ drawing: true, webgpu: backend === 'webgpu' });
after(async () => {
  await browser.close();
  server.close();
});

const page = await browser.newPage();
const complaints: string[] = [];
page.on('pageerror', (error) => complaints.push(String(error)));
page.on('console', (message) => {
  const harmless = /404|GPU stall|object does not belong to this context|TempNode: This module has been deprecated/;
  if (['error', 'warning'].includes(message.type()) && !harmless.test(message.text())) complaints.push(message.text());
});
const pictures = process.env['CAGECAST_PICTURES'];
if (pictures)
  await page.exposeFunction('keepPicture', (name: string, url: string) =>
    writeFileSync(join(pictures, `${backend} ${name}.png`), Buffer.from(url.split(',')[1]!, 'base64')),
  );
await page.goto(`${server.origin}/index.html?${backend}`);
await page.waitForFunction(() => 'run' in globalThis || undefined, undefined, { timeout: 60000 });

for (const name of await page.evaluate(() => (globalThis as unknown as { names: string[] }).names)) {
  test(name, async (context) => {
    const error = await page.evaluate(
      (name) => (globalThis as unknown as { run(name: string): Promise<string | undefined> }).run(name),
      name,
    );
    for (const figure of await page.evaluate(() => (globalThis as unknown as { figures: string[] }).figures.splice(0)))
      context.diagnostic(figure);
    assert.equal(error, undefined);
    assert.deepEqual(complaints.splice(0), []);
  });
}
