declare module 'three/addons/libs/draco/gltf/draco_wasm_wrapper.js' {
  /** Starts the decoder. */
  export default function makeDecoder(settings: { wasmBinary: ArrayBuffer }): Promise<unknown>
}
