import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import type { Browser, BrowserContext, BrowserContextOptions, CDPSession, Page } from 'playwright-core';
import { launchChromium } from '../chromium';

const kRoot = fileURLToPath(new URL('../..', import.meta.url));
const kConfig = path.join(kRoot, 'web/vite.config.ts');
/** Long enough for software rendering on a busy machine; a page that hangs still ends the test. */
const kPatience = 60_000;
/** What Playwright itself logs where a visit has no service workers. */
const kBlocked = 'Service Worker registration blocked by Playwright';

/** A file inside the repository. */
export const inRepository = (...names: string[]): string => path.join(kRoot, ...names);

/** The page in a browser, and everything it complained about or asked other hosts for. */
export interface Visit {
  page: Page;
  /** Errors and warnings on the console, exceptions, breaches of the content security policy. */
  complaints: string[];
  /** Addresses asked for that are not the site's own. */
  foreign: string[];
}

async function serve(): Promise<{ url: string; folder: string; stop(): Promise<void> }> {
  const { build, preview } = await import('vite'); // half a second, for those who serve
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

/** The built page, served, and a browser to visit it with. */
export class Site {
  private visitor: BrowserContext | undefined;

  private constructor(
    readonly url: string,
    /** Where the built page lies. */
    readonly folder: string,
    readonly browser: Browser,
    private readonly stop: () => Promise<void>,
  ) {}

  /**
   * Starts Chromium, and builds and serves the page as it is published, on a free port. Whoever runs many files of tests has done
   * that once for all: the environment variables CAGECAST_SITE and CAGECAST_PAGE are the address and the folder of the built page.
   */
  static async open(): Promise<Site> {
    const { CAGECAST_SITE: url, CAGECAST_PAGE: folder } = process.env;
    const [served, browser] = await Promise.all([
      url && folder ? { url, folder, stop: async () => {} } : serve(),
      launchChromium({ drawing: true }),
    ]);
    return new Site(served.url, served.folder, browser, async () => {
      await browser.close();
      await served.stop();
    });
  }

  close(): Promise<void> {
    return this.stop();
  }

  /**
   * Opens the page and waits until it shows the first sample. One visit at a time: a new one ends the last.
   * @param options   A still picture 1000 × 700 in light colours, of half as many pixels each way, as drawing takes most of the
   *                  time; nothing kept for later; unless they say otherwise.
   * @param prepare   A script that runs in the page before its own, or what is to be done with the page before it goes there.
   * @param fragment  What the address ends with, from its `#` on.
   */
  async visit(
    options: BrowserContextOptions = {},
    prepare?: string | ((page: Page) => Promise<void>),
    fragment = '',
  ): Promise<Visit> {
    await this.visitor?.close();
    this.visitor = await this.browser.newContext({
      viewport: { width: 1000, height: 700 },
      deviceScaleFactor: 0.5,
      colorScheme: 'light',
      reducedMotion: 'reduce',
      serviceWorkers: 'block',
      ...options,
    });
    const page = await this.visitor.newPage();
    page.setDefaultTimeout(kPatience);
    const visit: Visit = { page, complaints: [], foreign: [] };
    page.on('console', (message) => {
      if (message.text() === kBlocked) return;
      if (message.type() === 'error' || message.type() === 'warning') visit.complaints.push(message.text());
    });
    page.on('pageerror', (error) => visit.complaints.push(String(error)));
    page.on('request', (request) => {
      const { origin, protocol } = new URL(request.url());
      if (protocol.startsWith('http') && origin !== new URL(this.url).origin) visit.foreign.push(request.url());
    });
    if (typeof prepare === 'string') await page.addInitScript({ content: prepare });
    else await prepare?.(page);
    await page.goto(this.url + fragment);
    await settled(page);
    return visit;
  }
}

/** What the page's main thread did. Milliseconds of its own processor time: a busy machine does not count against it. */
export interface Work {
  /** Of the longest task; between tasks the page takes input and draws. */
  longest: number;
  total: number;
}

/**
 * Measures the tasks of the page's main thread while something is done.
 * @param until Something that the browser notes as it loads a page, by its name in traces: what comes after it does not count.
 */
export async function mainThreadWork(page: Page, action: () => Promise<unknown>, until?: string): Promise<Work> {
  const browser = page.context().browser()!;
  await browser.startTracing(page, { categories: ['toplevel', 'loading'] });
  let trace: { traceEvents: TraceEvent[] };
  try {
    await action();
  } finally {
    trace = JSON.parse((await browser.stopTracing()).toString());
  }
  const threads = trace.traceEvents.filter(
    ({ name, args }) => name === 'thread_name' && args?.name === 'CrRendererMain',
  );
  const isMain = ({ pid, tid }: TraceEvent): boolean =>
    threads.some((thread) => thread.pid === pid && thread.tid === tid);
  const end = until === undefined ? Infinity : trace.traceEvents.find(({ name }) => name === until)?.ts;
  if (end === undefined) throw new Error(`the trace has no ${until}`);
  // The page's own process is the busiest of its kind.
  const byProcess = new Map<number, number[]>();
  for (const event of trace.traceEvents) {
    if (event.name !== 'ThreadControllerImpl::RunTask' || event.tdur === undefined || event.ts > end || !isMain(event))
      continue;
    byProcess.set(event.pid, [...(byProcess.get(event.pid) ?? []), event.tdur / 1000]);
  }
  const work = [...byProcess.values()].map((tasks) => ({
    longest: Math.max(...tasks),
    total: tasks.reduce((sum, task) => sum + task, 0),
  }));
  const busiest = work.toSorted((a, b) => b.total - a.total)[0];
  if (!busiest) throw new Error('the trace has no tasks of a main thread');
  return busiest;
}

/** Milliseconds of processor time that `compute` takes where tests' limits in milliseconds were set. */
export const kComputation = 300;

/**
 * Computes what always takes the page's thread the same: others on the same processor stretch even processor time, and what is
 * measured can be held against this.
 * @param tasks So many, of equal length.
 */
export function compute(page: Page, tasks = 1): Promise<unknown> {
  return page.evaluate(async (tasks) => {
    let [a, b, c, d] = [1, 2, 3, 4];
    for (let task = 0; task < tasks; task++) {
      for (let i = 0; i < 50_000_000 / tasks; i++) {
        a = (Math.imul(a, 1_664_525) + 1_013_904_223) | 0;
        b = (Math.imul(b, 22_695_477) + 12_345) | 0;
        c = ((c ^ (c << 7)) + i) | 0;
        d = ((d ^ (d >>> 3)) + i) | 0;
      }
      await new Promise((done) => setTimeout(done));
    }
    return a ^ b ^ c ^ d;
  }, tasks);
}

/**
 * Opens the page and returns the seconds of processor time until its first picture: of the page's thread, and of the graphics process.
 * And what is always the same: a computation of the page's thread, and each of the next pictures.
 */
export async function processorTime(
  site: Site,
): Promise<{ page: number; graphics: number; computation: number; picture: number }> {
  const { browser } = site;
  const system = await browser.newBrowserCDPSession();
  const graphics = async (): Promise<number> => {
    const { processInfo } = await system.send('SystemInfo.getProcessInfo');
    return processInfo.find(({ type }) => type === 'GPU')?.cpuTime ?? 0;
  };
  const before = await graphics();
  let session: CDPSession | undefined;
  const { page } = await site.visit({ deviceScaleFactor: 1 }, async (page) => {
    session = await page.context().newCDPSession(page);
    await session.send('Performance.enable', { timeDomain: 'threadTicks' });
  });
  // Reading a pixel waits until everything before it is drawn.
  const drawn = (turns: number): Promise<void> =>
    page.evaluate(async (turns) => {
      const canvas = document.querySelector('canvas')!;
      for (let turn = 0; turn < turns; turn++) {
        canvas.dispatchEvent(
          new KeyboardEvent('keydown', { key: turn % 2 === 0 ? 'ArrowRight' : 'ArrowLeft', bubbles: true }),
        );
        await new Promise(requestAnimationFrame);
      }
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      const gl = canvas.getContext('webgl2')!;
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }, turns);
  await drawn(0);
  const first = await graphics();
  const ofPage = async (): Promise<number> =>
    (await session!.send('Performance.getMetrics')).metrics.find(({ name }) => name === 'ThreadTime')!.value;
  const firstOfPage = await ofPage();
  await compute(page);
  const computation = (await ofPage()) - firstOfPage;
  const kTurns = 4;
  await drawn(kTurns);
  return { page: firstOfPage, graphics: first - before, computation, picture: ((await graphics()) - first) / kTurns };
}

interface TraceEvent {
  name: string;
  pid: number;
  tid: number;
  /** When it began, in microseconds. */
  ts: number;
  /** Processor time, in microseconds. */
  tdur?: number;
  args?: { name?: string };
}

/** Waits until the page neither loads nor works, and returns its status. */
export async function settled(page: Page): Promise<string> {
  // What was found, not what is there by the time one asks again: it may be at work again.
  const status = await page.waitForFunction(
    () => ['ready', 'error'].find((status) => status === document.querySelector('[data-testid=status]')?.textContent),
    undefined,
    { timeout: kPatience },
  );
  return (await status.jsonValue())!;
}

/** Numbers of target vertices by zone. */
export interface Counts {
  cosmetic: number;
  occluded: number;
  uncovered: number;
  culled: number;
}

/** The counts as the page shows them. */
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

/** A row of the table of parts, as the page shows it. */
export interface ShownPart {
  name: string;
  points: number;
  /** As a text, such as “97 %”. */
  covered: string;
  culled: boolean;
  lock: string;
}

/** The table of parts, from top to bottom; it may be closed. */
export function shownParts(page: Page): Promise<ShownPart[]> {
  return page
    .getByTestId('segment-table')
    .locator('tbody tr')
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

/** The message the page shows, or an empty string. */
export async function shownError(page: Page): Promise<string> {
  const error = page.getByTestId('error');
  return (await error.isVisible()) ? (await error.textContent())! : '';
}

/** Moves the threshold's slider, as a hand would. */
export async function setThreshold(page: Page, threshold: number): Promise<void> {
  await page.getByTestId('threshold').fill(String(threshold));
}

/** A file to give to the page. */
export interface Upload {
  name: string;
  mimeType: string;
  buffer: Buffer;
}

/** Drops files on the page, all at once. */
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
