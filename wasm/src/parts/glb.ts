/** A GLB of a JSON chunk and a binary one. @param chunks  The bytes of the latter: a multiple of four. */
export function packGlb(json: object, chunks: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const binLength = chunks.reduce((sum, { byteLength }) => sum + byteLength, 0);
  const text = new TextEncoder().encode(JSON.stringify(json));
  const textLength = paddedLength(text.byteLength);
  const total = 12 + 8 + textLength + (binLength > 0 ? 8 + binLength : 0);
  const out = new Uint8Array(total);
  const view = new DataView(out.buffer);
  const words = [0x46546c67, 2, total, textLength, 0x4e4f534a]; // "glTF", its version, "JSON"
  words.forEach((word, i) => view.setUint32(4 * i, word, true));
  out.set(text, 20);
  out.fill(0x20, 20 + text.byteLength, 20 + textLength);
  if (binLength === 0) return out;
  let at = 20 + textLength;
  view.setUint32(at, binLength, true);
  view.setUint32(at + 4, 0x004e4942, true); // "BIN\0"
  at += 8;
  for (const chunk of chunks) {
    out.set(chunk, at);
    at += chunk.byteLength;
  }
  return out;
}

/** Bytes one after the other. */
export function joinBytes(chunks: readonly Uint8Array[]): Uint8Array<ArrayBuffer> {
  const all = new Uint8Array(chunks.reduce((sum, { byteLength }) => sum + byteLength, 0));
  let at = 0;
  for (const chunk of chunks) {
    all.set(chunk, at);
    at += chunk.byteLength;
  }
  return all;
}

/** The next multiple of four. */
export const paddedLength = (length: number): number => Math.ceil(length / 4) * 4;
