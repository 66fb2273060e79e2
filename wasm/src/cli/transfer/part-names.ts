import { InputError } from '../../gltf/input-error.js';
import { type Named, partsNamed, type ReadModel } from '../../gltf/read-model.js';
import type { Lock, TransferOptions } from '../../index.js';
import { leftOutText } from '../../parts/drawn.js';
import type { Rules } from '../model/settings.js';
import { cut, kMaxCharacters, listed, quoted } from '../model/text.js';

/** How many names a message lists at most. */
const kMaxNames = 20;

/** No part has the name that a flag gives. */
export function noSuchName(flag: string, { file: { json }, extracted }: Named): InputError {
  const { parts, leftOut = [] } = extracted;
  const nodes = json.nodes ?? [];
  const parents = new Map(nodes.flatMap(({ children = [] }, n) => children.map((child) => [child, n])));
  const above = new Set<number>();
  for (const { node } of parts)
    for (let n = parents.get(node); n !== undefined && !above.has(n); n = parents.get(n)) above.add(n);
  const holding = [...above].sort((a, b) => a - b).flatMap((n) => nodes[n]!.name ?? []);
  const names = new Set([...parts.flatMap(({ aliases }) => aliases), ...holding]);
  const shown = [...names].map((name) => cut(name, kMaxCharacters));
  const others = leftOut.length > 0 ? `; left out: ${leftOutText(leftOut)}` : '';
  return new InputError(`${flag}: no node or material has this name; there are: ${listed(shown, kMaxNames)}${others}`);
}

/**
 * The options of `transfer`. Names of parts become numbers of groups, because each part is a group.
 * @param bare  The parts that are excluded if nothing is said of them.
 * @throws {InputError} that names the file, if nothing has a given name, or a part is both kept and excluded in one place.
 */
export function transferOptions(
  { preset, single, names, config }: Rules,
  model: ReadModel,
  bare: readonly number[],
): TransferOptions {
  const { parts } = model.extracted;
  const saidOf: Rules['names'][] = parts.map(() => []);
  for (const rule of names) {
    const found = partsNamed(rule.pattern, model).filter((p) => parts[p]!.vertexCount > 0);
    if (found.length === 0 && !rule.isOptional)
      throw noSuchName(`--${rule.lock} ${rule.pattern}`, model).in(model.file.path);
    for (const p of found) saidOf[p]!.push(rule);
  }
  const groups = parts.flatMap(({ name }, p): [number, Lock][] => {
    const rank = Math.max(...saidOf[p]!.map((rule) => rule.rank));
    const [first, ...others] = saidOf[p]!.filter((rule) => rule.rank === rank);
    if (first === undefined) return bare.includes(p) ? [[p, 'exclude']] : [];
    const other = others.find(({ lock }) => lock !== first.lock);
    if (other === undefined) return [[p, first.lock]];
    const place = first.isOptional ? ` (in ${config})` : '';
    const both = [first, other].map(({ lock, pattern }) => `--${lock} ${pattern}`).join(' and ');
    throw new InputError(`${both} both match ${quoted(name)}${place}`).in(model.file.path);
  });
  const those = (lock: Lock) => groups.flatMap(([p, is]) => (is === lock ? [p] : []));
  return { preset, ...single, parts: { keep: those('keep'), exclude: those('exclude') } };
}
