import text from '#wasm-text';
import { CagecastError } from './error.js';

/**
 * Compiles the WebAssembly module that is inlined in this script. Only this form works unchanged in every bundler, server and
 * worker; `cagecast/slim` has the module as a separate file.
 */
export async function compile(): Promise<WebAssembly.Module> {
  const bytes = bytesOf(text);
  // Every WebAssembly module begins with 0. Classic scripts have the encoding of their page.
  if (bytes[0] !== 0)
    throw new CagecastError(
      'unsupported',
      'init',
      'the script of Cagecast was read in another encoding than UTF-8; its page needs <meta charset="utf-8">',
    );
  return WebAssembly.compile(bytes);
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
