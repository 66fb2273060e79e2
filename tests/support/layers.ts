import type { Locator, Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { saved } from './saved';
import type { Upload } from './site';

/** A PNG file. @param colorAt Red, green, blue, alpha; 0..255. */
export function image(name: string, size: number, colorAt: (x: number, y: number) => readonly number[]): Upload {
  const png = new PNG({ width: size, height: size });
  for (let y = 0; y < size; y++) for (let x = 0; x < size; x++) png.data.set(colorAt(x, y), 4 * (y * size + x));
  return { name, mimeType: 'image/png', buffer: PNG.sync.write(png) };
}

/** The composite of the layers as saved by the page; by a key, as the mouse may be in use. */
export async function savedTexture(page: Page): Promise<PNG> {
  return PNG.sync.read((await saved(page, 'save-texture', 'Enter')).bytes);
}

/** Red, green, blue and alpha of a texel, 0..255. */
export function texel({ data, width }: PNG, x: number, y: number): number[] {
  return [...data.subarray(4 * (y * width + x), 4 * (y * width + x) + 4)];
}

/** The number of texels that are not transparent. */
export function filled({ data }: PNG): number {
  let count = 0;
  for (let at = 3; at < data.length; at += 4) if (data[at]! > 0) count++;
  return count;
}

/** The rows of the list of layers, the uppermost first. */
export function rows(page: Page): Locator {
  return page.getByTestId('layer-list').locator('li');
}

/** The names in the list of layers, the uppermost first. */
export function names(page: Page): Promise<string[]> {
  return rows(page).locator('.name').allTextContents();
}
