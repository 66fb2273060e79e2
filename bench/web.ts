import { readFileSync } from 'node:fs';
import { mkdir } from 'node:fs/promises';
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { build } from 'esbuild';
import type { Browser, Page } from 'playwright-core';
import { launchChromium } from '../tests/support/chromium.js';
import { root } from './native.js';
import type { BenchScene } from './scenes.js';
import type { FirstUse, RaceOptions, RaceResult } from './web/page.js';

const bundles = `${root}build/bench/web`;

/** Bundles the page. The package stays outside of it: it is measured as it is shipped. */
async function buildWeb(): Promise<void> {
  await mkdir(bundles, { recursive: true });
  await build({
    entryPoints: ['bench/web/page.ts'],
    bundle: true,
    splitting: true,
    format: 'esm',
    target: 'es2022',
    absWorkingDir: root,
    logLevel: 'error',
    outdir: bundles,
    external: ['cagecast'],
  });
}

/** Serves the checkout, isolated from other origins: a page then has a clock of 5 µs instead of 100. */
async function serve(): Promise<Server> {
  const types: Record<string, string> = { js: 'text/javascript', html: 'text/html' };
  const page = `<!doctype html><meta charset="utf-8"><title>bench</title>
<script type="importmap">{ "imports": { "cagecast": "/dist/index.js" } }</script>
<script type="module" src="/build/bench/web/page.js"></script>`;
  const server = createServer((request, response) => {
    const path = new URL(request.url!, 'http://localhost').pathname;
    response.setHeader('Cross-Origin-Opener-Policy', 'same-origin');
    response.setHeader('Cross-Origin-Embedder-Policy', 'require-corp');
    response.setHeader('Content-Type', types[path.split('.').at(-1)!] ?? 'application/octet-stream');
    try {
      // At once, and not by a thread that would have to be woken: the page's first use of the package waits for it.
      response.end(path === '/page.html' ? page : readFileSync(root + path.slice(1)));
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return server;
}

/** Waits until a browser has nothing of its own left to do: all its processes together take less than a tenth of a second's time. */
async function comeToRest(browser: Browser): Promise<void> {
  const session = await browser.newBrowserCDPSession();
  const used = async (): Promise<number> =>
    (await session.send('SystemInfo.getProcessInfo')).processInfo.reduce((sum, { cpuTime }) => sum + cpuTime, 0);
  let before = await used();
  for (let second = 0; second < 30; ++second) {
    await new Promise((resolve) => setTimeout(resolve, 1000));
    const now = await used();
    if (now - before < 0.1) return session.detach();
    before = now;
  }
  throw new Error('the browser does not come to rest within 30 s of its start');
}

/** Chromium, with the benchmark's page. */
export class WebBench {
  /** Of Chromium. */
  version = '';

  private constructor(private readonly server: Server) {}

  static async start(): Promise<WebBench> {
    await buildWeb();
    return new WebBench(await serve());
  }

  async stop(): Promise<void> {
    await new Promise((resolve) => this.server.close(resolve));
  }

  /** Calls a function of the page in a browser that never loaded the package. @param rate  How many times it is slowed down. */
  private async call<T>(name: 'race' | 'firstUse', scene: BenchScene, argument: unknown, rate: number): Promise<T> {
    const origin = `http://127.0.0.1:${(this.server.address() as AddressInfo).port}`;
    const browser = await launchChromium({ drawing: false });
    this.version = browser.version();
    try {
      const page: Page = await browser.newPage();
      await page.goto(`${origin}/page.html`);
      await page.waitForFunction(() => 'race' in window);
      await comeToRest(browser);
      const session = await page.context().newCDPSession(page);
      await session.send('Emulation.setCPUThrottlingRate', { rate });
      return await page.evaluate(
        ([fn, url, value]) =>
          (window as unknown as Record<string, (url: string, value: unknown) => Promise<T>>)[fn]!(url, value),
        [name, `${origin}/${scene.path.slice(root.length)}`, argument] as const,
      );
    } finally {
      await browser.close();
    }
  }

  /** Races the package against three-mesh-bvh in one page. */
  race(scene: BenchScene, options: RaceOptions): Promise<RaceResult> {
    return this.call('race', scene, options, 1);
  }

  /** A page's first use of the package, with the preset `default`. */
  firstUse(scene: BenchScene, rate: number): Promise<FirstUse> {
    return this.call('firstUse', scene, 'default', rate);
  }
}
