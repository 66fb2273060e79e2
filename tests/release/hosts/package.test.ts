import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import {
  cpSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  rmSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { setTimeout } from 'node:timers/promises';
import { gzipSync } from 'node:zlib';
import { head } from '../../package/scenes.js';
import { launchChromium } from '../../support/chromium.js';
import { glbOf } from '../../support/gltf.js';

/** An empty folder of a user, into which the packed package is installed as npm does it, without a network. */
const user = mkdtempSync(join(tmpdir(), 'cagecast-user-'));
const installed = join(user, 'node_modules/cagecast');
const tools = resolve('node_modules');

/** What every host must print: it uses only what the package exports. */
const program = `
import { init, transfer, project, classify, Zone, CagecastError } from 'cagecast';
await init();
const mesh = (z) => ({ positions: new Float32Array([0, 0, z, 1, 0, z, 0, 1, z]), indices: new Uint32Array([0, 1, 2]), uvs: new Float32Array([0, 0, 1, 0, 0, 1]) });
const { uvs, zones } = transfer(mesh(0.1), mesh(0));
const decided = classify(project(mesh(0.1), mesh(0)), { threshold: 0.2 });
let code;
try { transfer(mesh(0.1), { positions: new Float32Array([NaN, 0, 0]), indices: new Uint32Array(3) }); } catch (error) { code = error instanceof CagecastError && error.code; }
globalThis.answer = JSON.stringify([[...uvs], [...zones], [...decided.zones], Zone.Culled, code]);
`;
const answer = '[[0,0,1,0,0,1],[0,0,0],[0,0,0],3,"nonFinitePosition"]';

const slimProgram = program.replace("'cagecast'", "'cagecast/slim'");
const cutProgram = `
import { cutBorders, init, transfer, CagecastError } from 'cagecast/slim';
await init();
const mesh = (z) => ({ positions: new Float32Array([0, 0, z, 1, 0, z, 0, 1, z]), indices: new Uint32Array([0, 1, 2]), uvs: new Float32Array([0, 0, 1, 0, 0, 1]) });
const { triangles, cosmeticTriangles } = await cutBorders(mesh(0.1), mesh(0), transfer(mesh(0.1), mesh(0)));
let refused;
try { cutBorders(mesh(0.1), mesh(0), {}); } catch (error) { refused = error; }
globalThis.answer = JSON.stringify([triangles.length > 0, triangles.every((t) => t === 0), cosmeticTriangles.every((one) => one === 1), refused instanceof CagecastError]);
`;
const cutAnswer = '[true,true,true,true]';
const cagesProgram = `
import { CagecastError, loadTemplate, makeCage } from 'cagecast/cages';
const positions = [], indices = [];
for (let r = 0; r <= 8; ++r) for (let s = 0; s < 16; ++s) {
  const [theta, phi, sine] = [(Math.PI * r) / 8, (Math.PI * s) / 8, r % 8 === 0 ? 0 : Math.sin((Math.PI * r) / 8)];
  positions.push(sine * Math.cos(phi), Math.cos(theta), sine * Math.sin(phi));
  const [a, b] = [16 * r + s, 16 * r + ((s + 1) % 16)];
  if (r < 8) indices.push(a, b, a + 16, b, b + 16, a + 16);
}
const model = { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
const shares = [];
const cage = await makeCage(model, { triangles: 100, voxels: 40, onProgress: (share) => shares.push(share) });
let code;
try { await makeCage({ ...model, indices: new Uint32Array(0) }); } catch (error) { code = error instanceof CagecastError && error.code; }
const template = await loadTemplate('car');
globalThis.answer = JSON.stringify([cage.indices.length > 100, cage.uvs.length / 2 === cage.positions.length / 3, shares.at(-1), code, template.kind]);
`;
const cagesAnswer = '[true,true,1,"badModel","prop"]';
const workerProgram = program
  .replace("'cagecast'", "'cagecast/worker'")
  .replaceAll(/(transfer|classify|project)\(mesh/g, 'await $1(mesh')
  .replace('classify(await', 'await classify(await');

const syncProgram = `
import { defaultExclusions, init, makeCage } from 'cagecast/cages/sync';
await init();
const model = { positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]), indices: new Uint32Array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]) };
globalThis.answer = JSON.stringify([defaultExclusions().length > 0, makeCage(model, { triangles: 100, voxels: 40 }).indices.constructor.name]);
`;

function run(command: string, args: string[], cwd = user): string {
  const { status, stdout, stderr } = spawnSync(command, args, {
    cwd,
    encoding: 'utf8',
    env: { ...process.env, NODE_OPTIONS: '' },
  });
  assert.equal(status, 0, `${command} ${args.join(' ')}:\n${stdout}${stderr}`);
  return stdout;
}

const distFiles = () =>
  (readdirSync(join(installed, 'dist'), { recursive: true }) as string[]).filter((name) => extname(name) !== '');

before(() => {
  const [packed] = JSON.parse(
    run('npm', ['pack', '--json', '--ignore-scripts', '--pack-destination', user], process.cwd()),
  ) as [{ filename: string }];
  writeFileSync(join(user, 'package.json'), '{ "private": true, "type": "module" }');
  run('npm', ['install', '--offline', '--no-audit', '--no-fund', '--ignore-scripts', join(user, packed.filename)]);
  writeFileSync(join(user, 'program.js'), program);
  writeFileSync(join(user, 'print.js'), "await import('./program.js'); console.log(globalThis.answer);");
});
after(() => rmSync(user, { recursive: true, force: true }));

describe('the packed package', () => {
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
      assert.ok(existsSync(join(installed, file)), file);
    const top = readdirSync(installed).filter(
      (name) => !/^(dist|package\.json|README\.md|LICENSE|CHANGELOG\.md)$/.test(name),
    );
    assert.deepEqual(top, []);
    for (const name of distFiles()) assert.match(name, /\.(js|js\.map|d\.ts|wasm|glb|txt)$/);
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

  test('what makes cages is loaded only when it is asked for, and has at most 250 KB, gzipped', (context) => {
    const sizeOf = (name: string) => gzipSync(readFileSync(join(installed, 'dist', name)), { level: 9 }).length;
    const loaded = sizeOf('cages-thread.js') + sizeOf('cagecast-cages.wasm');
    context.diagnostic(`worker and WebAssembly: ${loaded} bytes, gzipped`);
    assert.ok(loaded <= 250 * 1024, `${loaded} bytes`);
    for (const name of ['index', 'slim', 'worker', 'inspect'])
      assert.doesNotMatch(readFileSync(join(installed, `dist/${name}.js`), 'utf8'), /cages\.js|cages-thread/, name);
  });

  test('asks engines to compile its index as they read it: they look for that at the very beginning', () => {
    for (const name of ['index', 'slim'])
      assert.match(readFileSync(join(installed, `dist/${name}.js`), 'utf8'), /^\/\/# allFunctionsCalledOnLoad\n/);
  });

  test('its entries for three.js and glTF-Transform, inspect run and type-check beside these', () => {
    const folder = join(user, 'peers');
    mkdirSync(join(folder, 'node_modules/@types'), { recursive: true });
    mkdirSync(join(folder, 'node_modules/@gltf-transform'));
    symlinkSync(installed, join(folder, 'node_modules/cagecast'));
    // property-graph is what @gltf-transform/core stands on.
    for (const name of ['three', '@types/three', '@gltf-transform/core', 'property-graph'])
      symlinkSync(join(tools, name), join(folder, 'node_modules', name));
    writeFileSync(join(folder, 'package.json'), '{ "type": "module" }');
    writeFileSync(
      join(folder, 'program.ts'),
      `import { Document } from '@gltf-transform/core';
      import { BoxGeometry, Group, Mesh, SphereGeometry, Texture } from 'three';
      import { cutBorders, type CutTarget, init, type Mesh as Arrays } from 'cagecast';
      import { cagecast } from 'cagecast/gltf';
      import { inspect, type Inspection, type Verdict } from 'cagecast/inspect';
      import { applyTransfer, extract, type Applied } from 'cagecast/three';
      await init();
      const scene = new Group().add(new Mesh(new BoxGeometry(1, 1, 1, 3, 3, 3)));
      const cage = new SphereGeometry(1, 16, 8, 0, 2 * Math.PI, 0, 2);
      // Before its vertices are split.
      const { positions, indices, ...rest } = extract(scene).mesh;
      const applied: Applied = applyTransfer(scene, cage, { texture: new Texture(), threshold: 0.3 });
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
      const { cutTriangles }: Applied = applyTransfer(box, cage, { borders: 'cut', threshold: 0.3, seams: 'vertex' });
      // @ts-expect-error a cage is needed
      void (() => cagecast({}));
      console.log(verdict !== undefined, cutTriangles > 0 && cut.triangles.length - indices.length / 3 === cutTriangles, applied.splitVertices > 0, applied.overlays.length, primitive.listSemantics().join());`,
    );
    run(
      join(tools, 'esbuild/bin/esbuild'),
      ['program.ts', '--format=esm', '--outfile=program.js', '--log-level=warning'],
      folder,
    );
    assert.equal(
      run(process.execPath, ['--preserve-symlinks', '--preserve-symlinks-main', 'program.js'], folder).trim(),
      'true true true 0 POSITION,TEXCOORD_0,_NCZ',
    );
    // Without skipLibCheck the types of three would be checked as well, which is not ours to do.
    const compilerOptions = {
      module: 'esnext',
      moduleResolution: 'bundler',
      target: 'es2022',
      lib: ['es2022', 'dom'],
      strict: true,
      exactOptionalPropertyTypes: true,
      noEmit: true,
      types: [],
      skipLibCheck: true,
      preserveSymlinks: true,
    };
    writeFileSync(join(folder, 'tsconfig.json'), JSON.stringify({ compilerOptions, files: ['program.ts'] }));
    run(process.execPath, [join(tools, '@typescript/native/bin/tsc'), '-p', 'tsconfig.json'], folder);
  });

  test('runs in Node', () => assert.equal(run(process.execPath, ['print.js']).trim(), answer));

  test('its other entries run in Node: slim, alone and with borders, the worker, and those that make cages', () => {
    for (const [entry, text, expected] of [
      ['slim', slimProgram, answer],
      ['cut', cutProgram, cutAnswer],
      ['worker', workerProgram, answer],
      ['cages', cagesProgram, cagesAnswer],
      ['cages-sync', syncProgram, '[true,"Uint32Array"]'],
    ] as const) {
      writeFileSync(join(user, `${entry}.js`), `${text}; console.log(globalThis.answer);`);
      assert.equal(run(process.execPath, [`${entry}.js`]).trim(), expected, entry);
    }
  });

  test('runs in a worker thread of Node', () => {
    writeFileSync(
      join(user, 'threads.js'),
      `import { Worker, isMainThread, parentPort } from 'node:worker_threads';
      import { fileURLToPath } from 'node:url';
      if (isMainThread) new Worker(fileURLToPath(import.meta.url)).on('message', (text) => console.log(text));
      else { await import('./program.js'); parentPort.postMessage(globalThis.answer); }`,
    );
    assert.equal(run(process.execPath, ['threads.js']).trim(), answer);
  });

  test('runs bundled by esbuild, for the browser and for Node', () => {
    for (const platform of ['browser', 'node']) {
      run(join(tools, 'esbuild/bin/esbuild'), [
        'print.js',
        '--bundle',
        '--format=esm',
        `--platform=${platform}`,
        `--outfile=out-${platform}.js`,
        '--log-level=warning',
      ]);
      assert.equal(run(process.execPath, [`out-${platform}.js`]).trim(), answer);
    }
  });

  for (const [name, compilerOptions] of Object.entries({
    bundler: { module: 'esnext', moduleResolution: 'bundler' },
    nodenext: { module: 'nodenext', moduleResolution: 'nodenext' },
  })) {
    test(`its types check a consumer, strictly, without skipLibCheck (${name})`, () => {
      const folder = join(user, `types-${name}`);
      mkdirSync(folder);
      writeFileSync(join(folder, 'package.json'), '{ "type": "module" }');
      writeFileSync(
        join(folder, 'tsconfig.json'),
        JSON.stringify({
          compilerOptions: {
            ...compilerOptions,
            target: 'es2022',
            lib: ['es2022', 'dom'],
            strict: true,
            exactOptionalPropertyTypes: true,
            noEmit: true,
            types: [],
            skipLibCheck: false,
          },
          files: ['consumer.ts'],
        }),
      );
      writeFileSync(
        join(folder, 'consumer.ts'),
        `import { init, transfer, project, classify, Zone, CagecastError, type Code, type Mesh, type TransferResult, type Projection, type Classification, type SegmentStats, type Timings, type TransferOptions } from 'cagecast';
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
        void [first, timings, again, buffers, zone];`,
      );
      run(process.execPath, [join(tools, '@typescript/native/bin/tsc'), '-p', 'tsconfig.json'], folder);
    });
  }

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
  let origin = '';
  const types: Record<string, string> = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };
  const server = createServer((request, response) => {
    const path = join(pages, new URL(request.url ?? '/', 'http://localhost').pathname);
    if (!existsSync(path)) return response.writeHead(404).end();
    response
      .writeHead(200, {
        'content-type': types[extname(path)] ?? 'application/octet-stream',
        'content-security-policy': policy,
      })
      .end(readFileSync(path));
  });

  before(async () => {
    mkdirSync(pages, { recursive: true });
    // As it is, through Vite, and in a worker.
    run(join(tools, 'esbuild/bin/esbuild'), [
      'program.js',
      '--bundle',
      '--format=esm',
      '--outfile=pages/plain.js',
      '--log-level=warning',
    ]);
    for (const [entry, text] of Object.entries({
      main: program,
      slim: slimProgram,
      cut: cutProgram,
      worker: workerProgram,
      cages: cagesProgram,
    })) {
      const site = join(user, `site-${entry}`);
      mkdirSync(site);
      writeFileSync(join(site, 'index.html'), '<!doctype html><script type="module" src="/main.js"></script>');
      writeFileSync(join(site, 'main.js'), text);
      symlinkSync(join(user, 'node_modules'), join(site, 'node_modules'));
      writeFileSync(
        join(site, 'vite.config.js'),
        "export default { build: { target: 'es2022', assetsInlineLimit: 0 }, worker: { format: 'es' } };",
      );
      run(
        process.execPath,
        [
          join(tools, 'vite/bin/vite.js'),
          'build',
          '--logLevel',
          'warn',
          '--outDir',
          join(pages, `vite-${entry}`),
          '--base',
          `/vite-${entry}/`,
        ],
        site,
      );
    }
    // esbuild leaves alone what `new URL` names: these files are served beside the script.
    writeFileSync(join(user, 'cages.js'), cagesProgram);
    run(join(tools, 'esbuild/bin/esbuild'), [
      'cages.js',
      '--bundle',
      '--format=esm',
      '--outfile=pages/esbuild-cages/main.js',
      '--log-level=warning',
    ]);
    for (const name of ['cages-thread.js', 'cagecast-cages.wasm', 'templates'])
      cpSync(join(installed, 'dist', name), join(pages, 'esbuild-cages', name), { recursive: true });
    writeFileSync(
      join(pages, 'esbuild-cages/index.html'),
      '<!doctype html><script type="module" src="/esbuild-cages/main.js"></script>',
    );
    writeFileSync(join(pages, 'plain.html'), '<!doctype html><script type="module" src="/plain.js"></script>');
    writeFileSync(join(pages, 'worker.html'), '<!doctype html><script type="module" src="/start.js"></script>');
    writeFileSync(
      join(pages, 'start.js'),
      "new Worker('/worker.js', { type: 'module' }).onmessage = ({ data }) => { globalThis.answer = data; };",
    );
    writeFileSync(join(pages, 'worker.js'), "import '/plain.js'; postMessage(globalThis.answer);");
    await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
    const address = server.address();
    assert.ok(address !== null && typeof address === 'object');
    origin = `http://127.0.0.1:${address.port}`;
  });
  after(() => server.close());

  test('every entry runs: bundled by esbuild, built by Vite, in a worker of the page and in its own', async () => {
    const browser = await launchChromium({ drawing: false });
    try {
      for (const path of [
        '/plain.html',
        '/worker.html',
        '/vite-main/index.html',
        '/vite-slim/index.html',
        '/vite-cut/index.html',
        '/vite-worker/index.html',
        '/vite-cages/index.html',
        '/esbuild-cages/index.html',
      ]) {
        const page = await browser.newPage();
        const faults: string[] = [];
        page.on('pageerror', (error) => faults.push(String(error)));
        page.on(
          'console',
          (message) => message.type() === 'error' && !/404/.test(message.text()) && faults.push(message.text()),
        );
        await page.goto(origin + path);
        // Playwright's own waiting evaluates strings in the page, which the policy forbids.
        let found: unknown;
        for (
          const deadline = Date.now() + 60000;
          found === undefined && faults.length === 0 && Date.now() < deadline;
          await setTimeout(50)
        ) {
          found = await page.evaluate('globalThis.answer');
        }
        assert.deepEqual(faults, [], path);
        assert.equal(found, path.includes('cut') ? cutAnswer : path.includes('cages') ? cagesAnswer : answer, path);
        await page.close();
      }
    } finally {
      await browser.close();
    }
  });
});
