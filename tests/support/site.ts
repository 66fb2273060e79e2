import assert from 'node:assert/strict';
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after } from 'node:test';
import { fileURLToPath } from 'node:url';
import { type Browser, type BrowserContext, type BrowserContextOptions, chromium, type Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { launchChromium } from './chromium';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kConfig = path.join(kRoot, 'web/vite.config.ts');
/** Milliseconds. Long enough for software rendering on a busy machine, but ends tests of a page that hangs. */
const kPatience = 60_000;
/** No test depends on antialiasing, which doubles the cost of software rendering, nor on anisotropy, at which Mesa 22 can hang. */
const kCheapDrawing = `
  const { getExtension } = WebGL2RenderingContext.prototype
  WebGL2RenderingContext.prototype.getExtension = function (name) {
    return name === 'EXT_texture_filter_anisotropic' ? null : getExtension.call(this, name)
  }
  const { getContext } = HTMLCanvasElement.prototype
  HTMLCanvasElement.prototype.getContext = function (type, options) {
    return getContext.call(this, type, options?.antialias ? { ...options, antialias: false } : options)
  }`;
/** A script that takes WebGL away, for pages of which no picture is needed: drawing takes most of the time. */
export const kNoWebGl = `HTMLCanvasElement.prototype.getContext = new Proxy(HTMLCanvasElement.prototype.getContext, {
  apply: (original, canvas, args) => (String(args[0]).startsWith('webgl') ? null : Reflect.apply(original, canvas, args)),
});`;
/** The guide is offered at first visits only; all controls are those of Inspect. */
const kSecondVisit = `try {
  localStorage.setItem('cagecast-guide', 'seen');
  localStorage.setItem('cagecast-face', 'inspect');
} catch {}`;
/** A script that shows what a first visitor gets: Play. */
export const kPlay = `try { localStorage.removeItem('cagecast-face') } catch {}`;
/** Logged by Playwright when service workers are blocked, by Chromium when it reads back what WebGL drew, and by three.js without it. */
const kExpected =
  /^Service Worker registration blocked by Playwright$|GPU stall due to ReadPixels|Error creating WebGL context/;

/** A file inside the repository. */
export const inRepository = (...names: string[]): string => path.join(kRoot, ...names);

type Look = 'cheap' | 'real';

/** An open page, with its complaints and its requests to other hosts. */
export interface Visit {
  page: Page;
  /** Console errors and warnings, exceptions, and violations of the content security policy. */
  complaints: string[];
  /** URLs of requests to other origins. */
  foreign: string[];
}

async function serve(): Promise<{ url: string; folder: string; stop(): Promise<void> }> {
  const { build, preview } = await import('vite'); // takes half a second, so only when needed
  const folder = await mkdtemp(path.join(tmpdir(), 'cagecast-page-'));
  await build({ configFile: kConfig, logLevel: 'error', build: { outDir: folder } });
  const server = await preview({
    configFile: kConfig,
    logLevel: 'error',
    build: { outDir: folder },
    preview: { host: '127.0.0.1', port: 0 },
  });
  const stop = async (): Promise<void> => {
    await server.close();
    await rm(folder, { recursive: true, force: true });
  };
  return { url: server.resolvedUrls!.local[0]!, folder, stop };
}

/** The built page, served, and a browser. */
export class Site {
  private visitor: BrowserContext | undefined;

  private constructor(
    readonly url: string,
    /** The folder of the built page. */
    readonly folder: string,
    readonly browser: Browser,
    private readonly look: Look,
    private readonly stop: () => Promise<void>,
  ) {}

  /**
   * Starts Chromium, and builds and serves the page on a free port, unless the environment variables CAGECAST_SITE and
   * CAGECAST_PAGE give the URL and the folder of a page that is served already, and CAGECAST_BROWSER that of a browser.
   * @param look  `real`: by Chromium's own renderer, with antialiasing and anisotropy. Default: in less time.
   */
  static async open(look: Look = 'cheap'): Promise<Site> {
    const { CAGECAST_SITE: url, CAGECAST_PAGE: folder, CAGECAST_BROWSER: server } = process.env;
    const [served, browser] = await Promise.all([
      url && folder ? { url, folder, stop: async () => {} } : serve(),
      server && look === 'cheap'
        ? chromium.connect(server)
        : launchChromium({ drawing: true, renderer: look === 'real' ? 'swiftshader' : undefined }),
    ]);
    return new Site(served.url, served.folder, browser, look, async () => {
      await browser.close();
      await served.stop();
    });
  }

  close(): Promise<void> {
    return this.stop();
  }

  /**
   * Opens the page and waits until it shows the first sample. Ends the previous visit.
   * @param options   Defaults: 1000 × 700, light, reduced motion, no service worker, and a low pixel ratio, as software rendering
   *                  takes most of the time.
   * @param prepare   A script to run before the page's own, or a function to call before navigation.
   * @param fragment  The URL fragment, with `#`.
   */
  async visit(
    options: BrowserContextOptions = {},
    prepare?: string | ((page: Page) => Promise<void>),
    fragment = '',
  ): Promise<Visit> {
    await this.visitor?.close();
    this.visitor = await this.browser.newContext({
      viewport: { width: 1000, height: 700 },
      deviceScaleFactor: 0.35,
      colorScheme: 'light',
      reducedMotion: 'reduce',
      serviceWorkers: 'block',
      ...options,
    });
    const page = await this.visitor.newPage();
    page.setDefaultTimeout(kPatience);
    const visit: Visit = { page, complaints: [], foreign: [] };
    page.on('console', (message) => {
      if (kExpected.test(message.text())) return;
      if (message.type() === 'error' || message.type() === 'warning') visit.complaints.push(message.text());
    });
    page.on('pageerror', (error) => visit.complaints.push(String(error)));
    page.on('request', (request) => {
      const { origin, protocol } = new URL(request.url());
      if (protocol.startsWith('http') && origin !== new URL(this.url).origin) visit.foreign.push(request.url());
    });
    if (this.look === 'cheap') await page.addInitScript({ content: kCheapDrawing });
    await page.addInitScript({ content: kSecondVisit });
    if (typeof prepare === 'string') await page.addInitScript({ content: prepare });
    else await prepare?.(page);
    await page.goto(this.url + fragment);
    await settled(page);
    return visit;
  }
}

/** Opens the page for the tests of a file, and closes it after them. @param look  As for `Site.open`. */
export async function openSite(look?: Look): Promise<Site> {
  const site = await Site.open(look);
  after(() => site.close());
  return site;
}

/** Waits until the page is idle, and returns its status. */
export async function settled(page: Page): Promise<string> {
  // Return the status that was found: it may have changed since.
  const status = await page.waitForFunction(
    () => {
      const shown = document.querySelector<HTMLElement>('[data-testid=status]')?.dataset.state;
      // What the first picture does without is added when somebody begins to use the page.
      if (!('complete' in document.documentElement.dataset)) dispatchEvent(new Event('pointermove'));
      if (!('complete' in document.documentElement.dataset)) return undefined;
      return ['ready', 'error'].find((status) => status === shown);
    },
    undefined,
    { timeout: kPatience },
  );
  return (await status.jsonValue())!;
}

/** Waits until the page shows what it was given. @throws AssertionError with what it says instead. */
export async function ready(page: Page): Promise<void> {
  assert.equal(await settled(page), 'ready', await shownError(page));
}

/** Number of target vertices per zone. */
export interface Counts {
  cosmetic: number;
  occluded: number;
  uncovered: number;
  culled: number;
}

/** The counts shown on the page. */
export async function shownCounts(page: Page): Promise<Counts> {
  const count = async (zone: string): Promise<number> => {
    const text = (await page.getByTestId(`count-${zone}`).textContent())!;
    if (!/^\d+$/.test(text)) throw new Error(`count-${zone} is “${text}”, not bare digits`);
    return Number(text);
  };
  return {
    cosmetic: await count('cosmetic'),
    occluded: await count('occluded'),
    uncovered: await count('uncovered'),
    culled: await count('culled'),
  };
}

/** A row of the table of parts. */
export interface ShownPart {
  name: string;
  points: number;
  /** Such as “97 %”. */
  covered: string;
  culled: boolean;
  lock: string;
}

/** The table of parts, even if it is collapsed. */
export function shownParts(page: Page): Promise<ShownPart[]> {
  return page
    .getByTestId('segment-table')
    .locator('tbody tr:not(.mesh)')
    .evaluateAll((rows) =>
      rows.map((row) => {
        const [name, points, covered, verdict] = [...row.children].map((cell) => cell.textContent ?? '');
        return {
          name: name!,
          points: Number(points!.replaceAll(',', '')),
          covered: covered!,
          culled: verdict === 'culled',
          lock: row.querySelector('select')!.value,
        };
      }),
    );
}

/** The error message on the page, or an empty string. */
export async function shownError(page: Page): Promise<string> {
  const error = page.getByTestId('error');
  return (await error.isVisible()) ? (await error.textContent())! : '';
}

/** Moves the threshold slider. */
export async function setThreshold(page: Page, threshold: number): Promise<void> {
  await page.getByTestId('threshold').fill(String(threshold));
}

/** A file to give to the page. */
export interface Upload {
  name: string;
  mimeType: string;
  buffer: Buffer;
}

/** A GLB to give to the page. */
export function glb(name: string, buffer: Buffer): Upload {
  return { name, mimeType: 'model/gltf-binary', buffer };
}

/** A violet paint, of hue 295°, as a PNG to give to the page. */
export function violetPaint(): Upload {
  const png = new PNG({ width: 8, height: 8 });
  for (let at = 0; at < png.data.length; at += 4) png.data.set([200, 0, 220, 255], at);
  return { name: 'violet.png', mimeType: 'image/png', buffer: PNG.sync.write(png) };
}

/** Drops files on the page together. */
export async function drop(page: Page, uploads: Upload[]): Promise<void> {
  const files = uploads.map(({ name, mimeType, buffer }) => ({ name, mimeType, base64: buffer.toString('base64') }));
  await page.evaluate(async (files) => {
    const transfer = new DataTransfer();
    for (const { name, mimeType, base64 } of files) {
      const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
      transfer.items.add(new File([bytes], name, { type: mimeType }));
    }
    for (const type of ['dragover', 'drop']) {
      document.body.dispatchEvent(new DragEvent(type, { dataTransfer: transfer, bubbles: true, cancelable: true }));
    }
  }, files);
}

/** Waits by the page's own clock: earlier timers of the page have run by then, however slow it is. */
export const passed = (page: Page, milliseconds: number): Promise<void> =>
  page.evaluate((time) => new Promise<void>((done) => setTimeout(done, time)), milliseconds);
