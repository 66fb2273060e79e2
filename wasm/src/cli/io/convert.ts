import { dirname, resolve } from 'node:path';
import { CagecastError } from '../../api/index.js';
import { toGlb } from '../../gltf/formats/to-glb.js';
import { InputError } from '../../scene/input-error.js';
import type { ReadOptions } from '../model/reading.js';
import { quoted } from '../model/text.js';
import { readBeside } from './files.js';

/**
 * Makes a GLB of a file of another format. Files beside it, such as images, are read as those of a glTF; missing ones are named.
 * @throws {InputError} with a message that does not name the file.
 */
export async function convert(
  bytes: Uint8Array,
  path: string,
  reading: ReadOptions,
): Promise<{ glb: Uint8Array; missing: string[] }> {
  const folder = dirname(path);
  const read = (name: string) => readBeside(resolve(folder, name), folder, reading).catch(() => undefined);
  try {
    const missing: string[] = [];
    const onMissing = (name: string, reason: string) => missing.push(`${quoted(name)}: ${reason}`);
    return { glb: await toGlb(bytes, { read, onMissing, limits: reading.limits }), missing };
  } catch (error) {
    if (!(error instanceof CagecastError)) throw error;
    throw new InputError(error.reason, { cause: error });
  }
}
