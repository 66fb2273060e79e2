import { readFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import type { Preset } from 'cagecast';
import { build } from 'esbuild';
import type { Browser, CDPSession, Page } from 'playwright-core';
import { launchChromium } from '../tests/support/chromium.js';
import { measureNative, output, root, type Spread } from './native.js';
import { cpuTime, type RaceOptions, type RaceResult, type Realm, race, turn, warmUp } from './race.js';
import type { BenchScene } from './scenes.js';
import { median, spread } from './statistics.js';
import type { FirstUse } from './web/first-page.js';
import type { Block, Runner } from './web/runner.js';

const bundles = `${root}build/bench/web`;
/** Transfers in Node, to be counted. */
export const countBundle = `${bundles}/count.mjs`;

/** Bundles the pages and the script for Node. The package stays outside of them: it is measured as it is shipped. */
export async function buildWeb(): Promise<void> {
  await mkdir(bundles, { recursive: true });
  const common = {
    bundle: true,
    format: 'esm',
    minify: true,
    target: 'es2022',
    absWorkingDir: root,
    logLevel: 'error',
  } as const;
  const packageAt = (path: string) => ({
    name: 'package',
    setup: (b: { onResolve(filter: { filter: RegExp }, f: () => { path: string; external: true }): void }) =>
      b.onResolve({ filter: /^cagecast$/ }, () => ({ path, external: true })),
  });
  await build({
    ...common,
    entryPoints: ['bench/web/page.ts', 'bench/web/first-page.ts'],
    outdir: bundles,
    plugins: [packageAt('/dist/index.js')],
  });
  const inNode = { ...common, platform: 'node' as const, plugins: [packageAt(`${root}dist/index.js`)] };
  await build({ ...inNode, entryPoints: ['bench/web/node-race.ts'], outfile: `${bundles}/node-race.mjs` });
  await build({ ...inNode, entryPoints: ['bench/web/count.ts'], outfile: countBundle });
}

/** Races in Node, on one core. */
export async function raceInNode(scene: BenchScene, options: RaceOptions): Promise<RaceResult> {
  const { stdout } = await output('taskset', [
    '-c',
    '0',
    process.execPath,
    `${bundles}/node-race.mjs`,
    scene.path,
    JSON.stringify(options),
  ]);
  return JSON.parse(stdout) as RaceResult;
}

/** Serves the checkout, isolated from other origins: a page then has a clock of 5 µs instead of 100. */
async function serve(): Promise<Server> {
  const types: Record<string, string> = { js: 'text/javascript', html: 'text/html' };
  const page = (script: string): string =>
    `<!doctype html><meta charset="utf-8"><title>bench</title><script type="module" src="/build/bench/web/${script}.js"></script>`;
  const server = createServer((request, response) => {
    const path = new URL(request.url!, 'http://localhost').pathname;
    response.setHeader('Cross-Origin-Opener-Policy', 'same-origin');
    response.setHeader('Cross-Origin-Embedder-Policy', 'require-corp');
    response.setHeader('Content-Type', types[path.split('.').at(-1)!] ?? 'application/octet-stream');
    try {
      // At once, and not by a thread that would have to be woken: the page's first use of the package waits for it.
      response.end(
        path.endsWith('.html')
          ? page(path.slice(1, -5))
          : path === '/favicon.ico'
            ? ''
            : readFileSync(root + path.slice(1)),
      );
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return server;
}

async function throttle(page: Page, rate: number): Promise<CDPSession> {
  const session = await page.context().newCDPSession(page);
  await session.send('Emulation.setCPUThrottlingRate', { rate });
  return session;
}

/** The process that runs the page: of those that could, the one that a busy page keeps busy. */
async function rendererOf(browser: Browser, page: Page): Promise<number> {
  const session = await browser.newBrowserCDPSession();
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  await session.detach();
  const ids = processInfo.filter(({ type }) => type === 'renderer').map(({ id }) => id);
  // A spare process that starts up is busy once; the page's own is busy every time.
  let likely = 0;
  let times = 0;
  for (let attempt = 0; attempt < 40 && times < 4; ++attempt) {
    const before = ids.map(cpuTime);
    await page.evaluate(() => {
      for (const end = performance.now() + 50; performance.now() < end; );
    });
    const used = ids.map((id, i) => ({ id, time: cpuTime(id) - before[i]! })).sort((x, y) => y.time - x.time);
    if (used[0]!.time < 10 || used[0]!.time < 4 * (used[1]?.time ?? 0)) continue;
    times = used[0]!.id === likely ? times + 1 : 1;
    likely = used[0]!.id;
  }
  if (times === 4) return likely;
  throw new Error('cannot tell which process runs the page: is another Chromium page busy?');
}

/** Waits until a browser has nothing of its own left to do: all its processes together take less than a tenth of a second's time. */
async function comeToRest(browser: Browser): Promise<void> {
  const session = await browser.newBrowserCDPSession();
  const used = async (): Promise<number> =>
    (await session.send('SystemInfo.getProcessInfo')).processInfo.reduce(
      (sum, { cpuTime: seconds }) => sum + seconds,
      0,
    );
  let before = await used();
  for (let second = 0; second < 30; ++second) {
    await new Promise((resolve) => setTimeout(resolve, 1000));
    const now = await used();
    if (now - before < 0.1) return session.detach();
    before = now;
  }
  throw new Error('the browser does not come to rest within 30 s of its start');
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
    const browser = await launchChromium({ drawing: false });
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

  /** Does something with a page that has loaded a scene, in a browser of its own. */
  private async withRealm<T>(scene: BenchScene, body: (realm: Realm, page: Page) => Promise<T>): Promise<T> {
    const browser = await launchChromium({ drawing: false });
    try {
      const page = await browser.newPage();
      await page.goto(`${this.origin}/page.html`);
      await page.waitForFunction(() => 'start' in window);
      await page.evaluate(
        (url) => (window as unknown as { start(url: string): Promise<void> }).start(url),
        this.urlOf(scene),
      );
      const realm: Realm = {
        pid: await rendererOf(browser, page),
        run: (who, runs): Promise<Block> =>
          page.evaluate(([w, n]) => (window as unknown as { runner: Runner }).runner.run(w, n), [who, runs] as const),
        differences: () => page.evaluate(() => (window as unknown as { runner: Runner }).runner.differences()),
      };
      return await body(realm, page);
    } finally {
      await browser.close();
    }
  }

  /** Races in one page. */
  async race(scene: BenchScene, options: RaceOptions): Promise<RaceResult> {
    return this.withRealm(scene, (realm) => race(realm, options));
  }

  /**
   * The package alone on a slower processor, as DevTools emulate it: by the clock on the wall, over runs in several browsers, one after
   * the other, lest what else the machine does for a moment decide.
   */
  async throttled(scene: BenchScene, rate: number, launches: number, runs: number): Promise<Spread> {
    const times: number[] = [];
    for (let i = 0; i < launches; ++i) {
      const more = await this.withRealm(scene, async (realm, page) => {
        await throttle(page, rate);
        await realm.run('cagecast', 300);
        return realm.run('cagecast', runs);
      });
      times.push(...more.times);
    }
    return spread(times);
  }

  /**
   * The package in a page against Embree natively, both on the same core and in CPU time, in turns.
   * @return The median over turns of Embree's time ÷ the package's, and the medians of both in ms.
   */
  async againstNativeEmbree(
    scene: BenchScene,
    turns: number,
  ): Promise<{ ratio: number; cagecast: number; embree: number }> {
    const native = (): Promise<number> =>
      measureNative(scene.path, 21, ['embree']).then(({ peers }) => peers['embree']!.times.total.median);
    return this.withRealm(scene, async (realm) => {
      await output('taskset', ['-a', '-c', '-p', '0', String(realm.pid)]);
      const runs = await warmUp(realm, 'cagecast', 100, 50);
      const pairs: { cagecast: number; embree: number }[] = [];
      for (let i = 0; i < turns; ++i)
        pairs.push({ cagecast: (await turn(realm, 'cagecast', runs)).cpu, embree: await native() });
      return {
        ratio: median(pairs.map(({ cagecast, embree }) => embree / cagecast)),
        cagecast: median(pairs.map(({ cagecast }) => cagecast)),
        embree: median(pairs.map(({ embree }) => embree)),
      };
    });
  }

  /**
   * The first use of the package in a browser that never loaded it, several times; the medians.
   * @param when While the browser itself still starts, or after.
   */
  async firstUse(
    scene: BenchScene,
    rate: number,
    launches: number,
    preset: Preset,
    when: 'at once' | 'at rest',
  ): Promise<FirstUse> {
    const all: FirstUse[] = [];
    for (let i = 0; i < launches; ++i) {
      const browser = await launchChromium({ drawing: false });
      try {
        const page = await browser.newPage();
        await page.goto(`${this.origin}/first-page.html`);
        await page.waitForFunction(() => 'firstUse' in window);
        if (when === 'at rest') await comeToRest(browser);
        await throttle(page, rate);
        all.push(
          await page.evaluate(
            ([url, script, preset]) =>
              (window as unknown as { firstUse(...of: string[]): Promise<FirstUse> }).firstUse(url, script, preset),
            [this.urlOf(scene), `${this.origin}/dist/index.js`, preset] as const,
          ),
        );
      } finally {
        await browser.close();
      }
    }
    const of = (field: keyof FirstUse): number => median(all.map((use) => use[field]));
    return {
      import: of('import'),
      init: of('init'),
      transfer: of('transfer'),
      total: of('total'),
      heap: of('heap'),
      heapLater: of('heapLater'),
    };
  }
}
