import type { PackReply, PackRequest } from './pack';

addEventListener('message', async ({ data: { bytes, size } }: MessageEvent<PackRequest>) => {
  try {
    const packed = new Blob([bytes])
      .stream()
      .pipeThrough(size === undefined ? new CompressionStream('gzip') : new DecompressionStream('gzip'));
    if (size === undefined) return postMessage((await new Response(packed).blob()) satisfies PackReply);
    const out = new Uint8Array(size);
    let at = 0;
    // Ends early where a small file would become a huge one.
    for (const reader = packed.getReader(); ; ) {
      const { done, value } = await reader.read();
      if (done) break;
      if (at + value.length > size) throw new Error('a painting is larger than it says');
      out.set(value, at);
      at += value.length;
    }
    if (at < size) throw new Error('a painting is incomplete');
    postMessage(out satisfies PackReply);
  } catch (error) {
    postMessage({ message: error instanceof Error ? error.message : String(error) } satisfies PackReply);
  }
});
