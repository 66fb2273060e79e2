import { show } from '../core/error.js';
import { InputError } from '../gltf/input-error.js';
import { type Named, partsNamed, type ReadModel } from '../gltf/read-model.js';
import type { Lock, Locks } from '../index.js';
import { withBare } from '../parts/drawn.js';
import type { PartPatterns } from './part-patterns.js';

/** How many names a message lists at most. */
const kMaxNames = 20;

/** Locks by the names of parts. @param bare  The parts that stay bare if nothing is said of them. @throws {InputError} */
export function locksOf(model: ReadModel, bare: readonly number[], patterns: PartPatterns): Locks | undefined {
  const groups: Record<number, Lock> = {};
  for (const lock of ['exclude', 'keep'] as const)
    for (const pattern of patterns[lock] ?? [])
      for (const p of partsOf(model, lock, pattern)) {
        if (groups[p] !== undefined && groups[p] !== lock)
          throw new InputError(
            `${lock}: ${show(pattern)} and a pattern of exclude match ${show(model.extracted.parts[p]!.name)}`,
          );
        groups[p] = lock;
      }
  return withBare(bare, Object.keys(groups).length > 0 ? { groups } : undefined);
}

/** The numbers of the parts that a pattern names. @param option  Where it stands. @throws {InputError} if it names none. */
export function partsOf(model: Named, option: string, pattern: string): number[] {
  const found = typeof pattern === 'string' ? partsNamed(pattern, model) : [];
  if (found.length > 0) return found;
  const names = [...new Set(model.extracted.parts.flatMap(({ aliases }) => aliases))];
  const more = names.length > kMaxNames ? ` and ${names.length - kMaxNames} more` : '';
  throw new InputError(
    `${option}: nothing is named ${show(pattern)}; there are ${names.slice(0, kMaxNames).join(', ')}${more}`,
  );
}
