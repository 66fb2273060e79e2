// What the build puts in by these names: see wasm/tools/build.mjs.

/** The glue that Emscripten makes of bindings.cpp; in cagecast/borders of bindings_borders.cpp. */
declare module '#glue' {
  export default function createModule(module: object): PromiseLike<unknown>;
}

/** The WebAssembly module in hexadecimal digits, without capitals. */
declare module '#wasm-digits' {
  const digits: string;
  export default digits;
}

/** Where products and sums that belong together are in it, each as bytes from the one before: see wasm/tools/fused.mjs. */
declare module '#fused' {
  const sites: readonly number[];
  export default sites;
}

/** The module as text of printable symbols. */
declare module '#wasm-packed' {
  const packed: { length: number; order: string; text: string };
  export default packed;
}

/** Google's Draco decoder; its package has types for its main module only. */
declare module 'draco3dgltf/draco_decoder_gltf_nodejs.js' {
  export default function createDecoderModule(module: { wasmBinary: Uint8Array }): Promise<unknown>;
}

declare module 'draco3dgltf/draco_decoder_gltf.wasm' {
  const bytes: Uint8Array;
  export default bytes;
}

/** The package's version, from package.json. */
declare const CAGECAST_VERSION: string;

/** Where a script that reads WebAssembly finds it, relative to itself. */
declare const CAGECAST_WASM: string;
