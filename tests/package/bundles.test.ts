import assert from 'node:assert/strict';
import { relative } from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

/**
 * What pages import, and how many bytes of the package they may carry at first, minified and gzipped: 10 % above what the code has as it
 * is plainly written. A page that needs more after a change that is worth it gets a higher bound.
 */
const kPages: [what: string, most: number, script: string][] = [
  ['Zone', 450, "import { Zone } from 'cagecast'; console.log(Zone.Cosmetic);"],
  ['init and transfer', 112_000, "import { init, transfer } from 'cagecast'; console.log(init, transfer);"],
  ['transfer of cagecast/slim', 16_200, "import { init, transfer } from 'cagecast/slim'; console.log(init, transfer);"],
  ['transfer of cagecast/worker', 3200, "import { transfer } from 'cagecast/worker'; console.log(transfer);"],
  [
    'init and applyTransfer',
    142_000,
    `import { init } from 'cagecast';
    import { applyTransfer, createLayers, createPainter } from 'cagecast/three';
    console.log(init, applyTransfer);`,
  ],
  [
    'init and prepareParts',
    110_000,
    `import { init } from 'cagecast';
    import { applySplit, joinParts, paintedVertices, prepareParts } from 'cagecast/engines';
    console.log(init, applySplit, joinParts, paintedVertices, prepareParts);`,
  ],
  [
    'applyTransferAsync',
    33_300,
    "import { applyTransferAsync } from 'cagecast/three'; console.log(applyTransferAsync);",
  ],
  [
    'applyTransferAsync, for WebGPURenderer',
    34_600,
    "import 'cagecast/three/webgpu'; import { applyTransferAsync } from 'cagecast/three'; console.log(applyTransferAsync);",
  ],
  [
    'applyTransferAsync, layers and painting',
    58_100,
    `import { applyTransferAsync, createLayers, createPainter } from 'cagecast/three';
    console.log(applyTransferAsync, createLayers, createPainter);`,
  ],
  [
    'layers, for WebGPURenderer',
    19_100,
    `import { enableLayers } from 'cagecast/three/webgpu';
    import { createLayers } from 'cagecast/three';
    console.log(enableLayers, createLayers);`,
  ],
  ['layers', 17_900, "import { createLayers } from 'cagecast/three'; console.log(createLayers);"],
  ['<cagecast-viewer>', 67_000, "import 'cagecast/viewer';"],
  ['useCagecast', 77_300, "import { useCagecast } from 'cagecast/react'; console.log(useCagecast);"],
  ['inspect', 33_300, "import { inspect } from 'cagecast'; console.log(inspect);"],
  ['bakeTexture', 6500, "import { bakeTexture } from 'cagecast/engines'; console.log(bakeTexture);"],
  ['cagecast of cagecast/gltf', 132_900, "import { cagecast } from 'cagecast/gltf'; console.log(cagecast);"],
  ['paintGlb', 70_000, "import { paintGlb } from 'cagecast/gltf'; console.log(paintGlb);"],
  ['makeCage', 3250, "import { makeCage } from 'cagecast/cages'; console.log(makeCage);"],
];

for (const [what, most, contents] of kPages)
  test(`a page that imports ${what} carries at most ${most} bytes`, async (context) => {
    const { outputFiles, metafile } = await build({
      stdin: { contents, resolveDir: import.meta.dirname },
      bundle: true,
      minify: true,
      format: 'esm',
      charset: 'utf8',
      target: 'es2022',
      external: ['three', 'three/*', 'react', '@react-three/fiber', '@gltf-transform/*', 'node:*'],
      splitting: true,
      outdir: 'page',
      metafile: true,
      write: false,
    });
    const loaded = new Set(['page/stdin.js']);
    for (const name of loaded)
      for (const { path, kind, external } of metafile.outputs[name]!.imports)
        if (kind === 'import-statement' && !external) loaded.add(path);
    const scripts = outputFiles.filter(({ path }) => loaded.has(relative('.', path)));
    const { length } = gzipSync(Buffer.concat(scripts.map(({ contents }) => contents)), { level: 9 });
    context.diagnostic(`${length} bytes`);
    assert.ok(length <= most, `${length} bytes`);
  });
