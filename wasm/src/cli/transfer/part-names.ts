import type { Lock, TransferOptions } from '../../api/index.js';
import { type Named, partsNamed, type ReadModel } from '../../gltf/read-model.js';
import { leftOutText } from '../../parts/drawn.js';
import { InputError } from '../../scene/input-error.js';
import type { Rules } from '../model/settings.js';
import { cut, kMaxCharacters, listed } from '../model/text.js';

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
  return new InputError(`${flag}: nothing has this name; there are: ${listed(shown, kMaxNames)}${others}`);
}

/** Whether a pattern has to name a part: not of a configuration file, which speaks of many models, nor one for any text. */
export const mustMatch = ({ pattern, isOptional }: Rules['ignored'][number]): boolean =>
  !isOptional && !pattern.includes('*');

/**
 * The options of `transfer`. Names of parts become numbers of groups, because each part is a group.
 * @param bare  The parts that are excluded if nothing is said of them.
 * @throws {InputError} that names the file, if nothing has a given name.
 */
export function transferOptions(
  { preset, single, names }: Rules,
  model: ReadModel,
  bare: readonly number[],
): TransferOptions {
  const { parts } = model.extracted;
  const said = new Map<number, Rules['names'][number]>();
  for (const rule of names) {
    const found = partsNamed(rule.pattern, model).filter((p) => parts[p]!.vertexCount > 0);
    if (found.length === 0 && mustMatch(rule))
      throw noSuchName(`--${rule.lock} ${rule.pattern}`, model).in(model.file.path);
    // What is said later counts; of what is said together, keep.
    for (const p of found) if (!said.has(p) || rule.rank > said.get(p)!.rank) said.set(p, rule);
  }
  const those = (lock: Lock, byDefault: readonly number[] = []) =>
    [...parts.keys()].filter((p) => said.get(p)?.lock === lock || (!said.has(p) && byDefault.includes(p)));
  return { preset, ...single, parts: { keep: those('keep'), exclude: those('exclude', bare) } };
}
