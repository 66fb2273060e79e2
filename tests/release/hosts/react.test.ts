import assert from 'node:assert/strict';
import { cpSync, mkdirSync, readFileSync, rmSync, symlinkSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { VRMLoaderPlugin } from '@pixiv/three-vrm';
import type { Browser, CDPSession, Page } from 'playwright-core';
import { PNG } from 'pngjs';
import type { Mesh } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { build, type InlineConfig, type PreviewServer, preview } from 'vite';
import { launchChromium } from '../../support/chromium.js';
import { validate } from '../../support/gltf.js';
import { installPacked, linkPackages, run } from './install.js';

const user = installPacked();
const faults: string[] = [];
let server: PreviewServer;
let browser: Browser;
let page: Page;
let session: CDPSession;

before(async () => {
  const root = join(user, 'examples/react-three-fiber');
  cpSync('examples/react-three-fiber', root, { recursive: true });
  mkdirSync(join(user, 'examples/three-vrm'));
  cpSync('examples/three-vrm/make-avatar.js', join(user, 'examples/three-vrm/make-avatar.js'));
  symlinkSync(resolve('examples/samples'), join(user, 'examples/samples'));
  run(process.execPath, ['make-avatar.js'], join(user, 'examples/three-vrm'));
  linkPackages(user, ['three', 'react', 'react-dom', '@react-three/fiber', '@pixiv/three-vrm']);
  const options = {
    root,
    configFile: false,
    publicDir: '../three-vrm/models',
    base: './',
    logLevel: 'error' as const,
    resolve: { dedupe: ['three', 'react'] },
  } satisfies InlineConfig;
  await build({ ...options, build: { target: 'es2022', chunkSizeWarningLimit: 5000 } });
  server = await preview({ ...options, preview: { host: '127.0.0.1', port: 0 } });
  browser = await launchChromium({ drawing: true });
  page = await browser.newPage({ viewport: { width: 640, height: 480 } });
  page.setDefaultTimeout(120_000);
  page.on('pageerror', (error) => faults.push(String(error)));
  await page.addInitScript(`
    globalThis.held = { Buffer: 0, Texture: 0 };
    for (const name in held) {
      const { prototype } = WebGL2RenderingContext;
      const [make, free] = [prototype['create' + name], prototype['delete' + name]];
      prototype['create' + name] = function () { ++held[name]; return make.call(this); };
      prototype['delete' + name] = function (it) { if (it) --held[name]; return free.call(this, it); };
    }`);
  await page.goto(server.resolvedUrls!.local[0]!);
  session = await page.context().newCDPSession(page);
  await painted();
});
after(async () => {
  await browser?.close();
  await server?.close();
  rmSync(user, { recursive: true, force: true });
});

const painted = async (): Promise<void> => {
  await page.waitForFunction(() => /^[1-9]\d* painted$/.test(document.title) || undefined);
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  assert.deepEqual(faults, []);
};

const swap = async (sample: string): Promise<void> => {
  await page.locator('[name=avatar]').setInputFiles(sample);
  await page.waitForFunction(() => document.title === 'Loading' || undefined);
  await painted();
};

/** The share of the picture that is green, as the brush and nothing else is. */
async function green(): Promise<number> {
  const { data } = PNG.sync.read(await page.locator('canvas').screenshot());
  let count = 0;
  for (let at = 0; at < data.length; at += 4)
    if (data[at + 1]! > 80 && data[at + 1]! > 1.5 * Math.max(data[at]!, data[at + 2]!)) ++count;
  return count / (data.length / 4);
}

const download = async (button: string): Promise<string> => {
  const event = page.waitForEvent('download');
  await page.getByRole('button', { name: button }).click();
  return (await event).path();
};

describe('examples/react-three-fiber, of the packed package, in Chromium', { timeout: 900_000 }, () => {
  let look: string;

  test('has one script of less than 80 lines', () => {
    const lines = readFileSync('examples/react-three-fiber/main.jsx', 'utf8').trimEnd().split('\n');
    assert.ok(lines.length < 80 && lines.every((line) => line.length <= 130), `${lines.length}`);
  });

  test('fits, shows three layers, and paints by a brush', async () => {
    await page.locator('form').evaluate((form) => ((form as HTMLElement).style.opacity = '0'));
    assert.ok((await green()) < 0.001);
    await page.mouse.move(290, 300);
    await page.mouse.down();
    await page.mouse.move(350, 305, { steps: 5 });
    await page.mouse.up();
    const share = await green();
    assert.ok(share > 0.0015, `${share}`);
    look = await download('Save');
    const { layers } = JSON.parse(readFileSync(look, 'utf8'));
    assert.deepEqual(
      layers.map(({ region, blend }: { region: string | null; blend: string }) => [region, blend]),
      [...['lips', 'cheeks', 'eyelids'].map((name) => [name, 'normal']), [null, 'normal']],
    );
  });

  test('exports a VRM that three-vrm opens', async () => {
    const bytes = readFileSync(await download('Export'));
    assert.deepEqual(await validate(bytes), []);
    Object.assign(globalThis, { self: globalThis }); // which GLTFLoader expects
    const loader = new GLTFLoader().register((parser) => new VRMLoaderPlugin(parser));
    const { userData, scene } = await loader.parseAsync(Uint8Array.from(bytes).buffer, '');
    assert.ok(userData['vrm'].humanoid.getRawBoneNode('head'));
    const materials = new Set<string>();
    scene.traverse((one) => {
      for (const material of [(one as Mesh).material ?? []].flat()) materials.add(material.name);
    });
    assert.ok(materials.has('Cagecast overlay'), [...materials].join());
  });

  test('shows the look on another avatar, also one that was saved', async () => {
    await swap('examples/samples/human-fused/target.glb');
    const kept = await green();
    assert.ok(kept > 0.0015, `${kept}`);
    await page.getByRole('button', { name: 'Undo' }).click();
    assert.ok((await green()) < 0.001);
    await page.locator('[name=look]').setInputFiles(look);
    for (const end = Date.now() + 20_000; (await green()) < 0.9 * kept && Date.now() < end; );
    assert.ok(Math.abs((await green()) - kept) < 0.1 * kept);
    assert.deepEqual(faults, []);
  });

  test('swaps avatars thirty times; geometries, textures and heap are as before', async (context) => {
    const files = ['human', 'human-fused', 'human-body'].map((name) => `examples/samples/${name}/target.glb`);
    const held = async () => {
      await session.send('HeapProfiler.collectGarbage');
      const { usedSize } = (await session.send('Runtime.getHeapUsage')) as { usedSize: number };
      return { ...(await page.evaluate<{ Buffer: number; Texture: number }>('held')), heap: usedSize };
    };
    for (const file of files) await swap(file);
    const first = await held();
    for (let n = 0; n < 30; ++n) await swap(files[n % 3]!);
    const last = await held();
    context.diagnostic(JSON.stringify([first, last]));
    assert.deepEqual([last.Buffer, last.Texture], [first.Buffer, first.Texture]);
    assert.ok(last.heap < first.heap + 3e6, `${last.heap} after ${first.heap}`);
  });
});
