import { mkdir, readFile } from 'node:fs/promises';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { build } from 'esbuild';
import { chromium, type Browser, type CDPSession, type Page } from 'playwright-core';
import { measureNative, output, root, type Spread } from './native.js';
import type { BenchScene } from './scenes.js';
import { median, spread } from './statistics.js';
import type { FirstUse } from './web/first-page.js';
import type { Race, RaceOptions } from './web/race.js';

/** The package against the same pipeline on three-mesh-bvh, in one realm; ms of wall time. */
export interface RaceResult {
  runs: number;
  cagecast: Spread;
  stages: Record<string, number>;
  peer?: { total: Spread; stages: Record<string, number>; ratio: number; otherZones: number; otherTriangles: number };
}

const bundles = `${root}build/bench/web`;

/** Bundles the pages and the script for Node. The package stays outside of them: it is measured as it is shipped. */
export async function buildWeb(): Promise<void> {
  await mkdir(bundles, { recursive: true });
  const common = { bundle: true, format: 'esm', minify: true, target: 'es2022', absWorkingDir: root, logLevel: 'error' } as const;
  const packageAt = (path: string) => ({
    name: 'package',
    setup: (b: { onResolve(filter: { filter: RegExp }, f: () => { path: string; external: true }): void }) =>
      b.onResolve({ filter: /^cagecast$/ }, () => ({ path, external: true })),
  });
  await build({ ...common, entryPoints: ['bench/web/page.ts', 'bench/web/first-page.ts'], outdir: bundles, plugins: [packageAt('/dist/index.js')] });
  await build({ ...common, entryPoints: ['bench/web/node-race.ts'], outfile: `${bundles}/node-race.mjs`, platform: 'node', plugins: [packageAt(`${root}dist/index.js`)] });
}

function summary({ pairs, otherZones, otherTriangles }: Race): RaceResult {
  const medians = (of: readonly Record<string, number>[]): Record<string, number> =>
    Object.fromEntries(Object.keys(of[0]!).map((stage) => [stage, median(of.map((stages) => stages[stage]!))]));
  const peers = pairs.flatMap(({ peer }) => (peer ? [peer] : []));
  return {
    runs: pairs.length,
    cagecast: spread(pairs.map(({ cagecast }) => cagecast)),
    stages: medians(pairs.map(({ stages }) => stages)),
    ...(peers.length > 0 && {
      peer: {
        total: spread(peers.map(({ total }) => total)),
        stages: medians(peers.map((stages) => ({ ...stages }))),
        ratio: median(pairs.map(({ cagecast, peer }) => peer!.total / cagecast)),
        otherZones: otherZones!,
        otherTriangles: otherTriangles!,
      },
    }),
  };
}

/** Races in Node, on one core. */
export async function raceInNode(scene: BenchScene, options: RaceOptions): Promise<RaceResult> {
  const { stdout } = await output('taskset', ['-c', '0', process.execPath, `${bundles}/node-race.mjs`, scene.path, JSON.stringify(options)]);
  return summary(JSON.parse(stdout) as Race);
}

/** Serves the checkout, isolated from other origins: a page then has a clock of 5 µs instead of 100. */
async function serve(): Promise<Server> {
  const types: Record<string, string> = { js: 'text/javascript', html: 'text/html' };
  const page = (script: string): string => `<!doctype html><meta charset="utf-8"><title>bench</title><script type="module" src="/build/bench/web/${script}.js"></script>`;
  const server = createServer((request, response) => {
    void (async () => {
      const path = new URL(request.url!, 'http://localhost').pathname;
      response.setHeader('Cross-Origin-Opener-Policy', 'same-origin');
      response.setHeader('Cross-Origin-Embedder-Policy', 'require-corp');
      response.setHeader('Content-Type', types[path.split('.').at(-1)!] ?? 'application/octet-stream');
      try {
        response.end(path.endsWith('.html') ? page(path.slice(1, -5)) : path === '/favicon.ico' ? '' : await readFile(root + path.slice(1)));
      } catch {
        response.writeHead(404).end();
      }
    })();
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return server;
}

async function launch(): Promise<Browser> {
  const executablePath = process.env['CHROMIUM'] ?? (await output('sh', ['-c', 'command -v chromium'])).stdout.trim();
  return chromium.launch({
    executablePath,
    args: ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-gpu'],
  });
}

async function throttle(page: Page, rate: number): Promise<CDPSession> {
  const session = await page.context().newCDPSession(page);
  await session.send('Emulation.setCPUThrottlingRate', { rate });
  return session;
}

/** Keeps the processes that run pages on one core, as native runs are. */
async function pinRenderers(browser: Browser): Promise<void> {
  const session = await browser.newBrowserCDPSession();
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  for (const { type, id } of processInfo) if (type === 'renderer') await output('taskset', ['-a', '-c', '-p', '0', String(id)]);
  await session.detach();
}

/** Chromium, with the benchmark's pages. */
export class WebBench {
  private constructor(
    private readonly server: Server,
    private readonly origin: string,
    readonly version: string,
  ) {}

  static async start(): Promise<WebBench> {
    const server = await serve();
    const browser = await launch();
    const version = browser.version();
    await browser.close();
    return new WebBench(server, `http://127.0.0.1:${(server.address() as AddressInfo).port}`, version);
  }

  async stop(): Promise<void> {
    await new Promise((resolve) => this.server.close(resolve));
  }

  private urlOf({ path }: BenchScene): string {
    return `${this.origin}/${path.slice(root.length)}`;
  }

  /** Does something with the page of the race, in a browser of its own, pinned to a core. */
  private async withPage<T>(body: (page: Page) => Promise<T>): Promise<T> {
    const browser = await launch();
    try {
      const page = await browser.newPage();
      await page.goto(`${this.origin}/page.html`);
      await page.waitForFunction(() => 'raceOn' in window);
      await pinRenderers(browser);
      return await body(page);
    } finally {
      await browser.close();
    }
  }

  private raceOn(page: Page, scene: BenchScene, options: RaceOptions): Promise<Race> {
    return page.evaluate(
      ([url, given]) => (window as unknown as { raceOn(url: string, options: RaceOptions): Promise<Race> }).raceOn(url, given),
      [this.urlOf(scene), options] as const,
    );
  }

  /** Races in one page. */
  async race(scene: BenchScene, options: RaceOptions): Promise<RaceResult> {
    return this.withPage(async (page) => summary(await this.raceOn(page, scene, options)));
  }

  /** The package alone on a slower processor, as DevTools emulate it. */
  async throttled(scene: BenchScene, rate: number, options: RaceOptions): Promise<RaceResult> {
    return this.withPage(async (page) => {
      await throttle(page, rate);
      return summary(await this.raceOn(page, scene, { ...options, withPeer: false }));
    });
  }

  /**
   * The package in a page against Embree natively, both on the same core, in alternating blocks of runs.
   * @return The median over blocks of Embree's median ÷ the package's.
   */
  async againstNativeEmbree(scene: BenchScene, blocks: number, runs: number): Promise<{ ratio: number; cagecast: number; embree: number }> {
    return this.withPage(async (page) => {
      await this.raceOn(page, scene, { runs: 1, warmUp: 60, withPeer: false });
      const pairs: { cagecast: number; embree: number }[] = [];
      for (let block = 0; block < blocks; ++block) {
        const ours = summary(await this.raceOn(page, scene, { runs, warmUp: 3, withPeer: false }));
        const native = await measureNative(scene.path, runs, ['embree']);
        pairs.push({ cagecast: ours.cagecast.median, embree: native.peers['embree']!.times.total.median });
      }
      return {
        ratio: median(pairs.map(({ cagecast, embree }) => embree / cagecast)),
        cagecast: median(pairs.map(({ cagecast }) => cagecast)),
        embree: median(pairs.map(({ embree }) => embree)),
      };
    });
  }

  /** The first use of the package in a browser that was just started, several times; the medians. */
  async firstUse(scene: BenchScene, rate: number, launches: number): Promise<FirstUse> {
    const all: FirstUse[] = [];
    for (let i = 0; i < launches; ++i) {
      const browser = await launch();
      try {
        const page = await browser.newPage();
        await page.goto(`${this.origin}/first-page.html`);
        await page.waitForFunction(() => 'firstUse' in window);
        await throttle(page, rate);
        all.push(
          await page.evaluate(
            ([url, script]) => (window as unknown as { firstUse(url: string, script: string): Promise<FirstUse> }).firstUse(url, script),
            [this.urlOf(scene), `${this.origin}/dist/index.js`] as const,
          ),
        );
      } finally {
        await browser.close();
      }
    }
    const of = (field: keyof FirstUse): number => median(all.map((use) => use[field]));
    return { import: of('import'), init: of('init'), transfer: of('transfer'), total: of('total'), heap: of('heap'), heapLater: of('heapLater') };
  }
}
