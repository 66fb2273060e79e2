/** The file, or an error message. */
export type PngReply = Blob | { message: string };

/**
 * Encodes an image as a PNG without loss, in a temporary worker: on the main thread Chromium encodes only when idle, which
 * can take seconds.
 * @throws Error if the browser cannot encode it.
 */
export async function pngOf(image: ImageBitmapSource): Promise<Blob> {
  const bitmap = await createImageBitmap(image, { premultiplyAlpha: 'none' });
  const worker = new Worker(new URL('./png-worker.ts', import.meta.url), { type: 'module' });
  try {
    const reply = await new Promise<PngReply>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<PngReply>) => resolve(data);
      worker.onerror = (event) =>
        reject(new Error(`the PNG encoder could not be started${event.message ? `: ${event.message}` : ''}`));
      worker.postMessage(bitmap, [bitmap]);
    });
    if ('message' in reply) throw new Error(reply.message);
    return reply;
  } finally {
    worker.terminate();
  }
}
