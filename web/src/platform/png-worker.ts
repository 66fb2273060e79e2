import { encodePng } from './encode-png';
import type { PngReply } from './png';

addEventListener('message', async ({ data }: MessageEvent<ImageBitmap>) => {
  try {
    postMessage((await encodePng(data)) satisfies PngReply);
  } catch (error) {
    postMessage({ message: error instanceof Error ? error.message : String(error) } satisfies PngReply);
  }
});
