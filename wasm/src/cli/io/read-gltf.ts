import { dirname } from 'node:path';
import { fileKind } from '../../gltf/kinds.js';
import { type GltfFile, openGltf } from '../../gltf/open-gltf.js';
import { naming } from '../../scene/input-error.js';
import { defaultReading, type ReadOptions } from '../model/reading.js';
import { convert } from './convert.js';
import { createDracoDecoder } from './draco.js';
import { readBytes, readUri } from './files.js';

/**
 * Reads a GLB or glTF file, with external or embedded buffers, quantised, sparse, or compressed by Draco or meshopt; or a file of another
 * format, as a GLB.
 * @param bytes  Its content, if it is known already.
 * @throws {InputError} that names the file and what is wrong with it.
 */
export async function readGltf(
  path: string,
  reading: ReadOptions = defaultReading,
  bytes?: Uint8Array,
): Promise<GltfFile> {
  const content = bytes ?? (await naming(path, () => readBytes(path, reading.limits)));
  const isOther = fileKind(content)?.format !== undefined;
  const { glb, missing } = isOther
    ? await naming(path, () => convert(content, path, reading))
    : { glb: content, missing: [] };
  const file = await openGltf(path, glb, {
    limits: reading.limits,
    readBeside: (name, uri) => readUri(name, uri, dirname(path), reading),
    decoders: { draco: createDracoDecoder },
    cageUvs: reading.cageUvs,
  });
  return missing.length > 0 ? { ...file, missing } : file;
}
