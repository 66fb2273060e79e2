import wasm from 'three/addons/libs/draco/gltf/draco_decoder.wasm?url'
import wrapper from 'three/addons/libs/draco/gltf/draco_wasm_wrapper.js?url'

type MakeDecoder = (settings: { wasmBinary: ArrayBuffer }) => Promise<unknown>

/** Starts the Draco decoder that comes with the page, for a reader that is no loader of three's. Only in a worker of its own. */
export async function makeDracoModule(): Promise<unknown> {
  // As it is, so that three's loader, which wants it as text, and this share one file: what it hands itself to is AMD's `define`.
  const made = new Promise<MakeDecoder>((resolve) => {
    const define = (_: [], make: () => MakeDecoder): void => resolve(make())
    Object.assign(globalThis, { define: Object.assign(define, { amd: true }) })
  })
  const [wasmBinary] = await Promise.all([fetch(wasm).then((response) => response.arrayBuffer()), import(/* @vite-ignore */ wrapper)])
  return (await made)({ wasmBinary })
}
