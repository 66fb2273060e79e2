import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { drop, kPlay, ready, Site } from '../../tests/support/site.js';
import { table } from '../table.js';
import { mainThreadWork } from '../web/page/processor-time.js';

/** What the page takes from a drop until the model stands there painted. */
export interface PageWait {
  /** Milliseconds of processor time of its process: reading, cages and transfer, and what draws, but for the graphics process. */
  all: number;
  /** Of these, on its main thread. */
  main: number;
  /** The longest task there. */
  longest: number;
  /** Seconds of the clock; drawing by software takes part of it. */
  seconds: number;
}

/** Drops each file on a page of its own, in a Chromium that draws by software. */
export async function measurePage(
  models: readonly (readonly [name: string, path: string])[],
  say: (line: string) => void,
) {
  const site = await Site.open();
  const waits: Record<string, PageWait> = {};
  try {
    const processes = await site.browser.newBrowserCDPSession();
    const spent = async (): Promise<number> => {
      const { processInfo } = await processes.send('SystemInfo.getProcessInfo');
      return processInfo.reduce((sum, { type, cpuTime }) => sum + (type === 'renderer' ? 1000 * cpuTime : 0), 0);
    };
    for (const [name, path] of models) {
      say(`the page: ${name}`);
      const { page } = await site.visit({}, kPlay);
      const file = { name: basename(path), mimeType: '', buffer: readFileSync(path) };
      const [before, began] = [await spent(), performance.now()];
      const { total, longest } = await mainThreadWork(page, async () => {
        await drop(page, [file]);
        await ready(page);
      });
      waits[name] = {
        all: (await spent()) - before,
        main: total,
        longest,
        seconds: (performance.now() - began) / 1000,
      };
    }
  } finally {
    await site.close();
  }
  return waits;
}

/** A line for each model. */
export const pageTable = (waits: Record<string, PageWait>): string =>
  table(
    ['the page', 'ms', 'main thread', 'longest task', 's of the clock'],
    Object.entries(waits).map(([name, { all, main, longest, seconds }]) => [
      name,
      ...[all, main, longest].map((ms) => ms.toFixed(0)),
      seconds.toFixed(1),
    ]),
  );
