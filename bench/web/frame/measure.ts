// Measures what paint costs the processor in each frame: of a model of thirty primitives, and of the same model without paint.
// Two models without paint show how far the ratio may be trusted on this machine; one with another texture of three.js, what a paint
// costs at the least. Takes five minutes.
//   npx tsx bench/web/frame/measure.ts        needs `npm run build`

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { build } from 'esbuild';
import { launchChromium } from '../../../tests/support/chromium.js';
import { median } from '../../statistics.js';
import type { Extra, Kind } from './page.js';

const kBlocks = 100;
const kFrames = 100;

const folder = mkdtempSync(join(tmpdir(), 'cagecast-frame-'));
await build({
  entryPoints: ['bench/web/frame/page.ts'],
  bundle: true,
  format: 'esm',
  outdir: folder,
  logLevel: 'warning',
  define: { 'import.meta.url': 'location.href' },
});
writeFileSync(join(folder, 'index.html'), '<!doctype html><script type="module" src="page.js"></script>');
const server = createServer((request, response) => {
  try {
    const name = new URL(request.url ?? '/', 'http://localhost').pathname.slice(1) || 'index.html';
    const bytes = readFileSync(join(folder, name));
    response.writeHead(200, {
      'content-type': name.endsWith('js') ? 'text/javascript' : 'text/html',
      'cross-origin-opener-policy': 'same-origin',
      'cross-origin-embedder-policy': 'require-corp',
    });
    response.end(bytes);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
const browser = await launchChromium({ drawing: true });

interface Offered {
  make(kind: Kind, extra: Extra): Promise<void>;
  draw(which: 0 | 1, frames: number): number[];
}

/** Clocks of pages count in steps of 5 µs, which a mean of many evens out; the slower half has what else the machine did. */
function meanOfFasterHalf(times: readonly number[]): number {
  const faster = [...times].sort((a, b) => a - b).slice(0, times.length / 2);
  return faster.reduce((sum, time) => sum + time, 0) / faster.length;
}

async function measure(kind: Kind, extra: Extra): Promise<void> {
  const page = await browser.newPage();
  page.on('pageerror', (error) => console.error(error));
  await page.goto(`http://127.0.0.1:${(server.address() as { port: number }).port}/`);
  await page.waitForFunction(() => 'draw' in globalThis);
  await page.evaluate(([kind, extra]) => (globalThis as unknown as Offered).make(kind, extra), [kind, extra] as const);
  const session = await page.context().newCDPSession(page);
  await session.send('Performance.enable', { timeDomain: 'threadTicks' });
  const threadTime = async (): Promise<number> =>
    (await session.send('Performance.getMetrics')).metrics.find(({ name }) => name === 'ThreadTime')!.value;
  const walls: [number[], number[]] = [[], []];
  const cpus: [number[], number[]] = [[], []];
  for (let block = -4; block < kBlocks; ++block) {
    for (const which of block % 2 === 0 ? ([0, 1] as const) : ([1, 0] as const)) {
      const before = await threadTime();
      const times = await page.evaluate(([which, frames]) => (globalThis as unknown as Offered).draw(which, frames), [
        which,
        kFrames,
      ] as const);
      const cpu = ((await threadTime()) - before) / kFrames;
      if (block < 0) continue;
      walls[which].push(meanOfFasterHalf(times));
      cpus[which].push(1000 * cpu);
    }
  }
  await page.close();
  const ratio = ([bare, painted]: [number[], number[]]): string => {
    const ratios = painted.map((time, i) => time / bare[i]!).sort((a, b) => a - b);
    // Where the median of all such blocks lies, with 95 % certainty.
    const [low, high] = [-1, 1].map((side) => ratios[Math.round(kBlocks / 2 + side * 0.98 * Math.sqrt(kBlocks))]!);
    return `${median(bare).toFixed(4)} → ${median(painted).toFixed(4)} ms, ratio ${median(ratios).toFixed(3)} (${low!.toFixed(3)} to ${high!.toFixed(3)})`;
  };
  const { parts, morphs, maps } = kind;
  console.log(
    `${parts} parts, ${morphs} morphs, ${maps ? 'with' : 'without'} maps; ${extra} more: in render ${ratio(walls)}; thread ${ratio(cpus)}`,
  );
}

const kinds = [
  { parts: 30, morphs: 0, maps: true },
  { parts: 30, morphs: 0, maps: false },
  { parts: 30, morphs: 8, maps: true },
];
for (const kind of kinds)
  for (const extra of ['nothing', 'a texture of three.js', 'paint'] as const) await measure(kind, extra);
await browser.close();
server.close();
rmSync(folder, { recursive: true, force: true });
