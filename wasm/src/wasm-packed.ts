import packed from '#wasm-packed';

/**
 * Compiles the WebAssembly module that this script carries within itself, as wasm-inline.ts does. What is loaded later, when it is
 * asked for, is rather smaller than ready a few milliseconds sooner.
 */
export function compile(): Promise<WebAssembly.Module> {
  return WebAssembly.compile(unpack(packed));
}

/** Bytes as printable text; `packText` in wasm/tools/build.mjs says how and why. */
interface PackedText {
  length: number;
  /** All 256 bytes in hexadecimal, the most frequent first. A byte goes by its place in here. */
  order: string;
  text: string;
}

const symbols = 91;
const short = 89;

function unpack({ length, order, text }: PackedText): Uint8Array<ArrayBuffer> {
  const byteAt = Uint8Array.from({ length: 256 }, (_, place) => parseInt(order.slice(2 * place, 2 * place + 2), 16));
  const bytes = new Uint8Array(length);
  let at = 0;
  const symbol = () => {
    const code = text.charCodeAt(at++);
    return code - (code > 92 ? 36 : 35);
  };
  for (let i = 0; i < length; ++i) {
    let place = symbol();
    if (place >= short) place = short + (place - short) * symbols + symbol();
    bytes[i] = byteAt[place]!;
  }
  return bytes;
}
