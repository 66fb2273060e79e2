/** Reads the WebAssembly file that lies beside this script. */
export async function readWasm(): Promise<Uint8Array<ArrayBuffer>> {
  // The build inserts the file name as a literal, so that bundlers find the file.
  const response = await fetch(new URL(CAGECAST_WASM, import.meta.url));
  if (!response.ok) throw new Error(`${response.url}: ${response.status} ${response.statusText}`);
  return new Uint8Array(await response.arrayBuffer());
}
