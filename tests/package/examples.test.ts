import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join } from 'node:path';
import { after, describe, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { build } from 'esbuild';
import { PNG } from 'pngjs';
import { validate } from '../js/glb.js';
import { launchChromium } from '../support/chromium.js';

const folder = mkdtempSync(join(tmpdir(), 'cagecast-examples-'));
const sample = 'build/assets/lizard';
after(() => rmSync(folder, { recursive: true, force: true }));

function node(...args: string[]): string {
  const { status, stdout, stderr } = spawnSync(process.execPath, args, { encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return stdout;
}

describe('examples', () => {
  test('node/arrays.js prints where each vertex lies in the texture', () => {
    const lines = node('examples/node/arrays.js').trim().split('\n');
    assert.deepEqual(lines.slice(0, 2), [
      'vertex 0: u = 0.25, v = 0.25, may be painted',
      'vertex 1: u = 0.5, v = 0.25, may be painted',
    ]);
    assert.equal(lines.length, 4);
  });

  test('node/transfer.js writes a painted model', async () => {
    const out = join(folder, 'painted.glb');
    assert.match(
      node('examples/node/transfer.js', `${sample}/target.glb`, `${sample}/cage.glb`, `${sample}/paint-tiger.png`, out),
      /^\d+\.\d ms$/m,
    );
    assert.deepEqual(await validate(out), []);
  });

  test('three/ shows the paint', { timeout: 120000 }, async () => {
    await build({
      entryPoints: ['examples/three/main.js'],
      bundle: true,
      format: 'esm',
      outdir: folder,
      logLevel: 'warning',
    });
    cpSync('examples/three/index.html', join(folder, 'index.html'));
    for (const file of ['target.glb', 'cage.glb']) cpSync(join(sample, file), join(folder, file));
    cpSync(join(sample, 'paint-tiger.png'), join(folder, 'paint.png'));
    const types: Record<string, string> = { '.html': 'text/html', '.js': 'text/javascript' };
    const server = createServer((request, response) => {
      const path = join(folder, new URL(request.url ?? '/', 'http://localhost').pathname);
      if (!existsSync(path) || extname(path) === '') return response.writeHead(404).end();
      response
        .writeHead(200, { 'content-type': types[extname(path)] ?? 'application/octet-stream' })
        .end(readFileSync(path));
    });
    await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
    const browser = await launchChromium({ drawing: true });
    try {
      const page = await browser.newPage({ viewport: { width: 400, height: 400 } });
      const faults: string[] = [];
      page.on('pageerror', (error) => faults.push(String(error)));
      await page.goto(`http://127.0.0.1:${(server.address() as { port: number }).port}/index.html`);
      const deadline = Date.now() + 60000;
      while (!/painted/.test(await page.title()) && faults.length === 0 && Date.now() < deadline) await setTimeout(100);
      assert.deepEqual(faults, []);
      assert.match(await page.title(), /^[1-9]\d* painted$/);
      // The tiger's orange, which nothing else of the picture has.
      const orange = ({ data }: PNG): number => {
        let count = 0;
        for (let at = 0; at < data.length; at += 4)
          if (data[at]! > 120 && data[at]! > 1.6 * data[at + 2]! && data[at]! > 1.15 * data[at + 1]!) ++count;
        return count;
      };
      // It is drawn a little later.
      let seen: number;
      do seen = orange(PNG.sync.read(await page.screenshot()));
      while (seen <= 0.02 * 400 * 400 && Date.now() < deadline);
      assert.ok(seen > 0.02 * 400 * 400, `${seen} of ${400 * 400} pixels`);
    } finally {
      await browser.close();
      server.close();
    }
  });
});
