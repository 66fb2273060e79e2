// Builds the npm package into dist/: the core as WebAssembly, the TypeScript around it, its types, the CLI.
//   node wasm/tools/build.mjs                        all of it; does nothing if nothing changed
//   node wasm/tools/build.mjs --preset wasm-scalar   only index.js and borders.js, in build/wasm-scalar/package, which tests compare with

import { execFileSync, spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import {
  chmodSync,
  cpSync,
  existsSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  realpathSync,
  renameSync,
  rmSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { delimiter, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { takeApart } from './fused.mjs';

const root = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const at = (...parts) => join(root, ...parts);

const { values } = parseArgs({ options: { preset: { type: 'string', default: 'wasm' } } });
const { preset } = values;
if (preset !== 'wasm' && preset !== 'wasm-scalar')
  fail(`--preset ${preset} is unknown; there are wasm and wasm-scalar`);

const shipped = preset === 'wasm';
const out = shipped ? at('dist') : at('build', preset, 'package');
const stamp = at('build', preset, 'package.stamp');

/** What is loaded when borders are cut, and stays a file of its own. */
const lazy = [
  [/^\.\.\/borders\/index\.js$/, './borders.js'],
  [/^\.\.\/cut\/index\.js$/, './cut.js'],
  [/^\.\/borders\.js$/, './three-borders.js'],
];

const hash = hashOf(
  ['core', 'wasm', 'package.json', 'package-lock.json', 'CMakeLists.txt', 'CMakePresets.json'],
  preset,
);
if (existsSync(stamp) && readFileSync(stamp, 'utf8') === hash && existsSync(join(out, 'index.js'))) {
  linkCommand();
  process.exit(0);
}

console.log(`Building ${shipped ? 'the package' : `the package (${preset})`} …`);
rmSync(stamp, { force: true });
buildWasm();
await buildPackage();
linkCommand();
writeFileSync(stamp, hash);

/**
 * The core and its bindings: build/<preset>/wasm/cagecast.{js,wasm}, and cagecast-borders.{js,wasm}. What is shipped of the
 * WebAssembly, which all engines know, is in plain/ there.
 */
function buildWasm() {
  const emscripten = findEmscripten();
  const env = {
    ...process.env,
    CAGECAST_EMSCRIPTEN: emscripten,
    PATH: [process.env.PATH, emscripten].join(delimiter),
    // Debian's Emscripten finds its copy of acorn only so.
    NODE_PATH: [process.env.NODE_PATH, '/usr/share/nodejs'].filter(Boolean).join(delimiter),
  };
  run('cmake', ['--preset', preset], env);
  run('cmake', ['--build', '--preset', preset], env);
  // Binaryen comes with Emscripten: of emsdk in a folder beside it.
  const folders = [join(emscripten, '../bin'), ...(process.env.PATH ?? '').split(delimiter)];
  const tool = (name) =>
    folders.map((folder) => join(folder, name)).find((file) => existsSync(file)) ??
    fail(`${name} of Binaryen is missing; Debian: apt install binaryen`);
  mkdirSync(at('build', preset, 'wasm/plain'), { recursive: true });
  for (const module of ['cagecast', 'cagecast-borders'])
    takeApart(at('build', preset, `wasm/${module}.wasm`), tool, at('build', preset, `wasm/plain/${module}`));
}

/** The folder that holds Emscripten's CMake toolchain: of emsdk where its environment is set, else of the emcc in PATH. */
function findEmscripten() {
  const folders = [
    process.env.CAGECAST_EMSCRIPTEN,
    process.env.EMSDK && join(process.env.EMSDK, 'upstream/emscripten'),
  ];
  const emcc = (process.env.PATH ?? '')
    .split(delimiter)
    .map((folder) => join(folder, 'emcc'))
    .find((file) => existsSync(file));
  if (emcc) folders.push(dirname(realpathSync(emcc)));
  const found = folders.find((folder) => folder && existsSync(join(folder, 'cmake/Modules/Platform/Emscripten.cmake')));
  return (
    found ??
    fail(
      'Emscripten is missing: emcc is not in PATH. Debian: apt install emscripten; elsewhere: https://emscripten.org (emsdk)',
    )
  );
}

async function buildPackage() {
  const esbuild = await import('esbuild');
  const fresh = at('build', preset, 'package.new');
  rmSync(fresh, { recursive: true, force: true });
  mkdirSync(fresh, { recursive: true });

  const common = {
    bundle: true,
    format: 'esm',
    target: 'es2022',
    minify: true,
    legalComments: 'none',
    logLevel: 'warning',
    absWorkingDir: root,
    define: { CAGECAST_VERSION: JSON.stringify(JSON.parse(readFileSync(at('package.json'), 'utf8')).version) },
  };
  // Nearly all functions of the index are called by the first transfer. Told so, Chromium compiles them as it parses them, on a
  // thread in the background, and not one by one as they are called.
  const eager = { banner: { js: '//# allFunctionsCalledOnLoad' } };
  await esbuild.build({
    ...common,
    ...eager,
    entryPoints: [at('wasm/src/index.ts')],
    outfile: join(fresh, 'index.js'),
    platform: 'neutral',
    plugins: [wasmModules('wasm-inline.ts')],
  });
  await esbuild.build({
    ...common,
    entryPoints: [at('wasm/src/borders/index.ts')],
    outfile: join(fresh, 'borders.js'),
    platform: 'neutral',
    plugins: [wasmModules('wasm-packed.ts', { module: 'cagecast-borders', index: './index.js', errors: true })],
  });
  if (shipped) {
    // What is imported from index.js, by one of the names in package.json's "imports", or from a peer stays a file of its own.
    const beside = (entry, outfile, platform, modules = { index: './index.js', borders: true }, more = {}) =>
      esbuild.build({
        ...common,
        ...more,
        entryPoints: [at('wasm/src', entry)],
        outfile: join(fresh, outfile),
        platform,
        external: ['#spawn', './index.js', 'three'],
        plugins: [wasmModules('wasm-file.ts', modules)],
      });
    await beside('index.ts', 'slim.js', 'neutral', undefined, eager);
    await beside('borders/index.ts', 'slim-borders.js', 'neutral', {
      module: 'cagecast-borders',
      index: './slim.js',
      errors: true,
    });
    for (const [name, file] of Object.entries({
      'read-wasm': 'cagecast.wasm',
      'read-borders-wasm': 'cagecast-borders.wasm',
    })) {
      const more = { define: { ...common.define, CAGECAST_WASM: JSON.stringify(`./${file}`) } };
      await beside('read-wasm.ts', `${name}.js`, 'neutral', {}, more);
      await beside('read-wasm-node.ts', `${name}-node.js`, 'node', {}, more);
      cpSync(at('build', preset, 'wasm/plain', file), join(fresh, file));
      chmodSync(join(fresh, file), 0o644);
    }
    await beside('inspect/index.ts', 'inspect.js', 'neutral');
    await beside('cut/index.ts', 'cut.js', 'neutral');
    await beside('three/index.ts', 'three.js', 'neutral');
    await beside('three/borders.ts', 'three-borders.js', 'neutral');
    await beside('gltf/index.ts', 'gltf.js', 'neutral');
    await beside('worker/index.ts', 'worker.js', 'neutral');
    await beside('worker/spawn.ts', 'spawn.js', 'neutral');
    await beside('worker/spawn-node.ts', 'spawn-node.js', 'node');
    await beside('worker/thread.ts', 'worker-thread.js', 'neutral');
    await beside('worker/thread-node.ts', 'worker-thread-node.js', 'node');
    await esbuild.build({
      ...common,
      entryPoints: [at('wasm/src/cli/main.ts')],
      outfile: join(fresh, 'cli.js'),
      platform: 'node',
      target: 'node20',
      // Some of what is bundled is CommonJS and asks for these.
      banner: {
        js: [
          '#!/usr/bin/env node',
          "import { createRequire as cagecastRequire } from 'node:module';",
          "import { dirname as cagecastDirname } from 'node:path';",
          "import { fileURLToPath as cagecastPath } from 'node:url';",
          'const require = cagecastRequire(import.meta.url), __filename = cagecastPath(import.meta.url), __dirname = cagecastDirname(__filename);',
        ].join('\n'),
      },
      loader: { '.wasm': 'binary' },
      external: ['./borders.js'],
      plugins: [wasmModules('wasm-inline.ts', { borders: true })],
    });
    run(process.execPath, [
      at('node_modules/@typescript/native/bin/tsc'),
      '-p',
      at('wasm/tsconfig.types.json'),
      '--outDir',
      fresh,
    ]);
  }
  rmSync(out, { recursive: true, force: true });
  renameSync(fresh, out);

  /**
   * Resolves the names that stand for what the C++ build makes.
   * @param wasm     How the package comes by its WebAssembly.
   * @param options  `module`: which; `index`: the file that importers of the package's index share; `errors`: so do those of its error;
   * `borders`: what is loaded to cut these stays a file of its own.
   */
  function wasmModules(wasm, { module = 'cagecast', index, errors = false, borders = false } = {}) {
    const files = {
      '#glue': at('build', preset, `wasm/${module}.js`),
      '#wasm-digits': at('build', preset, `wasm/plain/${module}.wasm`),
      '#wasm-packed': at('build', preset, `wasm/plain/${module}.wasm`),
      '#fused': at('build', preset, `wasm/plain/${module}.json`),
      '#wasm': at('wasm/src', wasm),
    };
    const reader = module === 'cagecast' ? '#read-wasm' : '#read-borders-wasm';
    return {
      name: 'wasm-modules',
      setup(build) {
        build.onResolve({ filter: /^#/ }, ({ path }) => (files[path] ? { path: files[path] } : undefined));
        build.onResolve({ filter: /^#read-wasm$/ }, () => ({ path: reader, external: true }));
        for (const [path, file] of borders ? lazy : [])
          build.onResolve({ filter: path }, () => ({ path: file, external: true }));
        const own = at('wasm/src/borders/error.ts');
        if (errors)
          build.onResolve({ filter: /^\.\.?\/error\.js$/ }, ({ importer }) =>
            importer === own ? undefined : { path: own },
          );
        if (index) build.onResolve({ filter: /^\.\.\/index\.js$/ }, () => ({ path: index, external: true }));
        build.onLoad({ filter: /cagecast(-borders)?\.wasm$/ }, ({ path }) =>
          wasm === 'wasm-packed.ts'
            ? { contents: JSON.stringify(packText(readFileSync(path))), loader: 'json' }
            : { contents: readFileSync(path).toString('hex'), loader: 'text' },
        );
      },
    };
  }
}

/**
 * Writes bytes as text of 91 printable symbols, of which strings need to escape none: each of the 89 most frequent bytes
 * as one symbol, the others as two. Unlike base64, which cuts bytes across, it leaves patterns to gzip: 58 KB instead of 64 in
 * hexadecimal digits for 113 KB of WebAssembly. But no browser reads it by itself.
 */
function packText(bytes) {
  const counts = new Uint32Array(256);
  for (const byte of bytes) ++counts[byte];
  const order = Array.from(counts.keys()).sort((a, b) => counts[b] - counts[a] || a - b);
  const places = order.reduce((inverse, byte, place) => ((inverse[byte] = place), inverse), []);
  const symbol = (n) => String.fromCharCode(n + (n < 57 ? 35 : 36)); // from # on, without the backslash
  const [symbols, short] = [91, 89];
  const text = Array.from(bytes, (byte) => {
    const long = places[byte] - short;
    return long < 0 ? symbol(places[byte]) : symbol(short + Math.floor(long / symbols)) + symbol(long % symbols);
  }).join('');
  return { length: bytes.length, order: Buffer.from(order).toString('hex'), text };
}

/** Makes `npx cagecast` work in this checkout as it does where the package is installed. */
function linkCommand() {
  const bin = at('node_modules/.bin');
  const cli = at('dist/cli.js');
  if (!shipped || !existsSync(bin) || !existsSync(cli)) return;
  chmodSync(cli, 0o755);
  const link = join(bin, 'cagecast');
  if (existsSync(link)) return;
  rmSync(link, { force: true });
  symlinkSync('../../dist/cli.js', link);
}

/** A hash of every file that the build reads, by name and content. */
function hashOf(paths, salt) {
  const sum = createHash('sha256').update(salt);
  const visit = (path) => {
    const full = at(path);
    try {
      for (const name of readdirSync(full).sort()) visit(join(path, name));
    } catch (error) {
      if (error.code !== 'ENOTDIR') throw error;
      sum.update(path).update('\0').update(readFileSync(full)).update('\0');
    }
  };
  paths.forEach(visit);
  return sum.digest('hex');
}

function run(command, args, env = process.env) {
  const result = spawnSync(command, args, { cwd: root, env, encoding: 'utf8' });
  if (result.error?.code === 'ENOENT') fail(`${command} is missing; Debian: apt install ${command}`);
  if (result.status !== 0) {
    process.stderr.write(`${result.stdout ?? ''}${result.stderr ?? ''}`);
    fail(`${command} ${args.join(' ')} failed`);
  }
}

function fail(message) {
  console.error(`build: ${message}`);
  process.exit(1);
}
