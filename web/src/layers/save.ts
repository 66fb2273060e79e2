import type { WebGLRenderer } from 'three';
import { download } from '../platform/download';
import { element, showError } from '../platform/page';
import { pngOf } from '../platform/png';
import type { Viewer } from '../view/viewer';
import type { Composite } from './composite';
import { readStraight } from './straight';

/**
 * Writes what the layers look like together as a PNG, in the cage's UV space: the texture to be drawn over any target.
 * @throws Error if the browser cannot encode it.
 */
async function compositePng(renderer: WebGLRenderer, composite: Composite): Promise<Blob> {
  composite.update(renderer);
  return pngOf(readStraight(renderer, composite.texture, composite.size));
}

/** Lets the texture be saved. @returns What makes a PNG of it. */
export function setUpSaving({ renderer }: Viewer, composite: Composite): () => Promise<Blob> {
  const png = (): Promise<Blob> => compositePng(renderer, composite);
  element('save-texture', HTMLButtonElement).addEventListener('click', async () => {
    try {
      download(await png(), 'paint.png');
    } catch (error) {
      showError(`The texture could not be saved: ${(error as Error).message}`);
    }
  });
  return png;
}
