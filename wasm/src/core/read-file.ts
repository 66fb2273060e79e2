import { nodeModule } from './node.js';

/** Reads a file of the package. @throws Error that names the file. */
export async function readFile(url: URL): Promise<Uint8Array<ArrayBuffer>> {
  // fetch of Node does not read files.
  const files = url.protocol === 'file:' ? nodeModule('node:fs/promises') : undefined;
  if (files) return new Uint8Array(await files.readFile(url));
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${response.url}: ${response.status} ${response.statusText}`);
  return new Uint8Array(await response.arrayBuffer());
}

/** Reads and compiles a WebAssembly file of the package. @throws Error that names the file. */
export async function compileFile(url: URL): Promise<WebAssembly.Module> {
  const bytes = await readFile(url);
  try {
    return await WebAssembly.compile(bytes);
  } catch (cause) {
    // Many servers answer with a page where there is no file.
    throw new Error(`${url.href}: ${(cause as Error).message}`, { cause });
  }
}
