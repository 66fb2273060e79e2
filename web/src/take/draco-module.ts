import wasm from 'three/addons/libs/draco/gltf/draco_decoder.wasm?url'
import makeDecoder from 'three/addons/libs/draco/gltf/draco_wasm_wrapper.js'

/** Starts the Draco decoder that comes with the page, for a reader that is no loader of three's. */
export async function makeDracoModule(): Promise<unknown> {
  const wasmBinary = await (await fetch(wasm)).arrayBuffer()
  return makeDecoder({ wasmBinary })
}
