import { askWorker } from './ask-worker';

/**
 * Encodes an image as a PNG without loss, in a worker: on the main thread Chromium encodes only when idle, which can take seconds.
 * @throws Error if the browser cannot encode it.
 */
export async function pngOf(image: ImageBitmapSource): Promise<Blob> {
  const bitmap = await createImageBitmap(image, { premultiplyAlpha: 'none' });
  const worker = new Worker(new URL('./png-worker.ts', import.meta.url), { type: 'module' });
  return askWorker<Blob>(worker, bitmap, [bitmap]);
}
