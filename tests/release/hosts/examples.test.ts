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
import { serve } from '../../support/serve.js';
import { installPacked, run } from './install.js';

const user = installPacked();
/** The examples, and the folder of models that lies beside each. */
const built: Record<string, string> = {
  three: 'lizard',
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
    resolve: { dedupe: ['three'] },
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

/** Waits until what is drawn has enough of the paint, and nothing went wrong. */
async function seen({ page, faults }: { page: Page; faults: string[] }): Promise<void> {
  let count = 0;
  for (const end = Date.now() + 30000; count < 400 && Date.now() < end; ) count = orange(await page.screenshot());
  assert.ok(count >= 400, `${count} pixels`);
  assert.deepEqual(faults, []);
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

  for (const name of [...Object.keys(built).filter((one) => one !== 'web-component'), 'import-map'])
    test(`${name} shows the paint`, async () => {
      const visit = await open(`${sites[name === 'import-map' ? 1 : 0]!.origin}/${name}/index.html`);
      await seen(visit);
      const { page, faults } = visit;
      if (name === 'worker') {
        // The second visit needs no cage.
        let cages = 0;
        page.on('request', (request) => (cages += Number(request.url().endsWith('cage.glb'))));
        const again = async () => {
          await page.reload();
          await painted(page, faults);
        };
        await again();
        assert.equal(cages, 0);
        // What an earlier version kept is replaced.
        await page.evaluate('caches.open("cagecast").then((cache) => cache.put("transfer", new Response("old")))');
        await again();
        await again();
        assert.equal(cages, 1);
      }
      assert.deepEqual(faults, []);
      await page.close();
    });

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
      const visit = await open(server.resolvedUrls!.local[0]!);
      await seen(visit);
      await visit.page.close();
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
      globalThis.place = viewer.parentNode;
      globalThis.part = (selector) => viewer.shadowRoot.querySelector(selector);
      globalThis.told = [];
      globalThis.steps = 0;
      globalThis.listen = (element, told) => {
        for (const type of ['load', 'error']) element.addEventListener(type, ({ detail }) => told.push(detail ? type + ' ' + detail.message : type));
      };
      globalThis.task = () => new Promise((done) => setTimeout(done));
      globalThis.frames = async () => { for (let i = 0; i < 2; ++i) await new Promise((done) => requestAnimationFrame(() => setTimeout(done))); };
      globalThis.next = async () => { told.length = 0; while (told.length === 0) await new Promise((done) => setTimeout(done, 20)); return told[0]; };
      globalThis.loaded = async () => { for (let i = 0; i < 3000 && !told.includes('load'); ++i) await new Promise((done) => setTimeout(done, 20)); return told; };
      globalThis.set = (attributes) => {
        told.length = 0;
        for (const [name, value] of Object.entries(attributes)) value === null ? viewer.removeAttribute(name) : viewer.setAttribute(name, value);
      };
      globalThis.text = (blob) => new Promise((done) => { const reader = new FileReader(); reader.onload = () => done(reader.result.split(',')[1]); reader.readAsDataURL(blob); });
      globalThis.event = (name) => new Promise((done) => part('canvas').addEventListener(name, () => setTimeout(done), { once: true }));
      globalThis.crowd = () => { globalThis.others = Array.from({ length: 16 }, () => document.createElement('canvas').getContext('webgl2')); };
      globalThis.leave = () => { for (const other of others) other.getExtension('WEBGL_lose_context')?.loseContext(); };
      listen(viewer, told);
      viewer.addEventListener('progress', () => ++steps);`);
  });
  after(() => page?.close());

  const inPage = <T = string>(script: string): Promise<T> => page.evaluate<T>(`(async () => { ${script} })()`);
  const bytesOf = async (script: string) => Buffer.from(await inPage(`return text(${script})`), 'base64');
  const picture = () => bytesOf('await viewer.toBlob()');
  const exported = () => bytesOf('new Blob([await viewer.exportGlb()])');
  const alert = () => page.locator('cagecast-viewer [role=alert]:visible');
  type Attributes = Record<string, string | null>;
  const set = (attributes: Attributes) => inPage<void>(`set(${JSON.stringify(attributes)})`);
  /** Sets attributes, or removes them. @returns what the element says next. */
  const said = (attributes: Attributes) => inPage(`set(${JSON.stringify(attributes)}); return next()`);
  /** What it says until it has loaded. */
  const saidUntilLoad = (attributes: Attributes) =>
    inPage<string[]>(`set(${JSON.stringify(attributes)}); return loaded()`);
  const [target, tiger, war] = ['target.glb', 'paint-tiger.png', 'paint-war-paint.png'];

  /**
   * A test that leaves the element as it was.
   * @param is  Compares pictures; `assertSameModel` where the model is loaded anew.
   */
  const steady = (
    name: string,
    body: (picture: Buffer) => Promise<void>,
    is = assert.deepEqual as typeof assertSameModel,
  ) =>
    test(name, async () => {
      const before = await picture();
      await body(before);
      is(await picture(), before);
      assert.equal(await alert().count(), 0, 'no error is left');
    });

  test('shows the painted model and says whether the cage fits', async () => {
    await seen({ page, faults });
    await page
      .getByRole('status')
      .getByText(/^The cage is (good|usable)\.$/)
      .waitFor();
    assert.ok(orange(await picture()) > 400);
  });

  test('has a role and a label, and nothing that axe-core complains about', async () => {
    assert.deepEqual(await inPage('return ["role", "aria-label"].map((name) => part("canvas").getAttribute(name))'), [
      'img',
      'The head of a lizard with the stripes of a tiger',
    ]);
    await page.evaluate(readFileSync('node_modules/axe-core/axe.min.js', 'utf8'));
    assert.deepEqual(await inPage('return (await axe.run()).violations.map(({ id }) => id)'), []);
  });

  steady('is turned by keys, and goes back', async (before) => {
    await inPage('viewer.focus()');
    for (const key of ['ArrowRight', 'ArrowUp', '+']) {
      const last = await picture();
      await page.keyboard.press(key);
      assert.notDeepEqual(await picture(), last, key);
    }
    await page.keyboard.press('Home');
    assert.deepEqual(await picture(), before);
    await set({ 'camera-orbit': '90deg 80deg 150%' });
    assert.notDeepEqual(await picture(), before);
    await set({ 'camera-orbit': null });
  });

  test('of an element that shows nothing, a picture is refused by the promise', async () => {
    const refused = await inPage('return document.createElement("cagecast-viewer").toBlob().catch(String)');
    assert.match(refused, /^Error: toBlob: .* shows nothing yet/);
  });

  test('exports a valid model with its paint', async () => {
    const file = await exported();
    assert.deepEqual(await validate(file), []);
    assert.match(file.toString('latin1'), /"images":\[/);
  });

  steady('follows its attributes: opacity and paint without another transfer', async (before) => {
    await inPage('steps = 0');
    await set({ opacity: '0' });
    assert.ok(orange(await picture()) < orange(before) / 2);
    await set({ opacity: null });
    assert.deepEqual(await picture(), before);
    await said({ paint: war });
    assert.notDeepEqual(await picture(), before);
    await said({ paint: tiger });
    assert.deepEqual(await picture(), before);
    // Two in quick succession, too.
    await inPage(`set({ paint: "${war}" }); await Promise.resolve(); set({ paint: "${tiger}" }); return next()`);
    assert.equal(await inPage<number>('return steps'), 0);
  });

  steady(
    'loads what could not be loaded for its opacity once that is right',
    async () => {
      const wrong = await said({ opacity: '2', target: 'cage.glb' });
      assert.match(wrong, /^error .*\bopacity is 2, not a number from 0 to 1$/);
      assert.equal(await said({ opacity: '1' }), 'load');
      assert.equal(await alert().count(), 0);
      await said({ opacity: null, target });
    },
    assertSameModel,
  );

  test('tells of a wrong opacity once where it is there from the beginning', async () => {
    const told = await inPage<string[]>(`
      const other = document.createElement('cagecast-viewer');
      const told = [];
      listen(other, told);
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
      place.append(other);
      await read;
      other.setAttribute('opacity', '0.5');
      while (!told.includes('load')) await new Promise((done) => setTimeout(done, 20));
      other.remove();
      return told;`);
    assert.deepEqual(told, ['error cagecast-viewer: opacity is "abc", not a number', 'load']);
  });

  test('frees pictures and buffers of what is not shown any more, and of what could not be loaded', async () => {
    const { live, buffers } = await inPage<{ live: string[]; buffers: number[] }>(`
      let live = 0, held = 0;
      const make = createImageBitmap;
      const { close } = ImageBitmap.prototype;
      globalThis.createImageBitmap = (...args) => (++live, make(...args));
      ImageBitmap.prototype.close = function () {
        if (this.width > 0) --live;
        close.call(this);
      };
      const { createBuffer, deleteBuffer } = WebGL2RenderingContext.prototype;
      WebGL2RenderingContext.prototype.createBuffer = function () { ++held; return createBuffer.call(this); };
      WebGL2RenderingContext.prototype.deleteBuffer = function (buffer) {
        if (buffer) --held;
        deleteBuffer.call(this, buffer);
      };
      const seen = [], buffers = [];
      for (const threshold of ['0.4', 'none', '0.5', 'some', '0.6']) {
        set({ threshold });
        const said = await next();
        await new Promise((done) => setTimeout(done, 200));
        seen.push(said.split(' ')[0] + ' ' + live);
        buffers.push(held);
      }
      globalThis.createImageBitmap = make;
      ImageBitmap.prototype.close = close;
      Object.assign(WebGL2RenderingContext.prototype, { createBuffer, deleteBuffer });
      set({ threshold: null });
      await next();
      return { live: seen, buffers };`);
    assert.deepEqual(live, ['load 0', 'error 0', 'load 0', 'error 0', 'load 0']);
    assert.equal(buffers[4], buffers[2], 'as many buffers as with the model before');
  });

  test('takes a model from an object URL, and stays as it is where it is moved, even if that leads nowhere by now', async () => {
    const told = await inPage(`
      const address = URL.createObjectURL(await (await fetch("${target}")).blob());
      set({ target: address });
      const told = await next();
      URL.revokeObjectURL(address);
      viewer.focus();
      return told;`);
    assert.equal(told, 'load');
    await page.keyboard.press('ArrowRight');
    const before = await picture();
    const later =
      'told.length = 0; place.append(viewer); await new Promise((done) => setTimeout(done, 300)); return told';
    assert.deepEqual(await inPage(later), []);
    assert.deepEqual(await picture(), before);
    assert.match((await exported()).toString('latin1'), /"images":\[/);
    await said({ target });
  });

  steady('is shown as before in the document of a frame', async (before) => {
    const styles = () =>
      inPage<string[]>(`return [viewer, part('canvas'), part('.error')].map((element) => {
        const { display, position } = getComputedStyle(element);
        return display + ' ' + position;
      })`);
    const usual = await styles();
    await inPage(`
      globalThis.frame = document.createElement('iframe');
      place.append(frame);
      frame.contentDocument.body.append(viewer);`);
    const [within, shownWithin] = [await styles(), await picture()];
    await inPage('place.append(viewer); frame.remove()');
    assert.deepEqual([within, await styles()], [usual, usual]);
    assert.deepEqual(shownWithin, before);
  });

  test('shows all of the model where it is narrow, also if it was wide or hidden before', async () => {
    const at = async (width: string) => {
      await inPage(`viewer.style.width = "${width}"; await frames()`);
      return orange(await picture());
    };
    const plain = orange(await picture());
    const narrow = await at('120px');
    await set({ 'camera-orbit': '20deg 80deg 100%' });
    await set({ 'camera-orbit': null });
    const placed = orange(await picture());
    const near = (is: number, want: number, why: string) =>
      assert.ok(Math.abs(is - want) < 0.02 * want, `${is}, ${why}: ${want}`);
    near(narrow, placed, 'as if it was placed when it was narrow');
    near(await at(''), plain, 'as before');
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

  steady('tells of an opacity that is no number until it is one', async () => {
    const sentence = 'cagecast-viewer: opacity is "abc", not a number';
    assert.equal(await said({ opacity: 'abc' }), `error ${sentence}`);
    assert.equal(await alert().innerText(), sentence);
    await set({ opacity: '1' });
    assert.equal(await alert().count(), 0);
    await set({ opacity: null });
  });

  steady('goes on telling of an opacity when another paint comes, and exports the one that is shown', async () => {
    assert.match(await said({ opacity: '5' }), /^error .*opacity is 5, not a number/);
    assert.deepEqual(await validate(await exported()), []);
    await saidUntilLoad({ paint: war });
    assert.match(await alert().innerText(), /opacity is 5, not a number/);
    // The error of something else stays when the opacity is mended.
    assert.match(await said({ paint: 'none.png' }), /^error paint: .*none/);
    await set({ opacity: null });
    assert.match(await alert().innerText(), /none\.png/);
    await said({ paint: tiger });
  });

  steady('tells of an orbit that is none, once, until it is one', async (before) => {
    const wrongs = ['left', '90deg 80deg 1.5m', '1.5rad', '20deg 80deg 0%', '20deg 80deg -100%', '1 2 3 4', 'deg'];
    const sentence = (wrong: string) =>
      `cagecast-viewer: camera-orbit is "${wrong}", not angles and a distance such as 20deg 80deg 100%`;
    for (const wrong of wrongs) {
      await set({ 'camera-orbit': wrong });
      assert.deepEqual(await inPage('return told'), [`error ${sentence(wrong)}`]);
      assert.equal(await alert().innerText(), sentence(wrong));
    }
    // From the beginning, too.
    for (const address of ['cage.glb', target])
      assert.deepEqual(await saidUntilLoad({ target: address }), [`error ${sentence(wrongs.at(-1)!)}`, 'load']);
    for (const [right, isOther] of [
      ['', false],
      ['20', false],
      [' 20deg  80 100% ', false],
      ['-.5e1deg 80.5', true],
    ] as const) {
      await set({ 'camera-orbit': right });
      assert.equal(await alert().count(), 0, right);
      assert.equal((await picture()).equals(before), !isOther, right);
    }
    await set({ 'camera-orbit': null });
  });

  steady(
    'leaves the camera where it is at another transfer of the same model, and places it for another model',
    async (placed) => {
      await inPage('viewer.focus()');
      await page.keyboard.press('ArrowRight');
      const turned = await picture();
      assert.notDeepEqual(turned, placed);
      await said({ threshold: '0.4' });
      await said({ threshold: null });
      assertSameModel(await picture(), turned);
      await said({ target: 'cage.glb' });
      await said({ target });
    },
    assertSameModel,
  );

  steady(
    'shows its poster again when its target is taken away',
    async () => {
      await set({ poster: tiger, target: null });
      assert.ok(await page.isVisible('cagecast-viewer .poster'), 'nothing is shown');
      await said({ target });
      assert.ok(await page.isHidden('cagecast-viewer .poster'), 'the model is shown');
      await set({ poster: null });
    },
    assertSameModel,
  );

  steady(
    'exports what is shown, not what cannot be loaded; goes on telling of it when another paint comes',
    async () => {
      const before = await exported();
      assert.match(await said({ target: 'none.glb' }), /^error .*none\.glb/);
      const after = await exported();
      // The exporter numbers what it writes.
      assert.ok(Math.abs(after.length - before.length) < 100, `${after.length}, ${before.length}`);
      assert.match(await said({ paint: war }), /^error .*none\.glb/);
      assert.equal(await said({ target }), 'load');
      assert.equal(await said({ paint: tiger }), 'load');
    },
    assertSameModel,
  );

  steady(
    'exports a model of which a part is left out',
    async () => {
      assert.equal(await said({ ignore: 'tongue', keep: 'l-eye' }), 'load');
      assert.match((await exported()).toString('latin1'), /"images":\[/);
      assert.equal(await said({ ignore: null, keep: null }), 'load');
    },
    assertSameModel,
  );

  test('exports what is shown, even if its paint changes meanwhile', async () => {
    const glb = Buffer.from(
      await inPage(`
        const done = viewer.exportGlb();
        set({ paint: "${war}" });
        await next();
        const glb = await done;
        set({ paint: "${tiger}" });
        await next();
        return text(new Blob([glb]));`),
      'base64',
    );
    assert.match(glb.toString('latin1'), /"images":\[/);
  });

  steady('shows half-transparent paint as it is', async () => {
    const told = await inPage(`
      const canvas = new OffscreenCanvas(4, 4);
      const context = canvas.getContext('2d');
      context.fillStyle = 'rgb(255 255 255 / 0.25)';
      context.fillRect(0, 0, 4, 4);
      set({ paint: URL.createObjectURL(await canvas.convertToBlob()) });
      return next();`);
    assert.equal(told, 'load');
    const light = brightness(await picture());
    await said({ paint: null });
    const bare = brightness(await picture());
    await said({ paint: tiger });
    assert.ok(light > bare, `a veil of white makes the model lighter: ${light}, ${bare}`);
  });

  steady('does not show a paint that comes after a later one', async () => {
    const told = await inPage<string[]>(`
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
      set({ paint: "${war}" });
      await begun;
      set({ paint: "${tiger}" });
      await next();
      release();
      await new Promise((done) => setTimeout(done, 200));
      return told;`);
    assert.deepEqual(told, ['load']);
  });

  steady('says that the graphics context is lost, and draws again once it is back', async (before) => {
    // It cannot be restored before the event has ended. What waits for a second or more waits until it is let go.
    await inPage(`
      globalThis.waiting = [];
      globalThis.goOn = () => { for (const run of waiting.splice(0)) run(); };
      globalThis.setTimeout = ((set) => (run, time = 0) => (time < 1000 ? set(run, time) : waiting.push(run)))(setTimeout);
      globalThis.stop = async () => {
        told.length = 0;
        const lost = event('webglcontextlost');
        globalThis.extension = part('canvas').getContext('webgl2').getExtension('WEBGL_lose_context');
        extension.loseContext();
        await lost;
      };
      await stop();`);
    assert.match(await alert().innerText({ timeout: 5000 }), /the browser has stopped this 3D view/);
    assert.match(await inPage('return told.join()'), /^error cagecast-viewer: the browser has stopped this 3D view/);
    assert.match(await inPage('return viewer.toBlob().then(() => "a picture", String)'), /has stopped this 3D view/);
    await inPage(`const restored = event('webglcontextrestored'); extension.restoreContext(); await restored`);
    assert.equal(await alert().count(), 0);
    await seen({ page, faults: [] });
    assert.deepEqual(await picture(), before);
    assert.equal(await inPage<number>('told.length = 0; goOn(); return told.length'), 0);
  });

  steady(
    'is loaded again where it stays in view and its context does not come back, once; then when it is seen again',
    async () => {
      const told = await inPage<string[]>(`
        const seen = [];
        const note = (when) => seen.push(when + ': ' + told.map((text) => text.split(' ')[0]).join());
        const stopForGood = async () => { await stop(); goOn(); };
        const shows = async (isShown) => {
          Object.defineProperty(document, 'hidden', { value: !isShown, configurable: true });
          document.dispatchEvent(new Event('visibilitychange'));
          await frames();
        };
        await stopForGood();
        await loaded();
        await frames();
        note('stays in view');
        await stopForGood();
        await frames();
        note('again');
        told.length = 0;
        await shows(false);
        await shows(true);
        await loaded();
        note('the page is shown again');
        await shows(false);
        await stopForGood();
        await frames();
        note('hidden');
        await shows(true);
        await loaded();
        delete document.hidden;
        return seen;`);
      const expected = ['stays in view: error,load', 'again: error', 'the page is shown again: load', 'hidden: error'];
      assert.deepEqual(told, expected);
    },
    assertSameModel,
  );

  for (const [name, comeBack] of [
    [
      'says that the page has more 3D views than the browser allows, and draws again when it is put in anew',
      'leave(); viewer.remove(); await task(); place.append(viewer); return [await next()]',
    ],
    [
      'is loaded again when it comes into view after the browser has stopped it',
      // Two frames: one for the observer, and one for what it has seen.
      `viewer.hidden = true;
      await frames();
      viewer.hidden = false;
      told.length = 0;
      await frames();
      if (told.length === 0 && !part('.error:not([hidden])')) await next();
      leave();
      return told;`,
    ],
  ] as const)
    steady(
      name,
      async () => {
        await inPage('crowd()');
        assert.match(await alert().innerText({ timeout: 5000 }), /more of them than it allows/);
        assert.deepEqual(await inPage(comeBack), ['load']);
        assert.match(warnings.splice(0).join(), /too many/i);
      },
      assertSameModel,
    );

  test('shows what is wrong, by attribute and address; the last change wins', async () => {
    const many = new GlbMaker();
    const mesh = many.mesh(tetrahedron());
    for (let n = 0; n < 2000; ++n) many.node({ mesh });
    writeFileSync(join(user, 'out/web-component/many.glb'), many.finish());
    const tooMany = /many\.glb cannot be read \(.* 2000 places .*; the limit "instances" is 1,000\)$/;
    for (const [name, value, message] of [
      ['target', 'missing.glb', /^error target: http.*missing\.glb: 404/],
      ['target', 'many.glb', new RegExp(`^error target: http.*${tooMany.source}`)],
      ['cage', tiger, /^error cage: http.*paint-tiger\.png cannot be read/],
      ['paint', 'cage.glb', /^error paint: http.*cage\.glb is not a picture/],
      ['feather', 'wide', /^error cagecast-viewer: feather is "wide", not a number/],
    ] as const) {
      const before = await inPage<string | null>(`return viewer.getAttribute("${name}")`);
      const wrong = await said({ [name]: value });
      assert.match(wrong, message);
      assert.equal(await alert().textContent(), wrong.replace('error ', ''));
      // What would fail is given up; only the last is loaded.
      const told = await inPage<string[]>(`
        set({ ${name}: "other-${value}" });
        await task();
        set(${JSON.stringify({ [name]: before })});
        await next();
        await new Promise((done) => setTimeout(done, 100));
        return told;`);
      assert.deepEqual(told, ['load'], name);
      assert.equal(await alert().count(), 0);
    }
  });

  test('frees its graphics when it leaves the page, and comes back', async () => {
    const lost = await inPage<boolean>(`
      const canvas = part('canvas');
      viewer.remove();
      await task();
      const lost = canvas.getContext('webgl2').isContextLost();
      for (let i = 0; i < 20; ++i) {
        const other = document.createElement('cagecast-viewer');
        other.setAttribute('target', '${target}');
        place.append(other);
        await task();
        other.remove();
        await task();
      }
      place.append(viewer);
      await next();
      return lost;`);
    assert.equal(lost, true);
    assert.ok(orange(await picture()) > 400);
    const tooMany = warnings.filter((text) => /too many/i.test(text));
    const others = faults.filter((text) => !/missing/.test(text));
    assert.deepEqual([tooMany, others], [[], []]);
  });
});
