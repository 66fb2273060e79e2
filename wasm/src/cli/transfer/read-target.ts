import type { WhichCount } from '../../gltf/extract-file.js';
import type { ReadModel } from '../../gltf/read-model.js';
import { partsNamed } from '../../gltf/read-model.js';
import type { Io } from '../io/io.js';
import type { ReadOptions } from '../model/reading.js';
import type { Rules } from '../model/settings.js';
import { readModel } from './models.js';
import { noSuchName } from './part-names.js';

/**
 * Reads a target: what is drawn of it, without the parts that are ignored.
 * @param ignored  Patterns of names. An empty one stands for itself: then also what is not drawn counts.
 * @throws {InputError} that names the file; if a pattern matches nothing, or all is left out, too.
 */
export function readTarget(
  path: string,
  reading: ReadOptions,
  io: Io,
  ignored: Rules['ignored'],
  bytes?: Uint8Array,
): Promise<ReadModel> {
  return readModel(path, reading, io, { bytes, whichCount: allBut(ignored) });
}

/** What is drawn, without the parts that are ignored; see `readTarget`. */
export function allBut(ignored: Rules['ignored']): Exclude<WhichCount, 'cage'> {
  const patterns = ignored.filter(({ pattern }) => pattern !== '');
  return (parts, file) => {
    const out = new Set<number>();
    for (const { pattern, isOptional } of patterns) {
      const found = partsNamed(pattern, { file, extracted: { parts: [...parts] } });
      if (found.length === 0 && !isOptional)
        throw noSuchName(`--ignore ${pattern}`, { file, extracted: { parts: [...parts] } });
      for (const p of found) out.add(p);
    }
    return (p, isDrawn) => (isDrawn || patterns.length < ignored.length) && !out.has(p);
  };
}
