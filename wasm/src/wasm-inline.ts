import base64 from '#wasm-base64';

/**
 * Compiles the WebAssembly module that this script carries within itself. It is the one form that works unchanged in
 * every bundler, server and worker; `cagecast/slim` has the module as a file of its own.
 */
export function compile(): Promise<WebAssembly.Module> {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  // A plain loop: `Uint8Array.from` with a function takes ten times as long.
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  return WebAssembly.compile(bytes);
}
