import digits from '#wasm-digits';

/**
 * Compiles the WebAssembly module that this script carries within itself. It is the one form that works unchanged in
 * every bundler, server and worker; `cagecast/slim` has the module as a file of its own.
 */
export function compile(): Promise<WebAssembly.Module> {
  return WebAssembly.compile(bytesOf(digits));
}

/** Reads hexadecimal digits. Hosts of since 2025 do so by themselves, a millisecond or two sooner. */
function bytesOf(hex: string): Uint8Array<ArrayBuffer> {
  const host = Uint8Array as { fromHex?: (hex: string) => Uint8Array<ArrayBuffer> };
  if (host.fromHex) return host.fromHex(hex);
  const bytes = new Uint8Array(hex.length / 2);
  const digit = (at: number) => {
    const code = hex.charCodeAt(at);
    return code - (code < 58 ? 48 : 87);
  };
  for (let i = 0; i < bytes.length; ++i) bytes[i] = 16 * digit(2 * i) + digit(2 * i + 1);
  return bytes;
}
