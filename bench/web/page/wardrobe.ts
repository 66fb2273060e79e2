// What a move of a stroke costs with 1 to 12 avatars of 10,000 triangles: npx tsx bench/web/page/wardrobe.ts [count …]
//
// Processor time of the page's thread, the least of some runs, as other processes stretch it; and that of the graphics process, which
// draws by software here: a picture of twelve models has more to draw than that of one.

import type { Page } from 'playwright-core';
import { islandCage, lumpyBall } from '../../../tests/support/models';
import { drop, Site, settled } from '../../../tests/support/site';
import { mainThreadWork } from './processor-time';

const given = process.argv.slice(2).map(Number);
const kCounts = given.length > 0 ? given : [1, 2, 4, 8, 12];
const kSide = 71; // 10,082 triangles
const kMoves = 10;
const kRuns = 3;

// Texts, as functions would reach the page with the compiler's helpers in them.
const send = `(type, { x, y }, at, buttons) => document.querySelector('#view').dispatchEvent(new PointerEvent(type, {
  clientX: x + 3 * Math.cos(at), clientY: y + 3 * Math.sin(at), pointerId: 1, isPrimary: true, bubbles: true,
  button: type === 'pointermove' ? -1 : 0, buttons,
}))`;
const find = `async ({ left, top, width, height }) => {
  for (const row of [8, 5, 4, 3, 6, 7, 2]) {
    const over = [];
    for (let column = 2; column < 38; column++) {
      const place = { x: left + (column * width) / 40, y: top + (row * height) / 20 };
      (${send})('pointermove', place, 0, 0);
      await new Promise(requestAnimationFrame);
      if (document.querySelector('.brush-ring')?.checkVisibility()) over.push(place);
      else if (over.length > 2) break;
    }
    if (over.length > 2) return over[over.length >> 1];
  }
}`;
const move = `async (place) => {
  for (let i = 0; i < ${kMoves}; i++) {
    (${send})('pointermove', place, i, 1);
    await new Promise(requestAnimationFrame);
  }
}`;

/** A position of the page over the model that is painted on. */
async function findModel(page: Page): Promise<{ x: number; y: number }> {
  const { x: left, y: top, width, height } = (await page.locator('#view').boundingBox())!;
  const place = await page.evaluate(`(${find})(${JSON.stringify({ left, top, width, height })})`);
  if (!place) throw new Error('the model is not seen');
  return place as { x: number; y: number };
}

async function measure(page: Page): Promise<{ page: number; graphics: number }> {
  const place = JSON.stringify(await findModel(page));
  const system = await page.context().browser()!.newBrowserCDPSession();
  const graphics = async (): Promise<number> => {
    const { processInfo } = await system.send('SystemInfo.getProcessInfo');
    return processInfo.find(({ type }) => type === 'GPU')?.cpuTime ?? 0;
  };
  const runs: { page: number; graphics: number }[] = [];
  for (let run = 0; run <= kRuns; run++) {
    await page.evaluate(`(${send})('pointerdown', ${place}, 0, 1)`);
    await page.evaluate(`(${move})(${place})`); // uploads, and compiles shaders
    const before = await graphics();
    const { total } = await mainThreadWork(page, () => page.evaluate(`(${move})(${place})`));
    const drawn = (await graphics()) - before;
    await page.evaluate(`(${send})('pointerup', ${place}, 0, 0)`);
    if (run > 0) runs.push({ page: total / kMoves, graphics: (1000 * drawn) / kMoves });
  }
  const least = (of: (run: (typeof runs)[0]) => number): number => Math.min(...runs.map(of));
  return { page: least((run) => run.page), graphics: least((run) => run.graphics) };
}

const site = await Site.open();
try {
  const { page } = await site.visit({ viewport: { width: 900, height: 600 }, deviceScaleFactor: 0.25 });
  await page.evaluate("document.querySelector('#view').setPointerCapture = () => {}"); // there is no such pointer
  const [cage, { buffer }] = [await islandCage(1), await lumpyBall(kSide)];
  const ball = (number: number) => ({ name: `ball-${number}.glb`, mimeType: 'model/gltf-binary', buffer });
  await drop(page, [ball(1), cage]);
  await settled(page);
  await page.locator('#view-mode input[value=result]').check({ force: true });
  await page.getByTestId('open-wardrobe').click();
  await page.locator('#tools label', { hasText: 'Brush' }).click();
  console.log('| avatars | page, ms per move | to one | drawing, ms per move |\n|---|---|---|---|');
  let count = 1;
  let one: number | undefined;
  for (const wanted of kCounts) {
    const more = Array.from({ length: wanted - count }, (_, i) => ball(count + i + 1));
    count = wanted;
    if (more.length > 0) await drop(page, [...more, cage]);
    await page.waitForFunction(
      (wanted) => {
        const cards = [...document.querySelectorAll('.avatars .avatar')];
        return cards.length === wanted && cards.every((card) => / %/.test(card.textContent!));
      },
      wanted,
      { timeout: 120_000 },
    );
    await page.waitForTimeout(3000); // the pictures are drawn again once nothing changes
    const { page: spent, graphics } = await measure(page);
    one ??= spent;
    console.log(`| ${wanted} | ${spent.toFixed(2)} | ${(spent / one).toFixed(2)} | ${graphics.toFixed(1)} |`);
  }
} finally {
  await site.close();
}
