import decoderBinary from 'draco3dgltf/draco_decoder_gltf.wasm';
import createDecoderModule from 'draco3dgltf/draco_decoder_gltf_nodejs.js';
import encoderBinary from 'draco3dgltf/draco_encoder.wasm';
import createEncoderModule from 'draco3dgltf/draco_encoder_gltf_nodejs.js';
import { CagecastError } from '../../api/index.js';
import { notStarted } from '../../core/error.js';

/** Starts the Draco decoder, from the copy that the build puts into this script. @throws {CagecastError} `unsupported` */
export const createDracoDecoder = (): Promise<unknown> => start(createDecoderModule, decoderBinary);

/** Starts the encoder. @throws {CagecastError} `unsupported` */
export const createDracoEncoder = (): Promise<unknown> => start(createEncoderModule, encoderBinary);

function start(create: typeof createDecoderModule, binary: Uint8Array<ArrayBuffer>): Promise<unknown> {
  return new Promise((resolve, reject) => {
    // The glue prints what it cannot start, and ends with a text of its own.
    const failed = (cause: unknown) =>
      reject(new CagecastError('unsupported', '', notStarted('the WebAssembly of Draco', cause), { cause }));
    const instantiateWasm = (imports: WebAssembly.Imports, receive: (made: WebAssembly.Instance) => void): object => {
      WebAssembly.instantiate(binary, imports).then(({ instance }) => receive(instance), failed);
      return {};
    };
    create({ instantiateWasm }).then(resolve, failed);
  });
}
