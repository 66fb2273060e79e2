import wasm from 'three/addons/libs/draco/gltf/draco_decoder.wasm?url';
import wrapper from 'three/addons/libs/draco/gltf/draco_wasm_wrapper.js?url';
import { importAmd } from './amd';

/** Starts the Draco decoder that comes with the page, for glTF-Transform. */
export async function makeDracoModule(): Promise<unknown> {
  const makeDecoder = await importAmd<(settings: { wasmBinary: ArrayBuffer }) => Promise<unknown>>(wrapper);
  return makeDecoder({ wasmBinary: await (await fetch(wasm)).arrayBuffer() });
}
