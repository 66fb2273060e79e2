/** The file, or what went wrong. */
export type PngReply = Blob | { message: string };

/**
 * Writes a PNG that has every byte of an image. A worker of its own does it, and ends with it: on the page's thread Chromium waits
 * until that has nothing else to do, which takes a second, or seven.
 * @throws Error if the browser cannot.
 */
export async function pngOf(image: ImageBitmapSource): Promise<Blob> {
  const bitmap = await createImageBitmap(image, { premultiplyAlpha: 'none' });
  const worker = new Worker(new URL('./png-worker.ts', import.meta.url), { type: 'module' });
  try {
    const reply = await new Promise<PngReply>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<PngReply>) => resolve(data);
      worker.onerror = (event) =>
        reject(new Error(`the PNG could not be begun${event.message ? `: ${event.message}` : ''}`));
      worker.postMessage(bitmap, [bitmap]);
    });
    if ('message' in reply) throw new Error(reply.message);
    return reply;
  } finally {
    worker.terminate();
  }
}
