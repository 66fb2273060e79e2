import { mkdir, readFile } from 'node:fs/promises';
import { dirname } from 'node:path';
import { build } from 'esbuild';
import { launchChromium } from '../../tests/support/chromium.js';
import { root } from '../native.js';
import type { Model } from './models.js';
import type { Look, Row } from './sheet-page.js';

/** How models are shown; those that are not here from their left, with a board of squares for a paint. */
const views: Record<string, { paint: string; turn: number; rise: number }> = {
  lizard: { paint: 'paint-tiger.png', turn: 38, rise: 12 },
  human: { paint: 'paint-skull.png', turn: 16, rise: 6 },
  'human-fused': { paint: '../human/paint-makeup.png', turn: 16, rise: 6 },
  'human-misaligned': { paint: '../human/paint-skull.png', turn: 16, rise: 6 },
  car: { paint: 'paint-racing.png', turn: 38, rise: 16 },
};
const otherView = { turn: 30, rise: 10 };

/** Pixels along the sides of each picture. */
const cell = { width: 400, height: 300 };

/** What the columns are called. */
const heads: Record<Look, string> = {
  plain: 'model',
  cage: 'cage',
  naive: 'naive transfer',
  removed: 'removed, in red',
  paper: 'preset <i>paper</i>',
  default: 'result',
};

/** A picture of a sheet: files by their paths on disk. */
export interface Cell extends Row {
  look: Look;
}

/** A sheet of pictures. */
export interface Sheet {
  /** What the columns are called, HTML. */
  heads: readonly string[];
  /** A row of as many cells each. */
  rows: readonly { name?: string; cells: readonly Cell[] }[];
  /** Pixels along the sides of each picture. */
  cell: { width: number; height: number };
}

/**
 * Draws models with the package's own three.js adapter in Chromium, a row for each, all looks of a model from the same side.
 * @param models  Those that have a folder; the others are left out.
 * @param path    A JPEG or PNG, by its name.
 */
export async function drawSheet(models: readonly Model[], looks: readonly Look[], path: string): Promise<void> {
  const rows = models.flatMap(({ name, folder }) => {
    if (folder === undefined) return [];
    const { paint, ...view } = { paint: undefined, ...(views[name] ?? otherView) };
    const files = { target: `${folder}/target.glb`, cage: `${folder}/cage.glb` };
    const row: Row = { ...files, paint: paint === undefined ? undefined : `${folder}/${paint}`, ...view };
    return [{ cells: looks.map((look): Cell => ({ ...row, look })) }];
  });
  await drawCells({ heads: looks.map((look) => heads[look]), rows, cell }, path);
}

/** Draws a sheet. @param path  A JPEG or PNG, by its name. */
export async function drawCells(sheet: Sheet, path: string): Promise<void> {
  const entryPoints = [`${root}bench/quality/sheet-page.ts`];
  const script = await build({
    entryPoints,
    bundle: true,
    format: 'iife',
    target: 'es2022',
    write: false,
    absWorkingDir: root,
    logLevel: 'error',
  });
  const browser = await launchChromium({ drawing: true });
  try {
    // Its files are those of the models, and nothing else is there.
    const files = new Map<string, string>();
    const serve = (file: string): string => {
      const url = `/${files.size}`;
      files.set(url, file);
      return url;
    };
    const page = await browser.newPage({
      viewport: {
        width: sheet.heads.length * sheet.cell.width,
        height: sheet.rows.length * sheet.cell.height + 48,
      },
    });
    page.setDefaultTimeout(120_000);
    await page.route('**/*', async (route) => {
      const file = files.get(new URL(route.request().url()).pathname);
      if (file === undefined) await route.fulfill({ contentType: 'text/html', body: pageOf(sheet) });
      else await route.fulfill({ contentType: 'application/octet-stream', body: await readFile(file) });
    });
    await page.goto('http://sheet.test/sheet');
    await page.addScriptTag({ content: script.outputFiles[0]!.text });
    for (const { name, cells } of sheet.rows) {
      for (const { look, ...row } of cells) {
        const paint = row.paint === undefined ? undefined : serve(row.paint);
        const served: Row = { ...row, target: serve(row.target), cage: serve(row.cage), paint };
        await page.evaluate(([model, looks, size]) => drawRow(model, looks, size), [
          served,
          [look],
          sheet.cell,
        ] as const);
      }
      if (name !== undefined) await page.evaluate(nameLastRow, [name, cells.length] as const);
    }
    await mkdir(dirname(path), { recursive: true });
    await page.screenshot({ path, fullPage: true, ...(path.endsWith('.jpg') && { type: 'jpeg', quality: 82 }) });
  } finally {
    await browser.close();
  }
}

/** Writes a name on the first picture of the last row; runs in the page. */
function nameLastRow([name, columns]: readonly [string, number]): void {
  const canvases = document.querySelectorAll('canvas');
  const context = canvases[canvases.length - columns]!.getContext('2d')!;
  context.font = '600 16px system-ui, sans-serif';
  context.fillStyle = '#333';
  context.fillText(name, 8, 22);
}

const pageOf = ({ heads: names, cell: { width, height } }: Sheet): string => `<!doctype html><meta charset="utf-8">
<style>
  body { margin: 0; background: #fff; font: 600 20px/48px system-ui, sans-serif; color: #333 }
  main { display: grid; grid-template-columns: repeat(${names.length}, ${width}px); text-align: center }
  canvas { display: block; width: ${width}px; height: ${height}px }
</style>
<main>${names.map((name) => `<div>${name}</div>`).join('')}</main>`;
