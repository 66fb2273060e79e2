import { cp, readFile } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { defineConfig, type Plugin } from 'vite';
import { basis } from './basis.ts';
import { precache } from './precache.ts';
import { share } from './share.ts';

const kRepository = fileURLToPath(new URL('..', import.meta.url));
const kSamples = path.join(kRepository, 'examples/samples');

/** Makes the sample models part of the page: under samples/, in development and in the build. */
function samples(): Plugin {
  let outDir: string;
  return {
    name: 'cagecast-samples',
    configResolved: (config) => void (outDir = path.resolve(config.root, config.build.outDir)),
    configureServer(server) {
      server.middlewares.use('/samples', async (request, response, next) => {
        const name = decodeURIComponent(new URL(request.url ?? '/', 'http://localhost').pathname);
        const file = path.join(kSamples, path.normalize(name));
        try {
          response.end(await readFile(file));
        } catch {
          next();
        }
      });
    },
    async writeBundle() {
      for (const name of ['index.json', ...(await sampleFiles())])
        await cp(path.join(kSamples, name), path.join(outDir, 'samples', name));
    },
  };
}

/** The files in the list of samples, relative to it. */
async function sampleFiles(): Promise<string[]> {
  const text = await readFile(path.join(kSamples, 'index.json'), 'utf8');
  const samples: { target: string; cage: string; truth?: string; paints: { file: string }[] }[] = JSON.parse(text);
  const filesOf = ({ target, cage, truth, paints }: (typeof samples)[number]): string[] =>
    [target, cage, truth ?? [], paints.map(({ file }) => file)].flat();
  return [...new Set(samples.flatMap(filesOf))];
}

/** Uses the package's separate .wasm file: page and worker share it, and it compiles while it loads. */
function slim(): Plugin {
  return {
    name: 'cagecast-slim',
    enforce: 'pre',
    async resolveId(source, importer, options) {
      const found = await this.resolve(source, importer, { ...options, skipSelf: true });
      return found?.id === path.join(kRepository, 'dist/index.js') ? path.join(kRepository, 'dist/slim.js') : found;
    },
  };
}

/** Leaves out Draco's decoders for formats other than glTF, which the page never uses: 160 KB of scripts, and a megabyte offline. */
function onlyGltfDraco(): Plugin {
  const spare = /new URL\( '\.\.\/libs\/draco\/draco_[^']+', import\.meta\.url \)\.toString\(\)/g;
  return {
    name: 'cagecast-only-gltf-draco',
    transform: (code, id) => (/\/DRACOLoader\.js$/.test(id) ? code.replaceAll(spare, "''") : undefined),
  };
}

/** Each import is the browser's own: what Vite puts around it tells errors to a `window`, which workers lack, instead of naming the script. */
function plainImports(): Plugin {
  return {
    name: 'cagecast-plain-imports',
    transform: (_, id) =>
      id.endsWith('vite/preload-helper.js') ? 'export const __vitePreload = (load) => load();' : undefined,
  };
}

/** Builds workers together with the page, so that they share scripts with it: with copies of their own, all scripts are 523 KB, not 476. */
function sharingWorkers(): Plugin {
  return {
    name: 'cagecast-sharing-workers',
    apply: 'build',
    enforce: 'pre',
    transform(code, id) {
      return code.replace(/new URL\('(\.{1,2}\/[\w/-]+-worker\.ts)', import\.meta\.url\)/g, (_, worker) => {
        const chunk = this.emitFile({ type: 'chunk', id: path.join(path.dirname(id), worker) });
        return `import.meta.ROLLUP_FILE_URL_${chunk}`;
      });
    },
  };
}

export default defineConfig({
  root: fileURLToPath(new URL('.', import.meta.url)),
  // Relative, so that the page can be served from any folder.
  base: './',
  plugins: [slim(), samples(), onlyGltfDraco(), plainImports(), sharingWorkers(), basis(), share(), precache()],
  build: {
    outDir: path.join(kRepository, 'build/web'),
    emptyOutDir: true,
    target: 'es2022',
    // Only what the page begins with is preloaded; scripts that load later import little. Old browsers do without.
    modulePreload: {
      polyfill: false,
      resolveDependencies: (_, files, { hostType }) => (hostType === 'html' ? files : []),
    },
    assetsInlineLimit: 0,
    // Small modules that several scripts import are one file: each file costs a request and compresses by itself.
    rolldownOptions: {
      output: {
        codeSplitting: {
          includeDependenciesRecursively: false,
          groups: [
            // What the page and its workers begin with; the cage module, which imports it, loads when a cage is asked for.
            { name: 'cagecast', test: /dist\/slim\.js$|vite\/preload-helper\.js$/ },
            // Modules of the first view that features share. No worker may import them, nor may they import app.ts, as it waits for features.
            {
              name: 'shared',
              test: /web\/src\/(export\/link\.|loading\/(extract-mesh|file-paths|load-paint|samples|transfer-client)|panels\/part-menu|platform\/(ask|download|face|graphics|make|page|programs|shelf|store)\.|state\/(?!project|wardrobe|study|control-steps|verdict\/spots|wording)|tools\/cage\/arrow-keys|view\/(colors|framing|overlay\/(?!roll-on)|pick|ray|segments))/,
            },
          ],
        },
      },
    },
    chunkSizeWarningLimit: 900,
  },
  worker: { format: 'es', plugins: () => [slim(), basis()] },
  preview: { headers: { 'X-Content-Type-Options': 'nosniff' } },
});
