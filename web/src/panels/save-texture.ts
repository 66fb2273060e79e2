import type { WebGLRenderer } from 'three';
import { type Composite, readStraight } from '#three';
import { download } from '../platform/download';
import { requireGraphics } from '../platform/graphics';
import { element, showError } from '../platform/page';
import { pngOf } from '../platform/png';
import type { Viewer } from '../view/viewer';

/**
 * Encodes the composite of the layers as a PNG, in the cage's UV space.
 * @throws Error if the browser cannot draw or encode it.
 */
async function compositePng(renderer: WebGLRenderer, composite: Composite): Promise<Blob> {
  requireGraphics(renderer);
  composite.update(renderer);
  return pngOf(readStraight(renderer, composite.texture, composite.size));
}

/** Connects the button that saves the texture. @returns A function that encodes it as a PNG. */
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
