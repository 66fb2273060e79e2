import { readFile } from 'node:fs/promises';

/** Compiles cagecast.wasm, which lies beside this script. */
export async function readWasm(): Promise<WebAssembly.Module> {
  return WebAssembly.compile(await readFile(new URL('./cagecast.wasm', import.meta.url)));
}
