import { createHash } from 'node:crypto';
import { readdir, readFile } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';
import type { Plugin } from 'vite';

const kWorker = fileURLToPath(new URL('service-worker/service-worker.ts', import.meta.url));
const kPage = 'index.html';

/** Builds the service worker after everything else, with the list of all files. */
export function precache(): Plugin {
  let outDir: string;
  return {
    name: 'cagecast-precache',
    configResolved: (config) => void (outDir = path.resolve(config.root, config.build.outDir)),
    writeBundle: {
      sequential: true,
      order: 'post',
      async handler() {
        const entries = await readdir(outDir, { recursive: true, withFileTypes: true });
        const names = entries
          .filter((entry) => entry.isFile())
          .map(({ parentPath, name }) => path.relative(outDir, path.join(parentPath, name)));
        const files = [
          kPage,
          ...names
            .map((name) => name.split(path.sep).join('/'))
            .filter((name) => name !== kPage)
            .toSorted(),
        ];
        const hash = createHash('sha256');
        for (const file of files) hash.update(file).update(await readFile(path.join(outDir, file)));
        await build({
          entryPoints: [kWorker],
          outfile: path.join(outDir, 'service-worker.js'),
          bundle: true,
          minify: true,
          target: 'es2022',
          define: { FILES: JSON.stringify(files), VERSION: JSON.stringify(hash.digest('hex').slice(0, 16)) },
        });
      },
    },
  };
}
