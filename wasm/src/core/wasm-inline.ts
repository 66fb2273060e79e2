import text from '#wasm-text';

/**
 * Compiles the WebAssembly module that is inlined in this script. Only this form works unchanged in every bundler, server and
 * worker; `cagecast/slim` has the module as a separate file.
 */
export function compile(): Promise<WebAssembly.Module> {
  return WebAssembly.compile(bytesOf(text));
}

/**
 * Reads a text with one character for each byte: the lowest eight bits of its code. Gzipped, it is 3 % larger than the bytes
 * themselves; hexadecimal digits are 11 % larger, base64 31 %.
 */
function bytesOf(text: string): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}
