import type { GLTF } from '@gltf-transform/core';
import { joinBytes } from '../../parts/glb.js';

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
  const bytes = joinBytes(chunks).subarray(0, json.buffers?.[0]?.byteLength ?? 0);
  const beside = images.map(({ name, bytes: data }) => ({ name, data }));
  if (bytes.length > 0) {
    json.buffers![0]!.uri = encodeURIComponent(`${stem}.bin`);
    beside.push({ name: `${stem}.bin`, data: bytes });
  }
  return { text: new TextEncoder().encode(`${JSON.stringify(json, null, 1)}\n`), beside };
}
