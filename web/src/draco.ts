import type { LoadingManager } from 'three'
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js'
import js from 'three/addons/libs/draco/gltf/draco_wasm_wrapper.js?url'
import wasm from 'three/addons/libs/draco/gltf/draco_decoder.wasm?url'

/** Makes a Draco decoder whose files come with the page. Dispose of it: it holds workers. */
export function makeDracoLoader(manager: LoadingManager): DRACOLoader {
  return new DRACOLoader(manager).setDecoderPath({ js, wasm }).setWorkerLimit(2)
}
