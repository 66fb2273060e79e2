import type { ReadModel } from '../../gltf/read-model.js';
import { partsNamed } from '../../gltf/read-model.js';
import type { WhichCount } from '../../scene/extract.js';
import type { Io } from '../io/io.js';
import type { ReadOptions } from '../model/reading.js';
import type { Rules } from '../model/settings.js';
import { readModel } from './models.js';
import { mustMatch, noSuchName } from './part-names.js';

/**
 * Reads a target: its drawn and its kept parts, without ignored ones.
 * @throws {InputError} that names the file; if a pattern matches nothing, or all is left out, too.
 */
export function readTarget(
  path: string,
  reading: ReadOptions,
  io: Io,
  rules: Pick<Rules, 'ignored' | 'names'>,
  bytes?: Uint8Array,
): Promise<ReadModel> {
  return readModel(path, reading, io, { bytes, whichCount: allBut(rules) });
}

/** What is drawn or kept, without the parts that are ignored; see `readTarget`. */
export function allBut({ ignored, names }: Pick<Rules, 'ignored' | 'names'>): Exclude<WhichCount, 'cage'> {
  return (parts, source) => {
    const out = new Set<number>();
    const all = { file: source, extracted: { parts: [...parts] } };
    const kept = new Set(names.flatMap(({ lock, pattern }) => (lock === 'keep' ? partsNamed(pattern, all) : [])));
    for (const rule of ignored) {
      const found = partsNamed(rule.pattern, all);
      if (found.length === 0 && mustMatch(rule)) throw noSuchName(`--ignore ${rule.pattern}`, all);
      for (const p of found) out.add(p);
    }
    return (p, isDrawn) => (isDrawn || kept.has(p)) && !out.has(p);
  };
}
