import type { LoadingManager } from 'three';
import { DRACO_GLTF_CONFIG, DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';

/** Makes a Draco decoder whose files come with the page. Dispose of it: it holds workers. */
export function makeDracoLoader(manager: LoadingManager): DRACOLoader {
  return new DRACOLoader(manager).setDecoderPath(DRACO_GLTF_CONFIG).setWorkerLimit(2);
}
