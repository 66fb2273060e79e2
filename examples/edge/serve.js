// Bundles the function, and serves it by workerd, the program that Cloudflare runs it in.
import { build } from 'esbuild';
import { Miniflare } from 'miniflare';

await build({
  entryPoints: ['edge.js'],
  outdir: 'out',
  bundle: true,
  format: 'esm',
  loader: { '.wasm': 'copy', '.glb': 'copy' },
});
const server = new Miniflare({
  port: Number(process.env.PORT ?? 8787),
  compatibilityDate: '2026-04-01',
  scriptPath: 'out/edge.js',
  modules: true,
  modulesRules: [
    { type: 'CompiledWasm', include: ['**/*.wasm'] },
    { type: 'Data', include: ['**/*.glb'] },
  ],
});
console.log(String(await server.ready));
