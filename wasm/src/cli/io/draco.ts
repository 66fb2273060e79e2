import wasmBinary from 'draco3dgltf/draco_decoder_gltf.wasm';
import createDecoderModule from 'draco3dgltf/draco_decoder_gltf_nodejs.js';

/** Starts the Draco decoder, from the copy that the build puts into this script. */
export function createDracoDecoder(): Promise<unknown> {
  return createDecoderModule({ wasmBinary });
}
