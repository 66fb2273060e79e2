import { answerBy } from './ask-worker';
import type { PackRequest } from './pack';

answerBy(async ({ bytes, size }: PackRequest) => {
  const packed = new Blob([bytes])
    .stream()
    .pipeThrough(size === undefined ? new CompressionStream('gzip') : new DecompressionStream('gzip'));
  if (size === undefined) return new Response(packed).blob();
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
  return out;
});
