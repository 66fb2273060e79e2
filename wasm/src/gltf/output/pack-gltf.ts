import type { GLTF } from '@gltf-transform/core';

/** What a GLB or a glTF holds besides its JSON: bytes of the first buffer, and images that get files of their own. */
export interface Contents {
  json: GLTF.IGLTF;
  /** The bytes of the first buffer: a multiple of four. */
  chunks: readonly Uint8Array[];
  images: readonly { name: string; bytes: Uint8Array }[];
}

/** A file to be written beside another one. */
export interface NamedFile {
  name: string;
  data: Uint8Array;
}

const endings: Readonly<Record<string, string>> = {
  'image/png': 'png',
  'image/jpeg': 'jpg',
  'image/webp': 'webp',
  'image/ktx2': 'ktx2',
};

/** The name of an image's file, beside a glTF of the name `stem`. */
export const imageFile = (stem: string, image: number, mimeType: string | undefined): string =>
  `${stem}-image${image}.${endings[mimeType ?? ''] ?? 'bin'}`;

/** A glTF of text, and the files beside it: those of images, and `stem`.bin with all other bytes. */
export function packGltf({ json, chunks, images }: Contents, stem: string): { text: Uint8Array; beside: NamedFile[] } {
  // Only the buffer of a GLB is padded.
  const bytes = Buffer.concat(chunks).subarray(0, json.buffers?.[0]?.byteLength ?? 0);
  const beside = images.map(({ name, bytes: data }) => ({ name, data }));
  if (bytes.length > 0) {
    json.buffers![0]!.uri = encodeURIComponent(`${stem}.bin`);
    beside.push({ name: `${stem}.bin`, data: bytes });
  }
  return { text: new TextEncoder().encode(`${JSON.stringify(json, null, 1)}\n`), beside };
}

/** A GLB of a JSON chunk and a binary one. */
export function packGlb({ json, chunks }: Contents): Uint8Array {
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

/** The next multiple of four. */
export const paddedLength = (length: number): number => Math.ceil(length / 4) * 4;
