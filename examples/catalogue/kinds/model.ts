import { type Document, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { CagecastError } from 'cagecast';
import { checkGltf } from 'cagecast/gltf';
import draco3d from 'draco3dgltf';
import { MeshoptDecoder, MeshoptEncoder } from 'meshoptimizer';
import { Failure } from '../failure.ts';

let io: Promise<NodeIO> | undefined;

/** Reads and writes GLB and VRM files, compressed ones too. Nothing beside a file is read. */
export function models(): Promise<NodeIO> {
  io ??= (async () =>
    new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
      'draco3d.decoder': await draco3d.createDecoderModule(),
      'draco3d.encoder': await draco3d.createEncoderModule(),
      'meshopt.decoder': MeshoptDecoder,
      'meshopt.encoder': MeshoptEncoder,
    }))();
  return io;
}

/** A model, after its limits were checked: a kilobyte can demand all memory. @throws {Failure} that names the input. */
export async function readModel(name: string, bytes: Uint8Array): Promise<Document> {
  try {
    checkGltf(bytes);
    return await (await models()).readBinary(bytes);
  } catch (error) {
    throw inputFailure(error, name);
  }
}

/** What an error of Cagecast or glTF-Transform means for a job. */
export function inputFailure(error: unknown, name?: string): Failure {
  if (error instanceof Failure) return error;
  const text = `${name === undefined ? '' : `${name}: `}${(error as Error).message}`;
  const exceeds =
    /the limit "|Array buffer allocation failed/.test(text) ||
    (error instanceof CagecastError && error.code === 'outOfMemory');
  return new Failure(exceeds ? 'limit' : 'broken', text);
}
