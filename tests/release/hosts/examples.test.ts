import assert from 'node:assert/strict';
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import type { Browser, Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { build, createServer } from 'vite';
import { launchChromium } from '../../support/chromium.js';
import { GlbMaker, tetrahedron } from '../../support/glb.js';
import { validate } from '../../support/gltf.js';
import { hostTools, installPacked, run, serve } from './install.js';

const user = installPacked();
/** The examples, and the folder of models that lies beside each. */
const built: Record<string, string> = {
  three: 'lizard',
  'react-three-fiber': 'lizard',
  worker: 'lizard',
  'web-component': 'lizard',
  'three-vrm': '../three-vrm/models',
};
const policy =
  "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self' blob:; img-src 'self' blob:";

/** How many pixels have a colour as orange as the paints', which nothing else of the pictures has. */
function orange(picture: Buffer): number {
  const { data } = PNG.sync.read(picture);
  let count = 0;
  for (let at = 0; at < data.length; at += 4)
    if (data[at]! > 120 && data[at]! > 1.6 * data[at + 2]! && data[at]! > 1.15 * data[at + 1]!) ++count;
  return count;
}

/** The sum of all colours. */
const brightness = (picture: Buffer): number =>
  PNG.sync.read(picture).data.reduce((sum, byte, i) => (i % 4 === 3 ? sum : sum + byte), 0);

/**
 * Checks that a picture shows what another does, of the same model that was loaded anew: files are decoded in any order, three.js draws
 * materials in the order in which they were made, and the last one is seen where surfaces have the same depth.
 */
function assertSameModel(picture: Buffer, other: Buffer): void {
  const [one, two] = [PNG.sync.read(picture), PNG.sync.read(other)];
  assert.deepEqual([one.width, one.height], [two.width, two.height]);
  let differing = 0;
  for (let at = 0; at < one.data.length; at += 4)
    if (one.data.compare(two.data, at, at + 4, at, at + 4) !== 0) ++differing;
  assert.ok(differing <= 10, `${differing} of ${one.width * one.height} pixels differ`);
}

let browser: Browser;
const sites: Awaited<ReturnType<typeof serve>>[] = [];

/** Builds all examples at once, as `vite build` in each of them does. */
async function buildExamples(): Promise<void> {
  const sources = join(user, 'examples');
  cpSync('examples', sources, {
    recursive: true,
    filter: (path) => !/node_modules|examples\/(native|node|samples)/.test(path),
  });
  symlinkSync(resolve('examples/samples'), join(user, 'examples/samples'));
  const peers: Record<string, string> = { three: 'node_modules', '@pixiv/three-vrm': 'node_modules' };
  for (const name of ['react', 'react-dom', '@react-three/fiber']) peers[name] = hostTools;
  for (const [name, from] of Object.entries(peers)) {
    mkdirSync(join(user, 'node_modules', name, '..'), { recursive: true });
    symlinkSync(resolve(from, name), join(user, 'node_modules', name));
  }
  run(process.execPath, ['make-avatar.js'], join(sources, 'three-vrm'));
  await build({
    root: sources,
    configFile: false,
    base: './',
    logLevel: 'error',
    publicDir: false,
    resolve: { dedupe: ['three', 'react'] },
    build: {
      target: 'es2022',
      modulePreload: { polyfill: false },
      outDir: join(user, 'out'),
      rolldownOptions: { input: Object.keys(built).map((name) => join(sources, name, 'index.html')) },
    },
  });
  for (const [name, models] of Object.entries(built))
    for (const file of readdirSync(join(sources, 'samples', models)))
      symlinkSync(join(sources, 'samples', models, file), join(user, 'out', name, file));
  // This one needs no build.
  symlinkSync(join(user, 'node_modules'), join(sources, 'import-map/node_modules'));
  symlinkSync(resolve('examples/samples/lizard'), join(sources, 'import-map/models'));
}

before(async () => {
  await buildExamples();
  sites.push(
    await serve(join(user, 'out'), { 'content-security-policy': policy }),
    await serve(join(user, 'examples')),
  );
  browser = await launchChromium({ drawing: true });
});
after(async () => {
  await browser?.close();
  for (const { close } of sites) close();
  rmSync(user, { recursive: true, force: true });
});

async function painted(page: Page, faults: string[]): Promise<void> {
  for (const end = Date.now() + 60000; !/painted/.test(await page.title()) && faults.length === 0 && Date.now() < end; )
    await setTimeout(50);
  assert.deepEqual(faults, [], page.url());
  assert.match(await page.title(), /^[1-9]\d* painted$/);
}

/** Opens an example and waits until it says that it has painted something. */
async function open(address: string): Promise<{ page: Page; faults: string[] }> {
  const page = await browser.newPage({ viewport: { width: 256, height: 256 } });
  page.setDefaultTimeout(120_000);
  const faults: string[] = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error' && !/favicon|404/.test(message.text())) faults.push(message.text());
  });
  await page.goto(address);
  await painted(page, faults);
  return { page, faults };
}

/** Waits until what is drawn has enough of the paint. */
async function seen(page: Page): Promise<void> {
  let count = 0;
  for (const end = Date.now() + 30000; count < 400 && Date.now() < end; ) count = orange(await page.screenshot());
  assert.ok(count >= 400, `${count} pixels`);
}

describe('examples, from the packed package', () => {
  test('have a package of their own, at most 60 lines, and a row in the README', () => {
    const readme = readFileSync('examples/README.md', 'utf8');
    for (const name of [...Object.keys(built), 'import-map']) {
      const { dependencies, scripts } = JSON.parse(readFileSync(`examples/${name}/package.json`, 'utf8'));
      assert.ok(dependencies.cagecast && scripts.start, name);
      for (const file of readdirSync(`examples/${name}`).filter((one) => /^(main|index)\./.test(one)))
        assert.ok(readFileSync(`examples/${name}/${file}`, 'utf8').split('\n').length <= 61, `${name}/${file}`);
      assert.ok(readme.includes(`(${name})`), name);
    }
  });

  for (const name of Object.keys(built).filter((one) => one !== 'web-component'))
    test(`${name} shows the paint`, async () => {
      const { page, faults } = await open(`${sites[0]!.origin}/${name}/index.html`);
      await seen(page);
      if (name === 'worker') {
        // The second visit needs no cage.
        let cages = 0;
        page.on('request', (request) => (cages += Number(request.url().endsWith('cage.glb'))));
        await page.reload();
        await painted(page, faults);
        assert.equal(cages, 0);
        // What an earlier version kept is replaced.
        await page.evaluate('caches.open("cagecast").then((cache) => cache.put("transfer", new Response("old")))');
        await page.reload();
        await painted(page, faults);
        await page.reload();
        await painted(page, faults);
        assert.equal(cages, 1);
      }
      assert.deepEqual(faults, []);
      await page.close();
    });

  test('import-map shows the paint, as it is', async () => {
    const { page } = await open(`${sites[1]!.origin}/import-map/index.html`);
    await seen(page);
    await page.close();
  });
});

describe('examples, as examples/README.md says', () => {
  test('worker shows the paint where cagecast is a link to the repository', async () => {
    const repository = join(user, 'repository');
    const folder = join(repository, 'examples/worker');
    cpSync(join(user, 'node_modules/cagecast'), repository, { recursive: true });
    cpSync(join(user, 'examples/worker'), folder, { recursive: true });
    symlinkSync(resolve('examples/samples'), join(repository, 'examples/samples'));
    mkdirSync(join(folder, 'node_modules'));
    symlinkSync(repository, join(folder, 'node_modules/cagecast'));
    symlinkSync(resolve('node_modules/three'), join(folder, 'node_modules/three'));
    const server = await createServer({ root: folder, logLevel: 'error', server: { host: '127.0.0.1' } });
    try {
      await server.listen();
      const { page, faults } = await open(server.resolvedUrls!.local[0]!);
      await seen(page);
      assert.deepEqual(faults, []);
      await page.close();
    } finally {
      await server.close();
    }
  });
});

describe('<cagecast-viewer>, under a strict Content-Security-Policy', () => {
  let page: Page;
  let faults: string[];
  const warnings: string[] = [];
  before(async () => {
    ({ page, faults } = await open(`${sites[0]!.origin}/web-component/index.html`));
    page.on('console', (message) => message.type() === 'warning' && warnings.push(message.text()));
    await page.evaluate(`
      globalThis.viewer = document.querySelector('cagecast-viewer');
      globalThis.part = (selector) => viewer.shadowRoot.querySelector(selector);
      globalThis.told = [];
      globalThis.watch = () => { for (const type of ['load', 'error']) viewer.addEventListener(type, ({ detail }) => told.push(detail ? type + ' ' + detail.message : type)); };
      globalThis.next = async () => { told.length = 0; while (told.length === 0) await new Promise((done) => setTimeout(done, 20)); return told[0]; };
      globalThis.text = (blob) => new Promise((done) => { const reader = new FileReader(); reader.onload = () => done(reader.result.split(',')[1]); reader.readAsDataURL(blob); });
      watch();`);
  });
  after(() => page?.close());
  const bytesOf = async (script: string) => Buffer.from(await page.evaluate<string>(script), 'base64');
  const picture = () => bytesOf('viewer.toBlob().then(text)');

  test('shows the painted model and says whether the cage fits', async () => {
    await seen(page);
    assert.match(await page.innerText('[role=status]'), /^The cage is (good|usable)\.$/);
    assert.ok(orange(await picture()) > 400);
  });

  test('has a role and a label, and nothing that axe-core complains about', async () => {
    assert.deepEqual(
      await page.evaluate('[part("canvas").getAttribute("role"), part("canvas").getAttribute("aria-label")]'),
      ['img', 'The head of a lizard with the stripes of a tiger'],
    );
    await page.evaluate(readFileSync('node_modules/axe-core/axe.min.js', 'utf8'));
    assert.deepEqual(await page.evaluate('axe.run().then(({ violations }) => violations.map(({ id }) => id))'), []);
  });

  test('is turned by keys, and goes back', async () => {
    const before = await picture();
    await page.evaluate('viewer.focus()');
    for (const key of ['ArrowRight', 'ArrowUp', '+']) {
      const last = await picture();
      await page.keyboard.press(key);
      assert.notDeepEqual(await picture(), last, key);
    }
    await page.keyboard.press('Home');
    assert.deepEqual(await picture(), before);
    await page.evaluate('viewer.setAttribute("camera-orbit", "90deg 80deg 150%")');
    assert.notDeepEqual(await picture(), before);
    await page.evaluate('viewer.removeAttribute("camera-orbit")');
  });

  test('of an element that shows nothing, a picture is refused by the promise', async () => {
    const said = await page.evaluate<string>('document.createElement("cagecast-viewer").toBlob().catch(String)');
    assert.match(said, /^Error: toBlob: .* shows nothing yet/);
  });

  test('exports a valid model with its paint', async () => {
    const file = join(user, 'exported.glb');
    writeFileSync(file, await bytesOf('viewer.exportGlb().then((glb) => text(new Blob([glb])))'));
    assert.deepEqual(await validate(file), []);
    assert.match(readFileSync(file, 'latin1'), /"images":\[/);
  });

  test('follows its attributes: opacity and paint without another transfer', async () => {
    const before = await picture();
    await page.evaluate('globalThis.steps = 0; viewer.addEventListener("progress", () => ++steps);');
    await page.evaluate('viewer.setAttribute("opacity", "0")');
    assert.ok(orange(await picture()) < orange(before) / 2);
    await page.evaluate('viewer.removeAttribute("opacity")');
    assert.deepEqual(await picture(), before);
    await page.evaluate('viewer.setAttribute("paint", "paint-war-paint.png"); next()');
    assert.notDeepEqual(await picture(), before);
    await page.evaluate('viewer.setAttribute("paint", "paint-tiger.png"); next()');
    assert.deepEqual(await picture(), before);
    // Two in quick succession, too.
    await page.evaluate(`(async () => {
      viewer.setAttribute("paint", "paint-war-paint.png");
      await Promise.resolve();
      viewer.setAttribute("paint", "paint-tiger.png");
      return next();
    })()`);
    assert.deepEqual(await picture(), before);
    assert.equal(await page.evaluate('steps'), 0);
  });

  test('loads what could not be loaded for its opacity once that is right', async () => {
    const target = await page.evaluate<string>('viewer.getAttribute("target")');
    const said = await page.evaluate(
      'viewer.setAttribute("opacity", "2"); viewer.setAttribute("target", "cage.glb"); next()',
    );
    assert.match(said as string, /^error .*\bopacity is 2, not a number from 0 to 1$/);
    assert.equal(await page.evaluate('viewer.setAttribute("opacity", "1"); next()'), 'load');
    assert.ok(await page.isHidden('cagecast-viewer [role=alert]'));
    await page.evaluate(`viewer.removeAttribute("opacity"); viewer.setAttribute("target", "${target}"); next()`);
  });

  test('tells of a wrong opacity once where it is there from the beginning', async () => {
    const told = await page.evaluate<string[]>(`(async () => {
      const other = document.createElement('cagecast-viewer');
      const told = [];
      for (const type of ['load', 'error']) other.addEventListener(type, ({ detail }) => told.push(detail ? detail.message : type));
      const parse = other.loader.parseAsync;
      const read = new Promise((done) => {
        other.loader.parseAsync = function (...given) {
          const reading = parse.apply(this, given);
          reading.then(() => setTimeout(done));
          return reading;
        };
      });
      other.setAttribute('target', 'cage.glb');
      other.setAttribute('opacity', 'abc');
      viewer.parentNode.append(other);
      await read;
      other.setAttribute('opacity', '0.5');
      while (!told.includes('load')) await new Promise((done) => setTimeout(done, 20));
      other.remove();
      return told;
    })()`);
    assert.deepEqual(told, ['cagecast-viewer: opacity is "abc", not a number', 'load']);
  });

  test('frees pictures and buffers of what is not shown any more, and of what could not be loaded', async () => {
    const { live, buffers } = await page.evaluate<{ live: string[]; buffers: number[] }>(`(async () => {
      let live = 0;
      const make = createImageBitmap;
      const { close } = ImageBitmap.prototype;
      globalThis.createImageBitmap = (...args) => (++live, make(...args));
      ImageBitmap.prototype.close = function () {
        if (this.width > 0) --live;
        close.call(this);
      };
      let held = 0;
      const buffers = [];
      const { createBuffer, deleteBuffer } = WebGL2RenderingContext.prototype;
      WebGL2RenderingContext.prototype.createBuffer = function () { ++held; return createBuffer.call(this); };
      WebGL2RenderingContext.prototype.deleteBuffer = function (buffer) {
        if (buffer) --held;
        deleteBuffer.call(this, buffer);
      };
      const seen = [];
      for (const threshold of ['0.4', 'none', '0.5', 'some', '0.6']) {
        viewer.setAttribute('threshold', threshold);
        const said = await next();
        await new Promise((done) => setTimeout(done, 200));
        seen.push(said.split(' ')[0] + ' ' + live);
        buffers.push(held);
      }
      globalThis.createImageBitmap = make;
      ImageBitmap.prototype.close = close;
      Object.assign(WebGL2RenderingContext.prototype, { createBuffer, deleteBuffer });
      viewer.removeAttribute('threshold');
      await next();
      return { live: seen, buffers };
    })()`);
    assert.deepEqual(live, ['load 0', 'error 0', 'load 0', 'error 0', 'load 0']);
    assert.equal(buffers[4], buffers[2], 'as many buffers as with the model before');
  });

  test('stays as it is where it is moved, even if its address leads nowhere by now', async () => {
    const target = await page.evaluate<string>('viewer.getAttribute("target")');
    await page.evaluate(`(async () => {
      const address = URL.createObjectURL(await (await fetch("${target}")).blob());
      viewer.setAttribute("target", address);
      await next();
      URL.revokeObjectURL(address);
      viewer.focus();
    })()`);
    await page.keyboard.press('ArrowRight');
    const before = await picture();
    const told = await page.evaluate(`(async () => {
      told.length = 0;
      viewer.parentNode.append(viewer);
      await new Promise((done) => setTimeout(done, 300));
      return told;
    })()`);
    assert.deepEqual(told, []);
    assert.deepEqual(await picture(), before);
    const exported = await bytesOf('viewer.exportGlb().then((glb) => text(new Blob([glb])))');
    assert.match(exported.toString('latin1'), /"images":\[/);
    await page.evaluate(`viewer.setAttribute("target", "${target}"); next()`);
  });

  test('is shown as before in the document of a frame', async () => {
    const styles = () =>
      page.evaluate<string[]>(`[viewer, part('canvas'), part('.error')].map((element) => {
        const { display, position } = getComputedStyle(element);
        return display + ' ' + position;
      })`);
    const [before, shown] = [await styles(), await picture()];
    await page.evaluate(`
      globalThis.place = viewer.parentNode;
      globalThis.frame = document.createElement('iframe');
      place.append(frame);
      frame.contentDocument.body.append(viewer);`);
    const [within, shownWithin] = [await styles(), await picture()];
    await page.evaluate('place.append(viewer); frame.remove()');
    assert.deepEqual([within, await styles()], [before, before]);
    assert.deepEqual([shownWithin, await picture()], [shown, shown]);
  });

  test('shows all of the model where it is narrow, also if it was wide or hidden before', async () => {
    const resized = (width: string) =>
      page.evaluate(`(async () => {
        viewer.style.width = "${width}";
        const frame = () => new Promise((done) => requestAnimationFrame(done));
        await frame();
        await frame();
      })()`);
    const at = async (width: string) => {
      await resized(width);
      return picture();
    };
    const plain = orange(await picture());
    const narrow = orange(await at('120px'));
    await page.evaluate('viewer.setAttribute("camera-orbit", "20deg 80deg 100%")');
    await page.evaluate('viewer.removeAttribute("camera-orbit")');
    const placed = orange(await picture());
    assert.ok(
      Math.abs(narrow - placed) < 0.02 * placed,
      `${narrow}, as if it was placed when it was narrow: ${placed}`,
    );
    const wide = orange(await at(''));
    assert.ok(Math.abs(wide - plain) < 0.02 * plain, `${wide}, as before: ${plain}`);
  });

  test('has the pixels of the screen, also where the page is zoomed or moved to another screen', async () => {
    const session = await page.context().newCDPSession(page);
    for (const ratio of [2, 1]) {
      // A promise in an array, for which evaluate does not wait.
      await page.evaluate(`globalThis.resized = [new Promise((done) => {
        const canvas = part('canvas');
        const observer = new MutationObserver(() => {
          if (canvas.width !== ${ratio} * canvas.clientWidth) return;
          observer.disconnect();
          done();
        });
        observer.observe(canvas, { attributeFilter: ['width'] });
      })]; 0`);
      const screen = { width: 256, height: 256, deviceScaleFactor: ratio, mobile: false };
      await session.send('Emulation.setDeviceMetricsOverride', screen);
      // Chromium does not evaluate media queries for an emulated screen alone.
      await page.emulateMedia({ colorScheme: ratio === 2 ? 'dark' : 'light' });
      await page.evaluate('resized[0]');
    }
  });

  test('tells of an opacity that is no number until it is one', async () => {
    const before = await picture();
    const error = () => page.evaluate<string>('part(".error").hidden ? "" : part(".error").textContent');
    assert.equal(
      await page.evaluate('viewer.setAttribute("opacity", "abc"); next()'),
      'error cagecast-viewer: opacity is "abc", not a number',
    );
    assert.equal(await error(), 'cagecast-viewer: opacity is "abc", not a number');
    await page.evaluate('viewer.setAttribute("opacity", "1")');
    assert.equal(await error(), '');
    assert.deepEqual(await picture(), before);
    await page.evaluate('viewer.removeAttribute("opacity")');
  });

  test('goes on telling of an opacity when another paint comes, and exports the one that is shown', async () => {
    const before = await picture();
    assert.match(await page.evaluate('viewer.setAttribute("opacity", "5"); next()'), /^error .*5 is not a number/);
    const file = join(user, 'opacity.glb');
    writeFileSync(file, await bytesOf('viewer.exportGlb().then((glb) => text(new Blob([glb])))'));
    assert.deepEqual(await validate(file), []);
    await page.evaluate(`(async () => {
      viewer.setAttribute("paint", "paint-war-paint.png");
      while (!told.includes("load")) await next();
    })()`);
    assert.match(await page.innerText('cagecast-viewer [role=alert]'), /5 is not a number/);
    // The error of something else stays when the opacity is mended.
    assert.match(await page.evaluate('viewer.setAttribute("paint", "none.png"); next()'), /^error paint: .*none/);
    await page.evaluate('viewer.removeAttribute("opacity")');
    assert.match(await page.innerText('cagecast-viewer [role=alert]'), /none\.png/);
    await page.evaluate('viewer.setAttribute("paint", "paint-tiger.png"); next()');
    assert.ok(await page.isHidden('cagecast-viewer [role=alert]'), 'no error is left');
    assert.deepEqual(await picture(), before);
  });

  test('tells of an orbit that is none, once, until it is one', async () => {
    const before = await picture();
    const alert = page.locator('cagecast-viewer [role=alert]:visible');
    const set = (value: string) =>
      page.evaluate<string[]>(
        `told.length = 0; viewer.setAttribute("camera-orbit", "${value}"); Promise.resolve().then(() => told)`,
      );
    const wrongs = ['left', '90deg 80deg 1.5m', '1.5rad', '20deg 80deg 0%', '20deg 80deg -100%', '1 2 3 4', 'deg'];
    const sentence = (wrong: string) =>
      `cagecast-viewer: camera-orbit is "${wrong}", not angles and a distance such as 20deg 80deg 100%`;
    for (const wrong of wrongs) {
      assert.deepEqual(await set(wrong), [`error ${sentence(wrong)}`]);
      assert.equal(await alert.innerText(), sentence(wrong));
    }
    // From the beginning, too.
    const target = await page.evaluate<string>('viewer.getAttribute("target")');
    for (const address of ['cage.glb', target]) {
      const told = await page.evaluate<string[]>(`(async () => {
        told.length = 0;
        const loaded = new Promise((done) => viewer.addEventListener('load', done, { once: true }));
        viewer.setAttribute("target", "${address}");
        await loaded;
        return told;
      })()`);
      assert.deepEqual(told, [`error ${sentence(wrongs.at(-1)!)}`, 'load']);
    }
    for (const [right, isOther] of [
      ['', false],
      ['20', false],
      [' 20deg  80 100% ', false],
      ['-.5e1deg 80.5', true],
    ] as const) {
      await page.evaluate(`viewer.setAttribute("camera-orbit", "${right}")`);
      assert.equal(await alert.count(), 0, right);
      assert.equal((await picture()).equals(before), !isOther, right);
    }
    await page.evaluate('viewer.removeAttribute("camera-orbit")');
    assert.deepEqual(await picture(), before);
  });

  test('leaves the camera where it is at another transfer of the same model, and places it for another model', async () => {
    const placed = await picture();
    await page.evaluate('viewer.focus()');
    await page.keyboard.press('ArrowRight');
    const turned = await picture();
    assert.notDeepEqual(turned, placed);
    await page.evaluate('viewer.setAttribute("threshold", "0.4"); next()');
    await page.evaluate('viewer.removeAttribute("threshold"); next()');
    assertSameModel(await picture(), turned);
    const target = await page.evaluate<string>('viewer.getAttribute("target")');
    await page.evaluate('viewer.setAttribute("target", "cage.glb"); next()');
    await page.evaluate(`viewer.setAttribute("target", "${target}"); next()`);
    assertSameModel(await picture(), placed);
  });

  test('shows its poster again when its target is taken away', async () => {
    const target = await page.evaluate<string>('viewer.getAttribute("target")');
    await page.evaluate('viewer.setAttribute("poster", "paint-tiger.png"); viewer.removeAttribute("target")');
    assert.ok(await page.isVisible('cagecast-viewer .poster'), 'nothing is shown');
    await page.evaluate(`viewer.setAttribute("target", "${target}"); next()`);
    assert.ok(await page.isHidden('cagecast-viewer .poster'), 'the model is shown');
    await page.evaluate('viewer.removeAttribute("poster")');
  });

  test('exports what is shown, not what cannot be loaded', async () => {
    const target = await page.evaluate<string>('viewer.getAttribute("target")');
    const exported = () => bytesOf('viewer.exportGlb().then((glb) => text(new Blob([glb])))');
    const before = await exported();
    const told = await page.evaluate('viewer.setAttribute("target", "none.glb"); next()');
    const after = await exported();
    assert.equal(await page.evaluate(`viewer.setAttribute("target", ${JSON.stringify(target)}); next()`), 'load');
    assert.match(told as string, /^error .*none\.glb/);
    // The exporter numbers what it writes.
    assert.ok(Math.abs(after.length - before.length) < 100, `${after.length}, ${before.length}`);
  });

  test('goes on telling that the model cannot be loaded when another paint comes', async () => {
    const before = await picture();
    const target = await page.evaluate<string>('viewer.getAttribute("target")');
    const set = (name: string, value: string) =>
      page.evaluate<string>(`viewer.setAttribute(${JSON.stringify(name)}, ${JSON.stringify(value)}); next()`);
    assert.match(await set('target', 'none.glb'), /^error .*none\.glb/);
    assert.match(await set('paint', 'paint-war-paint.png'), /^error .*none\.glb/);
    assert.equal(await set('target', target), 'load');
    assert.equal(await set('paint', 'paint-tiger.png'), 'load');
    assertSameModel(await picture(), before);
  });

  test('exports what is shown, even if its paint changes meanwhile', async () => {
    const exported = await bytesOf(`(async () => {
      const done = viewer.exportGlb();
      viewer.setAttribute("paint", "paint-war-paint.png");
      await next();
      const glb = await done;
      viewer.setAttribute("paint", "paint-tiger.png");
      await next();
      return text(new Blob([glb]));
    })()`);
    assert.match(exported.toString('latin1'), /"images":\[/);
  });

  test('takes a model from an object URL', async () => {
    const target = await page.evaluate<string>('viewer.getAttribute("target")');
    const told = await page.evaluate(
      `(async () => {
        const file = await (await fetch(${JSON.stringify(target)})).blob();
        viewer.setAttribute('target', URL.createObjectURL(file));
        return next();
      })()`,
    );
    assert.equal(told, 'load');
    await page.evaluate(`viewer.setAttribute('target', ${JSON.stringify(target)}); next()`);
  });

  test('shows half-transparent paint as it is', async () => {
    const before = await picture();
    const told = await page.evaluate(
      `(async () => {
        const canvas = new OffscreenCanvas(4, 4);
        const context = canvas.getContext('2d');
        context.fillStyle = 'rgb(255 255 255 / 0.25)';
        context.fillRect(0, 0, 4, 4);
        viewer.setAttribute('paint', URL.createObjectURL(await canvas.convertToBlob()));
        return next();
      })()`,
    );
    assert.equal(told, 'load');
    const light = brightness(await picture());
    await page.evaluate('viewer.removeAttribute("paint"); next()');
    const bare = brightness(await picture());
    await page.evaluate('viewer.setAttribute("paint", "paint-tiger.png"); next()');
    assert.deepEqual(await picture(), before);
    assert.ok(light > bare, `a veil of white makes the model lighter: ${light}, ${bare}`);
  });

  test('does not show a paint that comes after a later one', async () => {
    const before = await picture();
    const told = await page.evaluate<string[]>(
      `(async () => {
        const decode = globalThis.createImageBitmap;
        let release;
        const held = new Promise((done) => (release = done));
        const begun = new Promise((begin) => {
          globalThis.createImageBitmap = async (...given) => {
            globalThis.createImageBitmap = decode;
            begin();
            await held;
            return decode(...given);
          };
        });
        viewer.setAttribute("paint", "paint-war-paint.png");
        await begun;
        viewer.setAttribute("paint", "paint-tiger.png");
        await next();
        release();
        await new Promise((done) => setTimeout(done, 200));
        return told;
      })()`,
    );
    assert.deepEqual(told, ['load']);
    assert.deepEqual(await picture(), before);
  });

  test('says that the graphics context is lost, and draws again once it is back', async () => {
    const before = await picture();
    // It cannot be restored before the event has ended. What waits for a second or more waits until it is let go.
    await page.evaluate(`
      globalThis.waiting = [];
      globalThis.setTimeout = ((set) => (run, time = 0) => (time < 1000 ? set(run, time) : waiting.push(run)))(setTimeout);
      globalThis.event = (name) => new Promise((done) => part('canvas').addEventListener(name, () => setTimeout(done), { once: true }));
      globalThis.extension = part('canvas').getContext('webgl2').getExtension('WEBGL_lose_context');
      told.length = 0;
      const lost = event('webglcontextlost');
      extension.loseContext();
      lost`);
    const alert = page.locator('cagecast-viewer [role=alert]:visible');
    assert.match(await alert.innerText({ timeout: 5000 }), /the browser has stopped this 3D view/);
    assert.match(await page.evaluate('told.join()'), /^error cagecast-viewer: the browser has stopped this 3D view/);
    assert.match(await page.evaluate('viewer.toBlob().then(() => "a picture", String)'), /has stopped this 3D view/);
    await page.evaluate(`
      const restored = event('webglcontextrestored');
      extension.restoreContext();
      restored`);
    assert.equal(await alert.count(), 0);
    await seen(page);
    assert.deepEqual(await picture(), before);
    assert.equal(await page.evaluate('told.length = 0; for (const run of waiting.splice(0)) run(); told.length'), 0);
    assert.deepEqual(await picture(), before);
  });

  test('is loaded again where it stays in view and its context does not come back, once; then when it is seen again', async () => {
    const before = await picture();
    const told = await page.evaluate<string[]>(`(async () => {
      const stop = async () => {
        told.length = 0;
        const lost = event('webglcontextlost');
        part('canvas').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext();
        await lost;
      };
      const goOn = () => { for (const run of waiting.splice(0)) run(); };
      const loaded = async () => { for (let i = 0; i < 3000 && !told.includes('load'); ++i) await new Promise((done) => setTimeout(done, 20)); };
      const frames = async () => { for (let i = 0; i < 2; ++i) await new Promise((done) => requestAnimationFrame(() => setTimeout(done))); };
      const kinds = () => told.map((text) => text.split(' ')[0]).join();
      const shows = async (isShown) => {
        Object.defineProperty(document, 'hidden', { value: !isShown, configurable: true });
        document.dispatchEvent(new Event('visibilitychange'));
        await frames();
      };
      const seen = [];
      await stop();
      goOn();
      await loaded();
      await frames();
      seen.push('stays in view: ' + kinds());
      await stop();
      goOn();
      await frames();
      seen.push('again: ' + kinds());
      told.length = 0;
      await shows(false);
      await shows(true);
      await loaded();
      seen.push('the page is shown again: ' + kinds());
      await shows(false);
      await stop();
      goOn();
      await frames();
      seen.push('hidden: ' + kinds());
      await shows(true);
      await loaded();
      delete document.hidden;
      return seen;
    })()`);
    assert.deepEqual(told, [
      'stays in view: error,load',
      'again: error',
      'the page is shown again: load',
      'hidden: error',
    ]);
    assertSameModel(await picture(), before);
  });

  test('says that the page has more 3D views than the browser allows, and draws again when it is put in anew', async () => {
    const before = await picture();
    const alert = page.locator('cagecast-viewer [role=alert]:visible');
    await page.evaluate(
      'globalThis.others = Array.from({ length: 16 }, () => document.createElement("canvas").getContext("webgl2")); 0',
    );
    assert.match(await alert.innerText({ timeout: 5000 }), /more of them than it allows/);
    await page.evaluate('for (const other of others) other.getExtension("WEBGL_lose_context")?.loseContext()');
    await page.evaluate(`(async () => {
      const place = viewer.parentNode;
      viewer.remove();
      await new Promise((done) => setTimeout(done));
      place.append(viewer);
      await next();
    })()`);
    assert.equal(await alert.count(), 0);
    assertSameModel(await picture(), before);
    assert.match(warnings.splice(0).join(), /too many/i);
  });

  test('is loaded again when it comes into view after the browser has stopped it', async () => {
    const before = await picture();
    const alert = page.locator('cagecast-viewer [role=alert]:visible');
    await page.evaluate(
      'globalThis.others = Array.from({ length: 16 }, () => document.createElement("canvas").getContext("webgl2")); 0',
    );
    await alert.waitFor({ timeout: 5000 });
    const frame = 'new Promise((done) => requestAnimationFrame(() => setTimeout(done)))';
    const told = await page.evaluate<string[]>(`(async () => {
      viewer.hidden = true;
      // One for the observer, and one for what it has seen.
      for (let i = 0; i < 2; ++i) await ${frame};
      viewer.hidden = false;
      told.length = 0;
      for (let i = 0; i < 2; ++i) await ${frame};
      if (told.length === 0 && !part('.error:not([hidden])')) await next();
      return told;
    })()`);
    await page.evaluate('for (const other of others) other.getExtension("WEBGL_lose_context")?.loseContext()');
    assert.deepEqual(told, ['load']);
    assert.equal(await alert.count(), 0);
    assertSameModel(await picture(), before);
    assert.match(warnings.splice(0).join(), /too many/i);
  });

  test('shows what is wrong, by attribute and address; the last change wins', async () => {
    const many = new GlbMaker();
    const mesh = many.mesh(tetrahedron());
    for (let n = 0; n < 2000; ++n) many.node({ mesh });
    writeFileSync(join(user, 'out/web-component/many.glb'), many.finish());
    const wrong: [string, string, RegExp][] = [
      ['target', 'missing.glb', /^error target: http.*missing\.glb: 404/],
      [
        'target',
        'many.glb',
        /^error target: http.*many\.glb cannot be read \(.* 2000 places .*; the limit "instances" is 1,000\)$/,
      ],
      ['cage', 'paint-tiger.png', /^error cage: http.*paint-tiger\.png cannot be read/],
      ['paint', 'cage.glb', /^error paint: http.*cage\.glb is not a picture/],
      ['feather', 'wide', /^error cagecast-viewer: feather is "wide", not a number/],
    ];
    for (const [name, value, message] of wrong) {
      const before = await page.evaluate<string | null>(`viewer.getAttribute("${name}")`);
      const said = await page.evaluate<string>(`viewer.setAttribute("${name}", "${value}"); next()`);
      assert.match(said, message);
      assert.equal(await page.evaluate('part("[role=alert]").textContent'), said.replace('error ', ''));
      // What would fail is given up; only the last is loaded.
      const told = await page.evaluate<string[]>(
        `(async () => {
          const was = ${JSON.stringify(before)};
          viewer.setAttribute("${name}", "other-${value}");
          await new Promise((done) => setTimeout(done));
          was === null ? viewer.removeAttribute("${name}") : viewer.setAttribute("${name}", was);
          await next();
          await new Promise((done) => setTimeout(done, 100));
          return told;
        })()`,
      );
      assert.deepEqual(told, ['load'], name);
      assert.ok(await page.isHidden('cagecast-viewer [role=alert]'));
    }
  });

  test('frees its graphics when it leaves the page, and comes back', async () => {
    const lost = await page.evaluate(
      `(async () => {
        const [canvas, place] = [part('canvas'), viewer.parentNode];
        viewer.remove();
        await new Promise((done) => setTimeout(done, 50));
        const lost = canvas.getContext('webgl2').isContextLost();
        for (let i = 0; i < 20; ++i) {
          const other = document.createElement('cagecast-viewer');
          other.setAttribute('target', 'target.glb');
          place.append(other);
          await new Promise((done) => setTimeout(done));
          other.remove();
          await new Promise((done) => setTimeout(done));
        }
        place.append(viewer);
        await next();
        return lost;
      })()`,
    );
    assert.equal(lost, true);
    assert.ok(orange(await picture()) > 400);
    assert.deepEqual(
      warnings.filter((text) => /too many/i.test(text)),
      [],
    );
    assert.deepEqual(
      faults.filter((text) => !/missing/.test(text)),
      [],
    );
  });
});
