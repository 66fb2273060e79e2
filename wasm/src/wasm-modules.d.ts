// What the build puts in by these names: see wasm/tools/build.mjs.

/** The glue that Emscripten makes of bindings.cpp. */
declare module '#glue' {
  export default function createModule(module: object): PromiseLike<unknown>;
}

/** The WebAssembly module as base64 text. */
declare module '#wasm-base64' {
  const base64: string;
  export default base64;
}
