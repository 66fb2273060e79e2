import { readFile } from 'node:fs/promises';

/** Compiles the WebAssembly file that lies beside this script. */
export async function readWasm(): Promise<WebAssembly.Module> {
  return WebAssembly.compile(await readFile(new URL(CAGECAST_WASM, import.meta.url)));
}
