import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';

/** A part of the page, in CSS pixels. */
export interface Area {
  x: number;
  y: number;
  width: number;
  height: number;
}

/**
 * The part of the view where the model is; controls that lie over it in small views are unseen from then on. Scrolls to the top:
 * pictures taken where half a pixel is scrolled away differ from all others.
 */
export async function modelArea(page: Page): Promise<Area> {
  await page.evaluate(() => {
    document.querySelector('#quick-paint')?.setAttribute('style', 'visibility: hidden');
    for (const controls of document.querySelectorAll('.stage-head, .rail, .angles, .side, .legend'))
      controls.setAttribute('style', 'opacity: 0'); // can still be used
    scrollTo({ top: 0, behavior: 'instant' });
  });
  const box = (await page.locator('#view').boundingBox())!;
  return { x: box.x + 0.1 * box.width, y: box.y + 0.14 * box.height, width: 0.8 * box.width, height: 0.5 * box.height };
}

/** Waits for a number of frames. */
export function frames(page: Page, count: number): Promise<void> {
  return page.evaluate(async (count) => {
    for (let i = 0; i < count; i++) await new Promise(requestAnimationFrame);
  }, count);
}

/** A screenshot of an area, two frames from now, when they are drawn. */
export async function look(page: Page, area: Area): Promise<PNG> {
  await frames(page, 2);
  await page.evaluate(async () => {
    // The GPU process may lag behind. Reading a pixel would wait too, but clears the picture.
    const gl = document.querySelector<HTMLCanvasElement>('#view')!.getContext('webgl2');
    const sync = gl?.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!gl || !sync) return;
    gl.flush();
    while (gl.getSyncParameter(sync, gl.SYNC_STATUS) === gl.UNSIGNALED) await new Promise(requestAnimationFrame);
    gl.deleteSync(sync);
  });
  return PNG.sync.read(await page.screenshot({ clip: area }));
}

/** Takes screenshots until one matches. @throws Error after a minute. */
export async function watch(page: Page, area: Area, seen: (picture: PNG) => boolean): Promise<void> {
  for (const deadline = Date.now() + 60_000; !seen(await look(page, area)); )
    if (Date.now() > deadline) throw new Error('it is not seen');
}

/** The share of pixels that differ visibly, 0..1. */
export function difference(a: PNG, b: PNG): number {
  if (a.width !== b.width || a.height !== b.height) throw new Error('the pictures differ in size');
  let differing = 0;
  for (let at = 0; at < a.data.length; at += 4) {
    const apart = Math.max(...[0, 1, 2].map((channel) => Math.abs(a.data[at + channel]! - b.data[at + channel]!)));
    if (apart > 16) differing++;
  }
  return differing / (a.width * a.height);
}

/** The columns `from` to `to` of a picture, as shares of its width. */
export function columns(picture: PNG, from: number, to: number): PNG {
  const left = Math.round(from * picture.width);
  const part = new PNG({ width: Math.round(to * picture.width) - left, height: picture.height });
  PNG.bitblt(picture, part, left, 0, part.width, part.height, 0, 0);
  return part;
}

/** The part of an area that has strong colours in its picture: a model, if the background is grey. */
export function coloredPart(area: Area, { data, width, height }: PNG): Area {
  const [columns, rows] = [new Set<number>(), new Set<number>()];
  for (let i = 0; i < width * height; i++) {
    const channels = data.subarray(4 * i, 4 * i + 3);
    if (Math.max(...channels) - Math.min(...channels) < 60) continue;
    columns.add(i % width);
    rows.add(Math.floor(i / width));
  }
  const [left, right] = [Math.min(...columns), Math.max(...columns)].map((x) => (x * area.width) / width) as [
    number,
    number,
  ];
  const [top, bottom] = [Math.min(...rows), Math.max(...rows)].map((y) => (y * area.height) / height) as [
    number,
    number,
  ];
  return { x: area.x + left, y: area.y + top, width: right - left, height: bottom - top };
}

/** The share of pixels whose hue is within 12° of `hue` and which are clearly coloured. */
export function shareOfHue({ data, width, height }: PNG, hue: number): number {
  let found = 0;
  for (let at = 0; at < data.length; at += 4) {
    const [r, g, b] = [data[at]!, data[at + 1]!, data[at + 2]!];
    const most = Math.max(r, g, b);
    const spread = most - Math.min(r, g, b);
    if (spread < 0.35 * most || most < 60) continue;
    const sixth = most === r ? ((g - b) / spread + 6) % 6 : most === g ? (b - r) / spread + 2 : (r - g) / spread + 4;
    const apart = Math.abs(60 * sixth - hue);
    if (Math.min(apart, 360 - apart) < 12) found++;
  }
  return found / (width * height);
}
