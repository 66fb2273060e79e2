import type { Extracted } from '../gltf/extract.js';
import { InputError } from '../gltf/input-error.js';
import { type Lock, type Preset, type PresetOptions, presetOptions, type TransferOptions } from '../index.js';

/** What the command line says about how to transfer. */
export interface Rules {
  preset: Preset;
  /** Options of `transfer` that were given. */
  single: Partial<PresetOptions>;
  /** Names of nodes or materials, `*` for any text, whose parts are painted whatever their areas. */
  keep: string[];
  /** The same for parts that are never painted. */
  exclude: string[];
}

/** All options that a transfer was made with, for a report. `occlusionReach` is `null` where it has no end. */
export interface EffectiveOptions extends Omit<PresetOptions, 'occlusionReach'> {
  preset: Preset;
  occlusionReach: number | null;
  keep: string[];
  exclude: string[];
}

/** The options in full; needs `init`. */
export function effectiveOptions({ preset, single, keep, exclude }: Rules): EffectiveOptions {
  const all = { ...presetOptions(preset), ...single };
  return {
    preset,
    ...all,
    occlusionReach: Number.isFinite(all.occlusionReach) ? all.occlusionReach : null,
    keep,
    exclude,
  };
}

/**
 * The options of `transfer`, with the names as locks: a part is a group.
 * @throws {InputError} for a name that nothing has, or a part that is to be both kept and excluded.
 */
export function transferOptions({ preset, single, keep, exclude }: Rules, { parts }: Extracted): TransferOptions {
  const groups: Record<number, Lock> = {};
  const saidBy = new Map<number, string>();
  for (const [lock, patterns] of [
    ['keep', keep],
    ['exclude', exclude],
  ] as const) {
    for (const pattern of patterns) {
      const matches = matcher(pattern);
      const found = [...parts.keys()].filter((p) => parts[p]!.vertexCount > 0 && parts[p]!.aliases.some(matches));
      if (found.length === 0) {
        const names = [...new Set(parts.flatMap(({ aliases }) => aliases))];
        throw new InputError(
          `--${lock} ${pattern}: no node or material is called that; there are: ${names.slice(0, mostNames).join(', ')}${names.length > mostNames ? `, and ${names.length - mostNames} more` : ''}`,
        );
      }
      for (const p of found) {
        if (groups[p] !== undefined && groups[p] !== lock)
          throw new InputError(
            `--${groups[p]} ${saidBy.get(p)} and --${lock} ${pattern} both mean "${parts[p]!.name}"`,
          );
        groups[p] = lock;
        saidBy.set(p, pattern);
      }
    }
  }
  return { preset, ...single, locks: { groups } };
}

/** The most names that a message lists. */
const mostNames = 20;

/** Whether a name is one, or, with `*` for any text, one of many. */
function matcher(pattern: string): (name: string) => boolean {
  const expression = new RegExp(
    `^${pattern
      .split('*')
      .map((text) => text.replace(/[.+?^${}()|[\]\\]/g, '\\$&'))
      .join('[^]*')}$`,
  );
  return (name) => expression.test(name);
}
