import { compileFile } from './read-file.js';

/** Compiles the WebAssembly module that lies beside this script: a smaller script, and one file more to serve. */
export const compile = (): Promise<WebAssembly.Module> =>
  // The build inserts the file name as a literal, so that bundlers find the file.
  compileFile(new URL(CAGECAST_WASM, import.meta.url));
