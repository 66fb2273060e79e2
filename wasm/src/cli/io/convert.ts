import { createRequire } from 'node:module';
import { dirname, resolve } from 'node:path';
import type { toGlb } from '../../formats/to-glb.js';
import { firstLine, InputError } from '../../gltf/input-error.js';
import type { CagecastError } from '../../index.js';
import type { ReadOptions } from '../model/reading.js';
import { quoted } from '../model/text.js';
import { readBeside } from './files.js';

/**
 * Makes a GLB of a file of another format. Files beside it, such as images, are read as those of a glTF are; those that are missing are named.
 * @throws {InputError} with a message that does not name the file.
 */
export async function convert(
  bytes: Uint8Array,
  path: string,
  reading: ReadOptions,
): Promise<{ glb: Uint8Array; missing: string[] }> {
  // three.js and its loaders, which the command does not load otherwise.
  const formats = createRequire(import.meta.url)('./command-formats.cjs') as { toGlb: typeof toGlb };
  const folder = dirname(path);
  const read = (name: string) => readBeside(resolve(folder, name), folder, reading).catch(() => undefined);
  try {
    const missing: string[] = [];
    const onMissing = (name: string, reason: string) => missing.push(`${quoted(name)}: ${reason}`);
    return { glb: await formats.toGlb(bytes, { read, onMissing, limits: reading.limits }), missing };
  } catch (error) {
    throw new InputError((error as CagecastError).reason ?? firstLine(error), { cause: error });
  }
}
