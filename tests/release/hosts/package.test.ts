import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { extname, join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { build } from 'vite';
import { head } from '../../package/scenes.js';
import { launchChromium } from '../../support/chromium.js';
import { glbOf } from '../../support/gltf.js';
import { serve } from '../../support/serve.js';
import {
  answer,
  answerOf,
  checkTypes,
  coreAnswer,
  coreScript,
  installPacked,
  linkPackages,
  programOf,
  run as runIn,
} from './install.js';

const user = installPacked();
const installed = join(user, 'node_modules/cagecast');
const tools = resolve('node_modules');
const tsc = join(tools, '@typescript/native');

const run = (command: string, args: string[], cwd = user): string => runIn(command, args, cwd);
/** Bundles with esbuild. */
const bundle = (file: string, out: string, ...flags: string[]) =>
  run(join(tools, 'esbuild/bin/esbuild'), [
    ...[file, '--bundle', '--format=esm', `--outfile=${out}`, '--log-level=warning'],
    ...flags,
  ]);
/** What a script prints in Node. */
const printed = (name: string, text: string): string => {
  writeFileSync(join(user, name), text);
  return run(process.execPath, [name]).trim();
};
const print = 'console.log(JSON.stringify(globalThis.answer));';

const distFiles = () =>
  (readdirSync(join(installed, 'dist'), { recursive: true }) as string[]).filter((name) => extname(name) !== '');

after(() => rmSync(user, { recursive: true, force: true }));

describe('the packed package', () => {
  test('has short lines, as Node shows the one of an error that nobody catches', () => {
    for (const name of distFiles().filter((one) => one.endsWith('.js'))) {
      const lines = readFileSync(join(installed, 'dist', name), 'utf8').split('\n');
      assert.ok(Math.max(...lines.map(({ length }) => length)) < 3000, name);
    }
  });

  test('needs nothing else', () => {
    const manifest = JSON.parse(readFileSync(join(installed, 'package.json'), 'utf8')) as Record<string, unknown>;
    for (const name of ['dependencies', 'optionalDependencies', 'bundledDependencies'])
      assert.equal(manifest[name], undefined, name);
    // What is made for three.js or glTF-Transform takes the user's own; who uses neither needs neither.
    const optional = manifest['peerDependenciesMeta'] as Record<string, { optional: boolean }>;
    for (const name of Object.keys(manifest['peerDependencies'] as object))
      assert.equal(optional[name]?.optional, true, name);
    for (const script of ['preinstall', 'install', 'postinstall', 'prepare'])
      assert.equal((manifest['scripts'] as Record<string, string>)[script], undefined, script);
    assert.deepEqual(
      readdirSync(join(user, 'node_modules')).filter((name) => !name.startsWith('.')),
      ['cagecast'],
    );
  });

  test('has the files that its manifest names, and no others', () => {
    const { exports, bin } = JSON.parse(readFileSync(join(installed, 'package.json'), 'utf8')) as {
      exports: Record<string, unknown>;
      bin: Record<string, string>;
    };
    const promised = (value: unknown): string[] =>
      typeof value === 'string' ? [value] : Object.values(value as object).flatMap(promised);
    for (const file of [...promised(exports), ...Object.values(bin)])
      assert.ok(existsSync(join(installed, file.replace('*', 'human-head.glb'))), file);
    const top = readdirSync(installed).filter(
      (name) => !/^(dist|package\.json|README\.md|LICENSE|CHANGELOG\.md)$/.test(name),
    );
    assert.deepEqual(top, []);
    for (const name of distFiles()) assert.match(name, /\.(c?js|js\.map|d\.ts|wasm|glb|txt)$/);
  });

  test('contains nothing about the machine it was built on', () => {
    const places = [process.cwd(), process.env['HOME'] ?? ''].filter((place) => place.length > 3);
    // As whole paths: `/src` is a part of names that have nothing to do with it.
    const wholePath = (place: string) =>
      new RegExp(`(?<![\\w.-])${place.replace(/[.*+?^${}()|[\]\\]/g, '\\$&')}(?![\\w.-])`);
    for (const name of distFiles()) {
      const text = readFileSync(join(installed, 'dist', name), 'latin1');
      for (const place of places)
        assert.ok(
          !(name.endsWith('.wasm') ? text.includes(`${place}/`) : wholePath(place).test(text)),
          `${name} names ${place}`,
        );
    }
  });

  test('what makes cages is loaded only when it is asked for, and has at most 256 KB, gzipped', (context) => {
    const sizeOf = (name: string) => gzipSync(readFileSync(join(installed, 'dist', name)), { level: 9 }).length;
    const loaded = sizeOf('cages-thread.js') + sizeOf('cagecast-cages.wasm');
    context.diagnostic(`worker and WebAssembly: ${loaded} bytes, gzipped`);
    assert.ok(loaded <= 256 * 1024, `${loaded} bytes`);
    for (const name of ['index', 'slim', 'worker', 'inspect'])
      assert.doesNotMatch(readFileSync(join(installed, `dist/${name}.js`), 'utf8'), /cages\.js|cages-thread/, name);
  });

  test('asks engines to compile its index as they read it: they look for that at the very beginning', () => {
    for (const name of ['index', 'slim'])
      assert.match(readFileSync(join(installed, `dist/${name}.js`), 'utf8'), /^\/\/# allFunctionsCalledOnLoad\n/);
  });

  test('its entries for three.js and glTF-Transform, inspect run and type-check beside these', () => {
    const folder = join(user, 'peers');
    // property-graph is what @gltf-transform/core stands on.
    linkPackages(folder, ['three', '@types/three', '@gltf-transform/core', 'property-graph']);
    linkPackages(folder, ['cagecast'], join(user, 'node_modules'));
    const program = `import { Document } from '@gltf-transform/core';
      import { BoxGeometry, Group, Mesh, SphereGeometry, Texture } from 'three';
      import { cutBorders, type CutTarget, init, inspect, type Inspection, type Mesh as Arrays, type Verdict } from 'cagecast';
      import { cagecast } from 'cagecast/gltf';
      import { applyTransfer, extract, type Applied } from 'cagecast/three';
      await init();
      const scene = new Group().add(new Mesh(new BoxGeometry(1, 1, 1, 3, 3, 3)));
      const cage = new SphereGeometry(1, 16, 8, 0, 2 * Math.PI, 0, 2);
      // Before its vertices are split.
      const { positions, indices, ...rest } = extract(scene).mesh;
      const applied: Applied = applyTransfer(scene, { cage, texture: new Texture(), threshold: 0.3 });
      const arrays: Arrays = extract(cage, 'cage').mesh;
      const inspection: Inspection = inspect(arrays, { positions, indices, ...rest }, { result: applied.result });
      const verdict: Verdict = inspection.verdict;
      const cut: CutTarget = cutBorders(arrays, { positions, indices, ...rest }, applied.result, { threshold: 0.3, seams: 'vertex' });
      const document = new Document();
      const buffer = document.createBuffer();
      const accessor = (array: Float32Array | Uint32Array, type: 'VEC3' | 'SCALAR') => document.createAccessor().setType(type).setArray(new (array.constructor as Float32ArrayConstructor)(array)).setBuffer(buffer);
      const primitive = document.createPrimitive().setAttribute('POSITION', accessor(positions, 'VEC3')).setIndices(accessor(indices, 'SCALAR'));
      document.createScene().addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
      await document.transform(cagecast({ cage: arrays }));
      const box = new Group().add(new Mesh(new BoxGeometry(1, 1, 1, 3, 3, 3)));
      const { cutTriangles }: Applied = applyTransfer(box, { cage, borders: 'cut', threshold: 0.3, seams: 'vertex' });
      // @ts-expect-error no such option
      void (() => cagecast({ cag: arrays }));
      console.log(verdict !== undefined, cutTriangles > 0 && cut.triangles.length - indices.length / 3 === cutTriangles, applied.splitVertices > 0, applied.overlays.length, primitive.listSemantics().join());`;
    // Without skipLibCheck the types of three would be checked as well, which is not ours to do.
    const types = {
      module: 'esnext',
      moduleResolution: 'bundler',
      exactOptionalPropertyTypes: true,
      skipLibCheck: true,
    };
    checkTypes(tsc, folder, program, types);
    run(
      join(tools, 'esbuild/bin/esbuild'),
      ['program.ts', '--format=esm', '--outfile=program.js', '--log-level=warning'],
      folder,
    );
    assert.equal(
      run(process.execPath, ['--preserve-symlinks', '--preserve-symlinks-main', 'program.js'], folder).trim(),
      'true true true 0 POSITION,TEXCOORD_0,_NCZ',
    );
  });

  test('has types for the events and the tag of its element, and for its WebAssembly and templates', () => {
    const program = `import { type Check, CagecastViewer } from 'cagecast/viewer';
      import module from 'cagecast/cagecast.wasm';
      import cagesModule from 'cagecast/cagecast-cages.wasm';
      import head from 'cagecast/templates/human-head.glb';
      import { init } from 'cagecast';
      import * as cages from 'cagecast/cages';
      export const ready = Promise.all([init({ module }), cages.init({ module: cagesModule })]);
      export const bytes: Uint8Array = new Uint8Array(head);
      const viewer = document.querySelector('cagecast-viewer')!;
      viewer.addEventListener('verdict', ({ detail }) => { const check: Check = detail; console.log(check.verdict); });
      viewer.addEventListener('error', (event) => { const { message }: Error = event.detail; console.log(message); });
      viewer.addEventListener('progress', ({ detail: { share, stage } }) => console.log(share.toFixed(), stage.length));
      viewer.addEventListener('keydown', ({ key }) => console.log(key));
      // @ts-expect-error no such finding
      viewer.addEventListener('verdict', ({ detail }) => detail.verdit);
      document.body.append(viewer, new CagecastViewer());
      export const element: HTMLElement = viewer;
    `;
    const tag = `import type {} from 'cagecast/viewer';
      import type * as React from 'react';
      export const tag: React.JSX.IntrinsicElements['cagecast-viewer'] = {
        target: 'head.glb', 'camera-orbit': '0deg 90deg 100%', className: 'head', onverdict: ({ detail }) => console.log(detail.verdict),
      };
      // @ts-expect-error no such attribute
      export const wrong: React.JSX.IntrinsicElements['cagecast-viewer'] = { targt: 'head.glb' };`;
    const types = {
      module: 'esnext',
      moduleResolution: 'bundler',
      skipLibCheck: true,
      lib: ['es2022', 'dom', 'dom.iterable'],
    };
    for (const [name, text, packages] of [
      ['element', program, []],
      ['tag', tag, ['react', '@types/react', 'csstype']],
    ] as const) {
      const folder = join(user, name);
      linkPackages(folder, ['three', '@types/three', ...packages]);
      linkPackages(folder, ['cagecast'], join(user, 'node_modules'));
      checkTypes(tsc, folder, text, types);
    }
  });

  test('runs in Node, by all of its entries, and in a worker thread', () => {
    for (const entry of ['cagecast', 'cagecast/slim'])
      assert.equal(printed('program.js', `${programOf(entry)} ${print}`), JSON.stringify(answer));
    const here = `
      import { excludedByName, init, makeCage } from 'cagecast/cages';
      await init({ worker: false });
      const model = { positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]), indices: new Uint32Array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]) };
      const cage = await makeCage(model, { triangles: 100, voxels: 40 });
      console.log((await excludedByName(['eye']))[0], cage.indices.constructor.name);`;
    assert.equal(printed('here.js', here), 'true Uint32Array');
    writeFileSync(join(user, 'core.js'), coreScript('cagecast'));
    const threads = `
      import { Worker, isMainThread, parentPort } from 'node:worker_threads';
      import { fileURLToPath } from 'node:url';
      if (isMainThread) new Worker(fileURLToPath(import.meta.url)).on('message', (text) => console.log(text));
      else { await import('./core.js'); parentPort.postMessage(globalThis.answer); }`;
    assert.equal(printed('threads.js', threads), coreAnswer);
  });

  test('runs bundled by esbuild, for the browser and for Node', () => {
    writeFileSync(join(user, 'print.js'), `${coreScript('cagecast')} console.log(globalThis.answer);`);
    for (const platform of ['browser', 'node']) {
      bundle('print.js', `out-${platform}.js`, `--platform=${platform}`);
      assert.equal(run(process.execPath, [`out-${platform}.js`]).trim(), coreAnswer);
    }
  });

  const consumer = `
        import { init, transfer, project, classify, Zone, CagecastError, type Code, type Mesh, type TransferResult, type Projection, type Classification, type SegmentStats, type Timings, type TransferOptions } from 'cagecast';
        await init();
        const mesh: Mesh = { positions: new Float32Array(9), indices: new Uint16Array(3) };
        const options: TransferOptions = { preset: 'paper', threshold: 0.5, steps: { projection: 'nearestPoint' } };
        const result: TransferResult = transfer(mesh, { ...mesh, uvs: new Float32Array(6), groups: new Uint32Array(3) }, options);
        const projection: Projection = project(mesh, mesh, { weldTolerance: 0 });
        const decided: Classification = classify(projection, { threshold: 0.3 });
        const [first]: SegmentStats[] = decided.segmentStats;
        const timings: Timings = result.timings;
        const again: [TransferResult, Projection, Classification] = [transfer(mesh, mesh, { ...options, reuse: result }), project(mesh, mesh, { reuse: projection }), classify(projection, { reuse: decided })];
        const buffers: ArrayBuffer[] = [result.uvs.buffer, result.zones.buffer, result.triangles.buffer, result.cosmeticTriangles.buffer];
        const zone: Zone = Zone.Cosmetic;
        try { transfer(mesh, mesh); } catch (error) { if (error instanceof CagecastError) { const code: Code = error.code; const at: number = error.at; void [code, at]; } }
        // @ts-expect-error positions must be floats
        transfer({ positions: [0, 0, 0], indices: new Uint32Array(3) }, mesh);
        // @ts-expect-error no such option
        transfer(mesh, mesh, { treshold: 0.5 });
        // @ts-expect-error no such preset
        transfer(mesh, mesh, { preset: 'papre' });
        // @ts-expect-error not an answer of this function
        transfer(mesh, mesh, { reuse: projection });
        void [first, timings, again, buffers, zone];`;
  for (const [module, moduleResolution] of [
    ['esnext', 'bundler'],
    ['nodenext', 'nodenext'],
  ])
    test(`its types check a consumer, strictly, without skipLibCheck (${moduleResolution})`, () => {
      const options = { module, moduleResolution, exactOptionalPropertyTypes: true };
      checkTypes(tsc, join(user, `types-${moduleResolution}`), consumer, options);
    });

  test('the command works without anything else', () => {
    const { cage, target } = head(1, 8);
    writeFileSync(join(user, 'target.glb'), glbOf(target));
    writeFileSync(join(user, 'cage.glb'), glbOf(cage));
    const command = join(user, 'node_modules/.bin/cagecast');
    assert.match(
      run(command, ['transfer', 'target.glb', '--cage', 'cage.glb', '-o', 'out.glb', '--report', 'r.json']),
      /wrote out\.glb/,
    );
    assert.ok(existsSync(join(user, 'out.glb')) && existsSync(join(user, 'r.json')));
    assert.match(run(command, ['inspect', 'target.glb', '--cage', 'cage.glb']), /: the cage fits/);
    assert.match(run(command, ['transfer', 'target.glb', '--cage', 'auto', '--report', 'r.json']), /wrote r\.json/);
    const assets = process.env['CAGECAST_ASSETS'];
    // Compressed files need decoders, which must be aboard.
    if (assets !== undefined)
      for (const name of readdirSync(join(assets, 'formats')))
        run(command, ['transfer', join(assets, 'formats', name), '--cage', 'cage.glb']);
  });
});

describe('in a browser, under a strict Content-Security-Policy', () => {
  const policy = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self'; connect-src 'self'";
  const pages = join(user, 'pages');
  let site: Awaited<ReturnType<typeof serve>>;

  before(async () => {
    mkdirSync(pages);
    for (const [name, script] of Object.entries({ plain: 'plain', worker: 'start' }))
      writeFileSync(join(pages, `${name}.html`), `<!doctype html><script type="module" src="/${script}.js"></script>`);
    writeFileSync(join(user, 'core.js'), coreScript('cagecast'));
    bundle('core.js', 'pages/plain.js');
    writeFileSync(
      join(pages, 'start.js'),
      "new Worker('/worker.js', { type: 'module' }).onmessage = ({ data }) => { globalThis.answer = data; };",
    );
    writeFileSync(join(pages, 'worker.js'), "import '/plain.js'; postMessage(globalThis.answer);");
    for (const entry of ['cagecast', 'cagecast/slim']) {
      const root = join(user, entry.replace('/', '-'));
      mkdirSync(root);
      linkPackages(root, ['cagecast'], join(user, 'node_modules'));
      writeFileSync(join(root, 'index.html'), '<!doctype html><script type="module" src="/main.js"></script>');
      writeFileSync(join(root, 'main.js'), programOf(entry));
      await build({
        ...{ root, base: `/vite-${entry}/`, configFile: false, logLevel: 'warn', worker: { format: 'es' } },
        build: { target: 'es2022', assetsInlineLimit: 0, outDir: join(pages, `vite-${entry}`), emptyOutDir: false },
      });
    }
    site = await serve(pages, { 'content-security-policy': policy });
  });
  after(() => site?.close());

  test('every entry runs: bundled by esbuild, built by Vite, in a worker of the page and in its own', async () => {
    const browser = await launchChromium({ drawing: false });
    try {
      for (const [path, expected] of [
        ['plain.html', coreAnswer],
        ['worker.html', coreAnswer],
        ['vite-cagecast/index.html', answer],
        ['vite-cagecast/slim/index.html', answer],
      ] as const)
        assert.deepEqual(await answerOf(browser, `${site.origin}/${path}`), expected, path);
    } finally {
      await browser.close();
    }
  });
});
