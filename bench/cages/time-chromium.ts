// Times making and fitting cages in Chromium, through the package's worker, as a page does it.
//
//   npx tsx bench/cages/time-chromium.ts [NAME …]        figures; without names the sample head and, of CAGECAST_ASSETS, a body
//
// Per figure: the median of five in seconds; how often progress was told; how late a timer of the page was at most; and how long
// a call took to end after it was cancelled half-way.

import { readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname } from 'node:path';
import { launchChromium } from '../../tests/support/chromium.js';
import { root } from '../native.js';
import { readGlb } from '../read-glb.js';
import { table } from '../table.js';
import { type Figure, listFigures } from './figures.js';

const kTypes: Record<string, string> = {
  '.js': 'text/javascript',
  '.wasm': 'application/wasm',
  '.glb': 'model/gltf-binary',
};
const templateOf = (kind: string): string => (kind === 'body' ? 'human-body' : 'human-head');

interface Job {
  model: { positions: number[]; indices: number[]; groups: number[]; parts: string[]; joints: unknown[] };
  template: string;
  call: 'make' | 'fit';
}

/** Runs in the page. */
async function measure({ model, template, call }: Job) {
  const cages = await import('cagecast/cages');
  const { positions, indices, groups, ...rest } = model;
  const arrays = {
    ...rest,
    positions: Float32Array.from(positions),
    indices: Uint32Array.from(indices),
    groups: Uint32Array.from(groups),
  } as unknown as import('cagecast/cages').CageModel;
  const cage = await cages.loadTemplate(template as 'human-head');
  const start = (options: { onProgress?: () => void; signal?: AbortSignal }) =>
    call === 'make' ? cages.makeCage(arrays, options) : cages.fitCage(cage, arrays, undefined, options);
  let [progress, late, last] = [0, 0, performance.now()];
  const timer = setInterval(() => {
    late = Math.max(late, performance.now() - last - 10);
    last = performance.now();
  }, 10);
  const seconds: number[] = [];
  for (let i = 0; i < 5; ++i) {
    const began = performance.now();
    progress = 0;
    await start({ onProgress: () => ++progress });
    seconds.push((performance.now() - began) / 1000);
  }
  clearInterval(timer);
  seconds.sort((a, b) => a - b);
  const controller = new AbortController();
  let cancelled = 0;
  const running = start({ signal: controller.signal }).catch(() => performance.now() - cancelled);
  await new Promise((done) => setTimeout(done, 500 * seconds[2]!));
  cancelled = performance.now();
  controller.abort();
  return { seconds: seconds[2]!, progress, late, cancel: Number(await running) };
}

const page = `<!doctype html><script type="importmap">{"imports":{"cagecast":"/index.js","cagecast/cages":"/cages.js"}}</script>`;
const server = createServer((request, response) => {
  const path = new URL(request.url ?? '/', 'http://localhost').pathname;
  try {
    const body = path === '/' ? page : readFileSync(`${root}dist${path}`);
    response.writeHead(200, { 'content-type': kTypes[extname(path)] ?? 'text/html' }).end(body);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise<void>((done) => server.listen(0, 'localhost', done));

const names = process.argv.slice(2);
const isChosen = ({ name }: Figure): boolean => (names.length > 0 ? names : ['human', 'makehuman_body']).includes(name);
const browser = await launchChromium({ drawing: false });
const rows: string[][] = [];
for (const { name, kind, target } of listFigures().filter(isChosen)) {
  const { mesh, parts, joints } = await readGlb(target);
  const model = {
    positions: [...mesh.positions],
    indices: [...mesh.indices],
    groups: [...mesh.groups!],
    parts,
    joints,
  };
  for (const call of ['make', 'fit'] as const) {
    const tab = await browser.newPage();
    await tab.goto(`http://localhost:${(server.address() as AddressInfo).port}/`);
    // tsx names functions by a helper that the page lacks.
    await tab.evaluate('globalThis.__name = (value) => value');
    const found = await tab.evaluate(measure, { model, template: templateOf(kind), call });
    rows.push([
      `${call} ${name}`,
      found.seconds.toFixed(2),
      String(found.progress),
      found.late.toFixed(0),
      found.cancel.toFixed(0),
    ]);
    await tab.close();
  }
}
await browser.close();
server.close();
console.log(table(['', 's', 'progress told', 'ms late', 'ms to cancel'], rows));
