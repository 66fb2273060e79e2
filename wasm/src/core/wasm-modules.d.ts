// Modules and constants that the build provides: see wasm/tools/build.mjs.

/** The glue that Emscripten makes of bindings.cpp. */
declare module '#glue' {
  export default function createModule(module: object): PromiseLike<unknown>;
}

/** The glue that Emscripten makes of cages_bindings.cpp. */
declare module '#cages-glue' {
  export default function createModule(module: object): PromiseLike<unknown>;
}

/** The WebAssembly module, one character (0 to 255) for each byte. */
declare module '#wasm-text' {
  const text: string;
  export default text;
}

/** Google's Draco decoder; its package has types for its main module only. */
declare module 'draco3dgltf/draco_decoder_gltf_nodejs.js' {
  export default function createDecoderModule(module: object): Promise<unknown>;
}

declare module 'draco3dgltf/draco_decoder_gltf.wasm' {
  const bytes: Uint8Array<ArrayBuffer>;
  export default bytes;
}

/** Google's Draco encoder. */
declare module 'draco3dgltf/draco_encoder_gltf_nodejs.js' {
  export default function createEncoderModule(module: object): Promise<unknown>;
}

declare module 'draco3dgltf/draco_encoder.wasm' {
  const bytes: Uint8Array<ArrayBuffer>;
  export default bytes;
}

/** The package's version, from package.json. */
declare const CAGECAST_VERSION: string;

/** Where a script that reads WebAssembly finds it, relative to itself. */
declare const CAGECAST_WASM: string;
