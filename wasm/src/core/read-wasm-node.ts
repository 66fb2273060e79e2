import { readFile } from 'node:fs/promises';

/** Reads the WebAssembly file that lies beside this script. */
export async function readWasm(): Promise<Uint8Array<ArrayBuffer>> {
  return new Uint8Array(await readFile(new URL(CAGECAST_WASM, import.meta.url)));
}
