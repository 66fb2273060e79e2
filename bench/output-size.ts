// How large the files are that `cagecast transfer` writes, against those that it reads: without paint, with paint, and with cut
// borders. For the samples, the models of CAGECAST_ASSETS, and each of them with nothing but positions and indices.
//   CAGECAST_ASSETS=folder npx tsx bench/output-size.ts [MODEL …]

import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, statSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Logger, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { prune } from '@gltf-transform/functions';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { table } from './table.js';

const root = fileURLToPath(new URL('..', import.meta.url));
const folder = join(root, 'build/bench/output-size');
const cli = join(root, 'dist/cli.js');

interface Model {
  name: string;
  target: string;
  cage: string;
}

/** The cage of a model that has none beside it: made for it, or that of the same model in another form. */
function cageFor(assets: string | undefined, name: string, target: string): string {
  if (assets !== undefined && /sedan/.test(name)) return join(assets, 'kenney_sedan/cage.glb');
  const cage = join(folder, `${name.replaceAll(/\W+/g, '-')}-cage.glb`);
  // Exit 3, for a cage that does not fit well, matters here as little as how it looks.
  if (!existsSync(cage)) spawnSync(process.execPath, [cli, 'make', target, '-o', cage, '--quiet']);
  return existsSync(cage) ? cage : 'auto';
}

function models(): Model[] {
  const assets = process.env['CAGECAST_ASSETS'];
  const found: Model[] = [];
  for (const base of [join(root, 'examples/samples'), ...(assets === undefined ? [] : [assets])]) {
    for (const path of readdirSync(base, { recursive: true, encoding: 'utf8' }).sort()) {
      if (!/\.(glb|gltf)$/.test(path) || /^(cage|template)/.test(basename(path))) continue;
      const own = join(base, dirname(path), 'cage.glb');
      const name = path.replace(/\/target\.glb$|\.(glb|gltf)$/, '');
      found.push({ name, target: join(base, path), cage: existsSync(own) ? own : '' });
    }
  }
  return found;
}

/** The same model with nothing but positions and indices. */
async function bare({ name, target, cage }: Model): Promise<Model> {
  await MeshoptDecoder.ready;
  const io = new NodeIO().setLogger(new Logger(Logger.Verbosity.SILENT)).registerExtensions(ALL_EXTENSIONS);
  const document = await io.registerDependencies({ 'meshopt.decoder': MeshoptDecoder }).read(target);
  for (const mesh of document.getRoot().listMeshes()) {
    for (const primitive of mesh.listPrimitives()) {
      primitive.setMaterial(null);
      for (const semantic of primitive.listSemantics())
        if (semantic !== 'POSITION') primitive.setAttribute(semantic, null);
    }
  }
  for (const node of document.getRoot().listNodes()) node.setSkin(null);
  for (const extension of document.getRoot().listExtensionsUsed())
    if (extension.extensionName !== 'KHR_mesh_quantization') extension.dispose();
  await document.transform(prune());
  const path = join(folder, `${name.replaceAll('/', '-')}-bare.glb`);
  await io.write(path, document);
  return { name: `${name}, bare`, target: path, cage };
}

const paint = join(root, 'examples/samples/car/paint-rally.png');

/** The size of what the command writes, without the bytes of the paint. */
function written({ name, target, cage }: Model, how: string, ...flags: string[]): number {
  const out = join(folder, `${name.replaceAll(/\W+/g, '-')}-${how}.glb`);
  const arguments_ = [cli, 'transfer', target, '--cage', cage, '-o', out, '--json', ...flags];
  const report = JSON.parse(execFileSync(process.execPath, arguments_, { encoding: 'utf8', maxBuffer: 2 ** 28 })) as {
    texture: string | null;
    parts: { overlayTriangles: number }[];
  };
  const isPainted = report.parts.some(({ overlayTriangles }) => overlayTriangles > 0);
  return statSync(out).size - (report.texture !== null && isPainted ? statSync(report.texture).size : 0);
}

const median = (values: number[]): number => values.sort((a, b) => a - b)[Math.floor(values.length / 2)]!;

mkdirSync(folder, { recursive: true });
const chosen = process.argv.slice(2);
const wanted = models().filter(({ name }) => chosen.length === 0 || chosen.some((part) => name.includes(part)));
const rows: string[][] = [];
const ratios = { whole: [[], []] as number[][], bare: [[], []] as number[][] };
for (const { name, target, cage } of wanted) {
  const model = { name, target, cage: cage || cageFor(process.env['CAGECAST_ASSETS'], name, target) };
  for (const one of /draco/.test(model.name) ? [model] : [model, await bare(model)]) {
    const size = statSync(one.target).size;
    const sizes = [
      written(one, 'plain'),
      written(one, 'cut', '--borders', 'cut'),
      written(one, 'painted', '--texture', paint),
    ];
    const times = sizes.map((written) => written / size);
    const list = one === model ? ratios.whole : ratios.bare;
    list.forEach((of, i) => of.push(times[i]!));
    rows.push([one.name, size.toLocaleString('en'), ...times.map((ratio) => ratio.toFixed(2))]);
  }
}
console.log(table(['model', 'bytes', 'plain ×', 'cut ×', 'painted ×, without the paint'], rows));
for (const [kind, [plain, cut]] of Object.entries(ratios))
  if (plain!.length > 0)
    console.log(`${kind}: median ${median(plain!).toFixed(2)} plain, ${median(cut!).toFixed(2)} cut`);
