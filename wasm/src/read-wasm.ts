/** Compiles the WebAssembly file that lies beside this script, while it is loaded. */
export async function readWasm(): Promise<WebAssembly.Module> {
  // With the name put in by the build, bundlers find the file.
  const response = await fetch(new URL(CAGECAST_WASM, import.meta.url));
  if (!response.ok) throw new Error(`${response.url}: ${response.status} ${response.statusText}`);
  // A server that does not know of WebAssembly sends it as another type, which streaming refuses.
  return response.headers.get('content-type') === 'application/wasm'
    ? WebAssembly.compileStreaming(response)
    : WebAssembly.compile(await response.arrayBuffer());
}
