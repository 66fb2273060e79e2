import { readFileSync } from 'node:fs';
import type { Locator, Page } from 'playwright-core';
import { modelArea } from './picture';
import { saved } from './saved';
import { glb, inRepository, ready, type Upload } from './site';

export const asset = (...names: string[]): Buffer => readFileSync(inRepository('examples/samples', ...names));

/** A head without a cage. */
export const head = (): Upload => glb('bust.glb', asset('human', 'target.glb'));

/** Waits until the page works, and then until it is ready again. */
export async function worked(page: Page): Promise<void> {
  await page.locator('#status:not([data-state=ready])').waitFor({ state: 'attached' });
  await ready(page);
}

/** Does something, and waits until the page has worked for it, however briefly. */
export async function workedFor(page: Page, act: () => Promise<unknown>): Promise<void> {
  const works = page.evaluate(
    () =>
      new Promise<void>((done) => {
        const observer = new MutationObserver(() => done());
        observer.observe(document.querySelector('#status')!, { attributeFilter: ['data-state'] });
      }),
  );
  await Promise.all([works, act()]);
  await ready(page);
}

export async function fitted(page: Page): Promise<void> {
  await page.getByTestId('fit-cage').click();
  await page.locator('#cage-note', { hasText: 'was fitted' }).waitFor();
  await ready(page);
  await page.locator('[data-landmark=nose_tip]').waitFor();
}

/** Where a landmark is seen, in client pixels. */
export async function placeOf(page: Page, name: string): Promise<{ x: number; y: number }> {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const box = (await page.locator(`[data-landmark=${name}]`).boundingBox())!;
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
}

/** The middle of the model, in client pixels. */
export async function middleOf(page: Page): Promise<{ x: number; y: number }> {
  const { x, y, width, height } = await modelArea(page);
  return { x: x + width / 2, y: y + height / 2 };
}

export async function drag(page: Page, name: string, dx: number, dy: number): Promise<void> {
  await placeOf(page, name); // once it is drawn
  await dragBy(page, page.locator(`[data-landmark=${name}]`), dx, dy);
}

export async function dragBy(page: Page, button: Locator, dx: number, dy: number): Promise<void> {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const box = (await button.boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + dx / 2, y + dy / 2);
  await page.mouse.move(x + dx, y + dy);
  await page.mouse.up();
}

/** A script that holds calls of functions of the engine back while `window.holds` is set, as it is at first, until `window.letGo()`. */
export const holdingBack = (
  ...fns: ('fitCage' | 'refineCage' | 'makeCage')[]
): string => `const { postMessage } = Worker.prototype;
window.held = [];
window.holds = true;
window.letGo = () => {
  window.holds = false;
  for (const post of window.held.splice(0)) post();
};
Worker.prototype.postMessage = function (message, ...rest) {
  const post = () => postMessage.call(this, message, ...rest);
  if (window.holds && ${JSON.stringify(fns)}.includes(message?.fn)) window.held.push(post);
  else post();
}`;

/** Waits until a call is held back. */
export async function heldBack(page: Page): Promise<void> {
  await page.waitForFunction(() => (window as unknown as { held: unknown[] }).held.length === 1);
}

/** The `extras` of the cage that the page saves. */
export async function savedCage(page: Page): Promise<{ landmarks: Record<string, number[]> }> {
  const { bytes } = await saved(page, 'save-cage');
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString()).nodes[0].extras;
}
