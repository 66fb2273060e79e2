// Builds the npm package into dist/: the core as WebAssembly, the TypeScript around it, its types, the CLI.
//   node wasm/tools/build.mjs                        all of it; does nothing if nothing changed
//   node wasm/tools/build.mjs --names                with the names of functions, for profiles
//   node wasm/tools/build.mjs --preset wasm-scalar   only index.js, in build/wasm-scalar/package, which tests compare with

import { spawnSync } from 'node:child_process';
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
import { delimiter, dirname, join, relative, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { noticesOf, partsOf } from './notices.mjs';

const root = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
const at = (...parts) => join(root, ...parts);

const { values } = parseArgs({
  options: { preset: { type: 'string', default: 'wasm' }, names: { type: 'boolean', default: false } },
});
const { preset, names } = values;
if (preset !== 'wasm' && preset !== 'wasm-scalar')
  fail(`--preset ${preset} is unknown; there are wasm and wasm-scalar`);

const shipped = preset === 'wasm';
const out = shipped ? at('dist') : at('build', preset, 'package');
const stamp = at('build', preset, 'package.stamp');

/** Template cages, which the package ships. */
const kTemplates = 'examples/samples/templates';

/** Types of files that are imported as hosts that compile nothing do it. */
const kTypesOfWasm =
  '/** The compiled module, for `init({ module })`. */\ndeclare const module: object;\nexport default module;\n';
const kTypesOfTemplate = '/** The bytes of the file. */\ndeclare const bytes: ArrayBuffer;\nexport default bytes;\n';

/** Modules of wasm/src, and the files that are made of them. One that imports another has it as a file beside it. */
const kModules = {
  'core/error': 'error',
  'inspect/index': 'inspect',
  'bake/index': 'bake',
  'engines/index': 'engines',
  'three/internals': 'three-internals',
  'three/index': 'three',
  'three/webgpu/index': 'three-webgpu',
  'react/index': 'react',
  'viewer/index': 'viewer',
  'gltf/index': 'gltf',
  'gltf/documents': 'gltf-documents',
  'gltf/files': 'gltf-files',
  'worker/index': 'worker',
  'worker/here': 'worker-here',
  'cages/index': 'cages',
};

/** Options of esbuild for every file of the package. */
const common = {
  bundle: true,
  format: 'esm',
  target: 'es2022',
  minify: !names,
  lineLimit: 500, // so that Node shows little of the file above an uncaught error
  charset: 'utf8', // the text that is the WebAssembly module in two bytes a character at most, not in escapes of four
  legalComments: 'none', // THIRD-PARTY-NOTICES.txt has them
  sourcemap: shipped ? 'linked' : false,
  metafile: true,
  logLevel: 'warning',
  absWorkingDir: root,
  define: { CAGECAST_VERSION: JSON.stringify(JSON.parse(readFileSync(at('package.json'), 'utf8')).version) },
};
// Nearly all functions of the index are called by the first transfer. Told so, Chromium compiles them as it parses them, on a
// thread in the background, and not one by one as they are called.
const eager = { banner: { js: '//# allFunctionsCalledOnLoad' } };

const hash = hashOf(
  ['core', 'wasm', kTemplates, 'package.json', 'package-lock.json', 'CMakeLists.txt', 'CMakePresets.json'],
  `${preset} ${names}`,
);
if (existsSync(stamp) && readFileSync(stamp, 'utf8') === hash && existsSync(join(out, 'index.js'))) {
  linkCommand();
  process.exit(0);
}

console.log(
  `Building ${shipped ? 'the package' : `the package (${preset})`} into ${shipped ? 'dist' : 'build'}: a few minutes the first time …`,
);
rmSync(stamp, { force: true });
buildWasm();
await buildPackage();
linkCommand();
writeFileSync(stamp, hash);

/** The core and its bindings: build/<preset>/wasm/cagecast.{js,wasm}. */
function buildWasm() {
  const emscripten = findEmscripten();
  const env = {
    ...process.env,
    CAGECAST_EMSCRIPTEN: emscripten,
    PATH: [process.env.PATH, emscripten].join(delimiter),
    // Debian's Emscripten finds its copy of acorn only so.
    NODE_PATH: [process.env.NODE_PATH, '/usr/share/nodejs'].filter(Boolean).join(delimiter),
  };
  run('cmake', ['--preset', preset, `-DCAGECAST_NAMES=${names}`], env);
  run('cmake', ['--build', '--preset', preset], env);
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
  const { build } = await import('esbuild');
  const fresh = at('build', preset, 'package.new');
  rmSync(fresh, { recursive: true, force: true });
  mkdirSync(fresh, { recursive: true });

  const bundled = new Set();
  const bundle = async (entry, name, platform, options) => {
    const outfile = join(fresh, name);
    const entryPoints = [at('wasm/src', entry)];
    const { metafile } = await build({ ...common, ...options, entryPoints, outfile, platform });
    for (const { inputs } of Object.values(metafile.outputs))
      for (const [path, { bytesInOutput }] of Object.entries(inputs)) if (bytesInOutput > 0) bundled.add(path);
    if (existsSync(`${outfile}.map`)) tidyMap(`${outfile}.map`);
  };
  await bundle('index.ts', 'index.js', 'neutral', {
    ...eager,
    plugins: [wasmModules('wasm-inline.ts', shipped ? { shared: { 'core/error.js': './error.js' } } : {})],
  });
  if (shipped) {
    await bundleEntries(bundle);
    await bundleCommand(bundle);
    for (const name of ['cagecast.wasm', 'cagecast-cages.wasm']) {
      cpSync(at('build', preset, 'wasm', name), join(fresh, name));
      chmodSync(join(fresh, name), 0o644);
      writeFileSync(join(fresh, `${name}.d.ts`), kTypesOfWasm);
    }
    cpSync(at(kTemplates), join(fresh, 'templates'), { recursive: true });
    writeFileSync(join(fresh, 'template.d.ts'), kTypesOfTemplate);
    const tsc = at('node_modules/@typescript/native/bin/tsc');
    run(process.execPath, [tsc, '-p', at('wasm/tsconfig.types.json'), '--outDir', fresh]);
    for (const name of readdirSync(fresh, { recursive: true }))
      if (name.endsWith('.d.ts')) widenTypes(join(fresh, name));
    const parts = partsOf(root, bundled, at('build', preset), findEmscripten());
    writeFileSync(join(fresh, 'THIRD-PARTY-NOTICES.txt'), noticesOf(parts));
    writeFileSync(at('build', preset, 'parts.json'), JSON.stringify(parts)); // for the release
  }
  rmSync(out, { recursive: true, force: true });
  renameSync(fresh, out);
}

/** Bundles what package.json exports besides the index. */
async function bundleEntries(bundle) {
  // What is imported from index.js or from a peer stays a file of its own.
  const shared = {
    external: ['./index.js', 'three', 'react', '@react-three/fiber'],
    plugins: [wasmModules('wasm-file.ts', { index: './index.js' })],
  };
  for (const [module, name] of Object.entries(kModules)) await bundle(`${module}.ts`, `${name}.js`, 'neutral', shared);
  // Only loaded for a look: what it shares with others stays out of pages without one.
  await bundle('gltf/look/index.ts', 'gltf-look.js', 'neutral', {
    plugins: [wasmModules('wasm-file.ts', { shared: { 'core/error.js': './error.js' } })],
  });
  await bundle('worker/worker-thread.ts', 'worker-thread.js', 'neutral', shared);
  const alone = { plugins: [wasmModules('wasm-file.ts')] };
  await bundle('index.ts', 'slim.js', 'neutral', { ...alone, ...eager, ...reading('cagecast') });
  // What makes cages has a WebAssembly module of its own; its worker is a file that needs no other script.
  const cages = { ...alone, ...reading('cagecast-cages') };
  await bundle('cages/cages-thread.ts', 'cages-thread.js', 'neutral', cages);
  await bundle('cages/sync.ts', 'cages-sync.js', 'neutral', cages);
  // Workers have no import map, so three.js is in it, of the version whose loaders are guarded.
  await bundle('gltf/formats/formats-thread.ts', 'formats-thread.js', 'neutral', { sourcemap: false });
}

/** Options for a script that reads a WebAssembly file beside it. */
function reading(name) {
  return { define: { ...common.define, CAGECAST_WASM: JSON.stringify(`./${name}.wasm`) } };
}

/** Bundles the command: cli.js, the program, and command.js beside it, the function that the program calls, as tests do. */
async function bundleCommand(bundle) {
  await bundle('cli/main.ts', 'cli.js', 'node', {
    target: 'node20',
    sourcemap: false,
    external: ['./command.js'],
    banner: { js: '#!/usr/bin/env node' },
  });
  // Some of what is bundled is CommonJS and asks for these.
  const banner = [
    "import { createRequire as cagecastRequire } from 'node:module';",
    "import { dirname as cagecastDirname } from 'node:path';",
    "import { fileURLToPath as cagecastPath } from 'node:url';",
    'const require = cagecastRequire(import.meta.url), __filename = cagecastPath(import.meta.url), __dirname = cagecastDirname(__filename);',
  ];
  await bundle('cli/command.ts', 'command.js', 'node', {
    ...reading('cagecast-cages'),
    target: 'node20',
    sourcemap: false, // most of it is what others wrote
    // By require: loaders of TypeScript, as tests have one, take long to rewrite a large script with dynamic imports.
    supported: { 'dynamic-import': false },
    banner: { js: banner.join('\n') },
    loader: { '.wasm': 'binary' },
    plugins: [wasmModules('wasm-inline.ts')],
  });
}

/**
 * Resolves the names that stand for what the C++ build makes.
 * @param wasm   How the package comes by its WebAssembly.
 * @param index   The file that importers of the package's index share; without, it is bundled.
 * @param shared  Modules that are files of their own. Default: all of `kModules` beside an index, else none.
 */
function wasmModules(wasm, { index, shared = index && filesBeside(index) } = {}) {
  const files = {
    '#glue': at('build', preset, 'wasm/cagecast.js'),
    '#cages-glue': at('build', preset, 'wasm/cagecast-cages.js'),
    '#wasm-text': at('build', preset, 'wasm/cagecast.wasm'),
    '#wasm': at('wasm/src/core', wasm),
  };
  return {
    name: 'wasm-modules',
    setup(build) {
      build.onResolve({ filter: /^#/ }, ({ path }) => (files[path] ? { path: files[path] } : undefined));
      if (shared) {
        build.onResolve(
          { filter: /^\.{1,2}\/.*\b(documents|error|files|here|index|internals|sync)\.js$/ },
          ({ path, resolveDir }) => {
            const file = shared[relative(at('wasm/src'), join(resolveDir, path)).replaceAll('\\', '/')];
            return file ? { path: file, external: true, sideEffects: false } : undefined;
          },
        );
      }
      // Emscripten's script calls a function as it is loaded, which bundlers could not leave out. Here it waits for the first call.
      build.onLoad({ filter: /cagecast(-cages)?\.js$/ }, ({ path }) => ({
        contents: `export default function createModule(options) {
          ${readFileSync(path, 'utf8').replace(/export default Module;\s*$/, 'return Module(options);')}
        }`,
      }));
      build.onLoad({ filter: /cagecast\.wasm$/ }, ({ path }) => ({
        // Parcel writes a NUL before a digit as an octal escape, which modules do not have. U+0100 is the same byte when it is read.
        contents: readFileSync(path).toString('latin1').replaceAll('\0', '\u0100'),
        loader: 'text',
      }));
    },
  };
}

/** The files of modules, as those beside an index import them. */
function filesBeside(index) {
  return {
    ...Object.fromEntries(Object.entries(kModules).map(([module, name]) => [`${module}.js`, `./${name}.js`])),
    'cages/sync.js': './cages-sync.js',
    'gltf/look/index.js': './gltf-look.js',
    'api/index.js': index,
    'index.js': index,
  };
}

/**
 * Makes types fit for TypeScript before 5.7, to which `Float32Array<ArrayBuffer>` is an error; its replacement is the same type since then.
 * And for projects without glTF-Transform, which only functions on documents need, or without React.
 */
function widenTypes(path) {
  const text = readFileSync(path, 'utf8')
    .replace(/\b(\w+Array)<ArrayBuffer>/g, "ReturnType<$1Constructor['from']>")
    .replace(
      /^import .*'@gltf-transform\/core';$|^import type \* as React from 'react';$|^declare module 'react' \{$/gm,
      '// @ts-ignore It is an optional peer.\n$&',
    );
  writeFileSync(path, text);
}

/** Makes a source map fit to be packed: without the text of the WebAssembly module, with paths from dist/ on. */
function tidyMap(path) {
  const map = JSON.parse(readFileSync(path, 'utf8'));
  // A source without text is one that Vite looks for, and warns of.
  const textOf = (text, i) => (map.sources[i].endsWith('.wasm') ? '(the WebAssembly module)' : text);
  map.sourcesContent = map.sourcesContent.map(textOf);
  map.sources = map.sources.map((source) => source.replace(/^(\.\.\/)+/, '../'));
  writeFileSync(path, JSON.stringify(map));
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
