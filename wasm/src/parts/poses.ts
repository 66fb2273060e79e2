import { poseTargets } from './morph-names.js';

/** A part of a model, and what moves it. */
export interface MorphedPart {
  /** All that it is called. */
  names: readonly string[];
  /** From its own space to that of the model, column by column. */
  matrix: ArrayLike<number>;
  /** In the space of the model, 3 numbers per vertex. */
  positions: Float32Array;
  targets: readonly MorphTarget[];
}

export interface MorphTarget {
  /** Its own name, if it has one, and those of the expressions that use it. */
  names: readonly unknown[];
  /** 3 numbers per vertex, in the space of the part; none if it moves none. */
  deltas(): ArrayLike<number> | null | undefined;
  /** How much of it is in the positions of the part. Default: 0. */
  shown?: number | undefined;
}

/** How a morph target moves the vertices of a part in the space of the model, 3 numbers each. */
export function movesOf({ positions, matrix: m }: MorphedPart, deltas: ArrayLike<number>): Float32Array {
  const by = new Float32Array(positions.length);
  for (let i = 0; i < by.length; i += 3)
    for (let k = 0; k < 3; ++k)
      by[i + k] = m[k]! * deltas[i]! + m[4 + k]! * deltas[i + 1]! + m[8 + k]! * deltas[i + 2]!;
  return by;
}

/**
 * Where the vertices of a model are while it blinks, opens its mouth and smiles, as `poses` of a `Mesh` has them, by the names of its
 * morph targets; `undefined` if no name says so. What is shown at rest stays.
 * @param parts  All parts of the model, in the order of their vertices.
 */
export function posesOf(parts: readonly MorphedPart[]): Float32Array | undefined {
  const all = parts.flatMap((part, p) => part.targets.map((target) => ({ part, p, target })));
  const poses = poseTargets(all.map(({ target }) => target.names));
  if (poses.length === 0) return undefined;
  const starts: number[] = [];
  let size = 0;
  for (const { positions } of parts) {
    starts.push(size);
    size += positions.length;
  }
  const out = new Float32Array(poses.length * size);
  poses.forEach((targets, n) => {
    const pose = out.subarray(n * size, (n + 1) * size);
    parts.forEach(({ positions }, p) => pose.set(positions, starts[p]!));
    for (const t of targets) {
      const { part, p, target } = all[t]!;
      const deltas = target.deltas();
      if (!deltas || deltas.length < part.positions.length) continue;
      const left = 1 - (target.shown ?? 0);
      movesOf(part, deltas).forEach((by, i) => {
        if (Number.isFinite(by)) pose[starts[p]! + i]! += left * by;
      });
    }
  });
  return out;
}
