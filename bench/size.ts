import { readFile } from 'node:fs/promises';
import { gzipSync } from 'node:zlib';
import { root } from './native.js';

/** What a page has to load, in bytes. */
export interface Size {
  raw: number;
  gz: number;
}

/** The files whose size counts. */
export const sizedFiles = {
  'cagecast.wasm': 'dist/cagecast.wasm',
  'cagecast (WebAssembly inlined)': 'dist/index.js',
  'cagecast-cages.wasm': 'dist/cagecast-cages.wasm',
} as const;

export async function measureSizes(): Promise<Record<string, Size>> {
  const sizes: Record<string, Size> = {};
  for (const [name, path] of Object.entries(sizedFiles)) {
    const bytes = await readFile(root + path);
    sizes[name] = { raw: bytes.length, gz: gzipSync(bytes, { level: 9 }).length };
  }
  return sizes;
}
