import assert from 'node:assert/strict';
import { cpSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import type { Browser } from 'playwright-core';
import { createServer } from 'vite';
import { launchChromium } from '../../support/chromium.js';
import { serve } from '../../support/serve.js';
import { answer, answerOf, checkTypes, hostTools, installPacked, linkPackages, programOf, run } from './install.js';

const user = installPacked();
const dist = join(user, 'node_modules/cagecast/dist');
const page = '<!doctype html><script type="module" src="program.js"></script>';
const manifest = JSON.parse(readFileSync('package.json', 'utf8')) as {
  engines: { node: string };
  exports: Record<string, { types?: string }>;
  typesVersions: { '*': Record<string, string[]> };
};

const program = programOf('cagecast/slim');
/** The same, of the entry with its WebAssembly within. */
const inlined = programOf('cagecast');

const put = (folder: string, files: Record<string, string>) => {
  mkdirSync(join(user, folder), { recursive: true });
  for (const [name, text] of Object.entries(files)) writeFileSync(join(user, folder, name), text);
};

before(() => {
  put('', { 'program.js': program, 'index.html': page });
  put('inlined', { 'program.js': inlined, 'index.html': page });
});
after(() => rmSync(user, { recursive: true, force: true }));

describe('TypeScript before 5.7', () => {
  const entries = [
    'cagecast',
    'cagecast/slim',
    'cagecast/worker',
    'cagecast/engines',
    'cagecast/cages',
    'cagecast/gltf',
  ];
  const consumer = `
    type IsAny<T> = 0 extends 1 & T ? true : false;
    type Anys<T> = { [K in keyof T]-?: IsAny<T[K]> extends true ? K : never }[keyof T];
    import { type Classification, type CutTarget, init, inspect, type Inspection, type Mesh, type Projection, type SplitVertices, transfer, type TransferResult } from 'cagecast';
    import { transfer as transferAsync } from 'cagecast/worker';
    import { makeCage, type Cage } from 'cagecast/cages';
    import { applyTransfer, type Applied, type Extracted } from 'cagecast/three';
    import { cagecast } from 'cagecast/gltf';
    type All = [Classification, CutTarget, Mesh, Projection, SplitVertices, TransferResult, Cage, Applied, Extracted, Extracted['mesh'], Inspection, ReturnType<typeof applyTransfer>];
    const none: [{ [K in keyof All]: Anys<All[K]> }[number], IsAny<typeof cagecast>, IsAny<typeof inspect>] extends [never, false, false] ? true : 'any' = true;
    export async function main(mesh: Mesh) {
      await init();
      const result: TransferResult = transfer(mesh, mesh);
      const cage: Cage = await makeCage(mesh);
      const numbers: Float32Array[] = [result.uvs, (await transferAsync(mesh, mesh)).uvs, cage.uvs];
      // @ts-expect-error numbers have no such method
      result.uvs.notThere();
      // @ts-expect-error nor have zones
      result.zones[0]?.notThere();
      return [none, numbers];
    }`;
  const checked: [string, string, string][] = [
    ['5.0', 'esnext', 'node'],
    ['5.0', 'node16', 'node16'],
    ['5.0', 'esnext', 'bundler'],
    ['5.6', 'node16', 'node16'],
  ];
  test('those that do not read exports find the types of every entry', () => {
    const exported = Object.entries(manifest.exports).flatMap(([name, { types }]) =>
      types && name !== '.' ? [[name.slice(2), [types]]] : [],
    );
    assert.deepEqual(manifest.typesVersions['*'], Object.fromEntries(exported));
  });

  test('no declaration has what they do not know, or a type of three.js, which has other parameters in r165', () => {
    for (const name of readdirSync(dist, { recursive: true, encoding: 'utf8' }))
      if (name.endsWith('.d.ts'))
        assert.doesNotMatch(
          readFileSync(join(dist, name), 'utf8'),
          /\b(\w+\d+Array|DataView)<Array|import\("three"\)/,
          name,
        );
  });

  for (const [version, module, moduleResolution] of checked)
    test(`${version} sees no any, with moduleResolution ${moduleResolution}`, () => {
      const folder = join(user, `types-${version}-${moduleResolution}`);
      const tsc = join(hostTools, `typescript-${version}`);
      linkPackages(folder, ['three', '@types/three', '@gltf-transform/core', 'property-graph']);
      // The types of three.js and glTF-Transform are for newer ones.
      checkTypes(tsc, folder, consumer, { module, moduleResolution, skipLibCheck: true });
      // Its own types are checked too, where no others are needed.
      const all = entries.map((name, i) => `export * as e${i} from '${name}';`).join('\n');
      if (moduleResolution === 'node16') checkTypes(tsc, folder, all, { module, moduleResolution });
    });
});

describe('hosts without a browser', () => {
  test('Jest, with modules switched on', () => {
    put('jest', {
      'jest.config.json': '{ "transform": {}, "testEnvironment": "node" }',
      'program.js': program,
      'some.test.js': `import { answer } from './program.js';
        test('runs', () => expect(answer).toEqual(${JSON.stringify(answer)}));`,
    });
    const flags = { NODE_OPTIONS: '--experimental-vm-modules' };
    const said = run(process.execPath, [join(hostTools, 'jest/bin/jest.js'), '--ci', '-i'], join(user, 'jest'), flags);
    assert.match(said, /1 passed/);
  });

  test('the Node that runs these tests is one that the package admits to', () => {
    const [major = 0, minor = 0] = process.versions.node.split('.').map(Number);
    assert.equal(manifest.engines.node, '^20.16.0 || >=22.3.0');
    assert.ok(major > 22 || (major === 22 && minor >= 3) || (major === 20 && minor >= 16));
    // What all uses of Node stand on: Node 20.16 and 22.3 brought it.
    assert.ok(process.getBuiltinModule('node:worker_threads'));
  });
});

describe('in Chromium', () => {
  let browser: Browser;
  let site: Awaited<ReturnType<typeof serve>>;
  before(async () => {
    site = await serve(user);
    browser = await launchChromium({ drawing: false });
  });
  after(async () => {
    await browser?.close();
    site?.close();
  });

  const visit = (path: string, origin = site.origin) => answerOf(browser, `${origin}/${path}`);

  test('an import map of the public names', async () => {
    const at = (file: string) => `/node_modules/cagecast/dist/${file}.js`;
    const imports = Object.fromEntries(['slim', 'worker', 'cages'].map((name) => [`cagecast/${name}`, at(name)]));
    put('map', {
      'program.js': program,
      'index.html': page.replace(
        '<script',
        `<script type="importmap">${JSON.stringify({ imports: { cagecast: at('index'), ...imports } })}</script><script`,
      ),
    });
    assert.deepEqual(await visit('map/index.html'), answer);
  });

  test('an import map of another origin, such as a CDN', async () => {
    const elsewhere = await serve(user, { 'access-control-allow-origin': '*' });
    const at = (file: string) => `${elsewhere.origin}/node_modules/cagecast/dist/${file}.js`;
    const imports = Object.fromEntries(['slim', 'worker', 'cages'].map((name) => [`cagecast/${name}`, at(name)]));
    const map = JSON.stringify({ imports: { cagecast: at('index'), ...imports } });
    put('cdn', {
      'program.js': program,
      'index.html': page.replace('<script', `<script type="importmap">${map}</script><script`),
    });
    try {
      assert.deepEqual(await visit('cdn/index.html'), answer);
    } finally {
      elsewhere.close();
    }
  });

  test('Vite, in development', async () => {
    put('dev', { 'program.js': program, 'index.html': page });
    const settings = { configFile: false, logLevel: 'error', server: { port: 0, host: '127.0.0.1' } } as const;
    const server = await createServer({ ...settings, root: join(user, 'dev'), cacheDir: join(user, 'dev/.vite') });
    await server.listen();
    try {
      assert.deepEqual(await visit('index.html', server.resolvedUrls!.local[0]!.replace(/\/$/, '')), answer);
    } finally {
      await server.close();
    }
  });

  test('Parcel', async () => {
    const options = [
      '--dist-dir',
      'parcel',
      '--public-url',
      './',
      '--no-source-maps',
      '--no-cache',
      '--no-autoinstall',
    ];
    for (const [entry, out] of [
      ['index.html', 'parcel'],
      ['inlined/index.html', 'parcel-inlined'],
    ] as const) {
      run(
        process.execPath,
        [join(hostTools, 'parcel/lib/bin.js'), 'build', entry, ...options, '--dist-dir', out],
        user,
      );
      assert.deepEqual(await visit(`${out}/index.html`), answer, entry);
    }
  });

  test('webpack, whose script is a classic one, on a page in UTF-8; on another, the error says so', async () => {
    const classic = '<script src="program.js"></script>';
    for (const [entry, out] of [
      ['./program.js', 'webpack'],
      ['./inlined/program.js', 'webpack-inlined'],
    ]) {
      const settings = { entry, mode: 'production', output: { path: join(user, out!), filename: 'program.js' } };
      const script = `require(${JSON.stringify(join(hostTools, 'webpack'))})(${JSON.stringify(settings)}, (fault, stats) => {
        if (fault || stats.hasErrors()) throw fault ?? stats.toString();
      })`;
      run(process.execPath, ['-e', script], user);
      put(out!, {
        'index.html': `<!doctype html><meta charset="utf-8">${classic}`,
        'other.html': `<!doctype html>${classic}`,
      });
      assert.deepEqual(await visit(`${out}/index.html`), answer, entry);
    }
    const [said] = (await visit('webpack-inlined/other.html')) as string[];
    assert.equal(
      said,
      'init: the script of Cagecast was read in another encoding than UTF-8; its page needs <meta charset="utf-8">',
    );
  });

  /** What `docs/hosts.md` says is to be copied beside a script that was made by esbuild or Rollup. */
  const copyFiles = (out: string) => {
    for (const name of ['cagecast.wasm', 'cagecast-cages.wasm', 'templates'])
      cpSync(join(dist, name), join(user, out, name), { recursive: true });
    writeFileSync(join(user, out, 'index.html'), page);
  };
  const workers = ['worker-thread', 'cages-thread'];

  test('esbuild, with the workers as entries and the other files copied', async () => {
    const entries = workers.map((name) => `${name}=node_modules/cagecast/dist/${name}.js`);
    const flags = ['--bundle', '--format=esm', '--outdir=app/esbuild', '--log-level=warning'];
    run(resolve('node_modules/esbuild/bin/esbuild'), ['program=program.js', ...entries, ...flags], user);
    copyFiles('app/esbuild');
    assert.deepEqual(await visit('app/esbuild/index.html'), answer);
  });

  test('Rollup, likewise', async () => {
    put('', {
      'rollup.config.js': `import resolve from ${JSON.stringify(join(hostTools, '@rollup/plugin-node-resolve/dist/es/index.js'))};
        export default {
          input: { program: 'program.js', ${workers.map((name) => `'${name}': 'node_modules/cagecast/dist/${name}.js'`).join()} },
          output: { dir: 'rollup', format: 'es', entryFileNames: '[name].js' },
          plugins: [resolve()],
        };`,
    });
    run(process.execPath, [join(hostTools, 'rollup/dist/bin/rollup'), '-c', '--silent'], user);
    copyFiles('rollup');
    assert.deepEqual(await visit('rollup/index.html'), answer);
  });

  test('an error names the file that was not copied, also where the server answers with a page', async () => {
    for (const folder of ['bare', 'app/bare']) {
      mkdirSync(join(user, folder), { recursive: true });
      cpSync(join(user, 'app/esbuild/program.js'), join(user, folder, 'program.js'));
      writeFileSync(join(user, folder, 'index.html'), page);
      const found = (await visit(`${folder}/index.html`)) as string[];
      ['cagecast.wasm', 'worker-thread.js', 'cages-thread.js', 'templates/car.glb'].forEach((name, i) =>
        assert.ok(found[i]!.includes(`${site.origin}/${folder}/${name}`), `${folder}: ${found[i]}`),
      );
    }
  });
});
