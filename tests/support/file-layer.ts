import { writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { build } from 'esbuild';
import { temporaryFolder } from './temporary.js';

/** What the command reads and writes files by, which the package does not export. */
export type FileLayer = Pick<typeof import('../../wasm/src/cli/io/read-gltf.js'), 'readGltf'> &
  Pick<typeof import('../../wasm/src/scene/extract.js'), 'extract'> &
  Pick<typeof import('../../wasm/src/gltf/write-transfer.js'), 'writeTransfer'> &
  Pick<typeof import('../../wasm/src/gltf/primitive-group.js'), 'preparePiece'> &
  Pick<typeof import('../../wasm/src/gltf/overlay.js'), 'paintOf'> &
  Pick<typeof import('../../wasm/src/cli/model/reading.js'), 'defaultReading'>;

const kModules = [
  'cli/io/read-gltf',
  'scene/extract',
  'gltf/write-transfer',
  'gltf/primitive-group',
  'gltf/overlay',
  'cli/model/reading',
];

/** Bundles the file layer, whose decoders are files that only a bundler reads. It uses the package's own index. */
export async function loadFileLayer(): Promise<FileLayer> {
  const { at } = temporaryFolder('files');
  const index = pathToFileURL(resolve('dist/index.js')).href;
  const { outputFiles } = await build({
    stdin: {
      contents: kModules.map((name) => `export * from './${name}.js';`).join('\n'),
      resolveDir: 'wasm/src',
    },
    bundle: true,
    format: 'esm',
    platform: 'node',
    target: 'node20',
    write: false,
    loader: { '.wasm': 'binary' },
    banner: {
      js: `import { createRequire as layerRequire } from 'node:module'; const require = layerRequire(${JSON.stringify(import.meta.url)}), __dirname = '', __filename = '';`,
    },
    plugins: [
      {
        name: 'index',
        setup: ({ onResolve }) =>
          onResolve({ filter: /^(\.\.\/)+api\/index\.js$/ }, ({ path, resolveDir }) =>
            resolve(resolveDir, path) === resolve('wasm/src/api/index.js')
              ? { path: index, external: true }
              : undefined,
          ),
      },
    ],
  });
  writeFileSync(at('layer.mjs'), outputFiles[0]!.contents);
  return (await import(pathToFileURL(at('layer.mjs')).href)) as FileLayer;
}
