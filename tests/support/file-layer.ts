import { writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { build } from 'esbuild';
import { temporaryFolder } from './temporary.js';

/** What the command reads files by, which the package does not export. */
export interface FileLayer {
  readGltf: typeof import('../../wasm/src/gltf/read-gltf.js').readGltf;
  extract: typeof import('../../wasm/src/gltf/extract-file.js').extract;
  defaultReading: typeof import('../../wasm/src/gltf/files.js').defaultReading;
}

/** Bundles the file layer, whose decoders are files that only a bundler reads. Takes some tenths of a second. */
export async function loadFileLayer(): Promise<FileLayer> {
  const { at } = temporaryFolder('files');
  const { outputFiles } = await build({
    stdin: {
      contents: ['read-gltf', 'extract-file', 'files'].map((name) => `export * from './${name}.js';`).join('\n'),
      resolveDir: 'wasm/src/gltf',
    },
    bundle: true,
    format: 'esm',
    platform: 'node',
    target: 'node20',
    write: false,
    loader: { '.wasm': 'binary' },
    banner: {
      js: `import { createRequire } from 'node:module'; const require = createRequire(${JSON.stringify(import.meta.url)}), __dirname = '', __filename = '';`,
    },
  });
  writeFileSync(at('layer.mjs'), outputFiles[0]!.contents);
  return (await import(pathToFileURL(at('layer.mjs')).href)) as FileLayer;
}
