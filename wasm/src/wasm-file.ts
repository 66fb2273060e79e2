import { readWasm } from '#read-wasm';

/** Compiles the WebAssembly module that lies beside this script: a smaller script, and one file more to serve. */
export function compile(): Promise<WebAssembly.Module> {
  return readWasm();
}
