import { CagecastError, notStarted } from '../core/error.js';
import type { MeshoptDecoder } from './decoders.js';

// Imported only when they are needed, as their scripts start WebAssembly as soon as they run.

/** The decoder of meshopt, started. @throws {CagecastError} `unsupported` if the host cannot run it. */
export const meshoptDecoder = async (): Promise<MeshoptDecoder> =>
  started((await import('meshoptimizer/decoder')).MeshoptDecoder as MeshoptDecoder);

/** Its encoder. @throws {CagecastError} `unsupported` if the host cannot run it. */
export const meshoptEncoder = async () => started((await import('meshoptimizer/encoder')).MeshoptEncoder);

/** A codec, once it is ready. @throws {CagecastError} `unsupported` */
export async function started<Codec extends { supported: boolean; ready: Promise<void> }>(
  codec: Codec,
): Promise<Codec> {
  try {
    if (!codec.supported) throw new Error('there is no WebAssembly');
    await codec.ready;
    return codec;
  } catch (cause) {
    throw new CagecastError('unsupported', '', notStarted('the WebAssembly of meshopt', cause), { cause });
  }
}
