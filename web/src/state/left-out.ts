import type { Projection, SegmentStats, TransferOptions } from 'cagecast';
import type { Choice, Choices, Locks, Rules } from './choices';
import type { ExtractedMesh, Model } from './model';
import type { Shown } from './scene';
import type { SplitProjection, Transferer } from './transfers';

type Stats = readonly Pick<SegmentStats, 'area' | 'group'>[];

/** The groups that choices leave out. */
export function leftOutBy(chosen: Locks, { segmentStats }: { segmentStats: Stats }): number[] {
  const groups = Object.entries(chosen).flatMap(([s, choice]) =>
    choice === 'out' ? (segmentStats[Number(s)]?.group ?? []) : [],
  );
  return [...new Set(groups)].sort((a, b) => a - b);
}

/** Choices after one more. A part is left out as a whole, and comes back as a whole. */
export function choose(chosen: Locks, segments: readonly number[], choice: Choice, stats: Stats): Locks {
  const groups = new Set(segments.map((segment) => stats[segment]?.group));
  const next = { ...chosen };
  stats.forEach(({ group, area }, s) => {
    if (!groups.has(group)) return;
    if (choice === 'out' && area > 0) next[s] = 'out';
    else if (choice !== 'out' && next[s] === 'out') delete next[s];
  });
  for (const segment of segments) next[segment] = choice;
  return next;
}

/** Choices that leave out these groups and no others. */
export function leavingOut(chosen: Locks, groups: readonly number[], stats: Stats): Locks {
  const others = Object.entries(chosen).filter(
    ([s, choice]) => choice !== 'out' || groups.includes(stats[Number(s)]?.group ?? -1),
  );
  const out = stats.flatMap(({ group }, s): [number, Choice][] => (groups.includes(group) ? [[s, 'out']] : []));
  const lacking = groups.some(
    (group) => !others.some(([s, choice]) => choice === 'out' && stats[Number(s)]?.group === group),
  );
  return Object.fromEntries(lacking ? [...others, ...out] : others);
}

/** Choices for the same vertices in other segments: each has that of the segment in which its first vertex was. */
export function moveChoices(chosen: Locks, from: ArrayLike<number>, to: Uint32Array): Locks {
  const moved: Locks = {};
  const known = new Set<number>();
  to.forEach((segment, vertex) => {
    if (known.has(segment)) return;
    known.add(segment);
    const choice = chosen[from[vertex]!];
    if (choice) moved[segment] = choice;
  });
  return moved;
}

/** The numbers of segments in a model without its left-out parts; undefined for segments of such parts. */
export function numbersWithout({
  segmentStats,
  leftOut,
}: Pick<SplitProjection, 'segmentStats' | 'leftOut'>): (number | undefined)[] {
  let next = 0;
  return segmentStats.map(({ group }) => (leftOut.includes(group) ? undefined : next++));
}

/** Choices as they are for a model without the parts that are left out. */
export function choicesWithout(
  { parts, locks, masks }: Choices,
  { groups, indices }: Pick<ExtractedMesh, 'groups' | 'indices'>,
  made: SplitProjection,
): Choices & Pick<TransferOptions, 'parts'> {
  const { leftOut } = made;
  if (leftOut.length === 0) return { parts, locks, masks };
  const segments = numbersWithout(made);
  const stays = (vertex: number): boolean => !leftOut.includes(groups[vertex]!);
  return {
    parts: { ...parts, ignore: leftOut },
    locks: Object.fromEntries(
      Object.entries(locks ?? {}).flatMap(([segment, lock]) => {
        const next = segments[Number(segment)];
        return next === undefined ? [] : [[next, lock] as const];
      }),
    ),
    masks: masks && {
      vertices: masks.vertices?.filter((_, vertex) => stays(vertex)),
      triangles: masks.triangles?.filter((_, triangle) => stays(indices[3 * triangle]!)),
    },
  };
}

/** The names of the parts that are left out. */
export const namesLeftOut = ({ target, projection }: Pick<Shown, 'target' | 'projection'>): string[] =>
  projection.leftOut.map((group) => target.mesh.primitives[group]!.name);

/**
 * A model as it is transferred: each segment of a part that is left out is at one of its vertices, so that it has no area and hides
 * nothing, and all segments, vertices and triangles keep their numbers.
 * @param made A projection of it, which says what is left out.
 */
export function withoutParts<Of extends Model>(model: Of, made: Pick<SplitProjection, 'leftOut' | 'segments'>): Of {
  const { leftOut, segments } = made;
  if (leftOut.length === 0) return model;
  const { groups } = model.mesh;
  const positions = model.mesh.positions.slice();
  const isOut = (vertex: number): boolean => leftOut.includes(groups[vertex]!);
  const middle = middleOf(positions, (vertex) => !isOut(vertex));
  const distance = (vertex: number): number =>
    Math.hypot(...middle.map((value, axis) => positions[3 * vertex + axis]! - value));
  // The innermost vertex, so that the model's box is that of the rest, or nearly so.
  const places = new Map<number, { vertex: number; far: number }>();
  segments.forEach((segment, vertex) => {
    if (!isOut(vertex)) return;
    const far = distance(vertex);
    if (far < (places.get(segment)?.far ?? Infinity)) places.set(segment, { vertex, far });
  });
  segments.forEach((segment, vertex) => {
    const place = places.get(segment);
    if (place) positions.set(model.mesh.positions.subarray(3 * place.vertex, 3 * place.vertex + 3), 3 * vertex);
  });
  return { ...model, mesh: { ...model.mesh, positions } };
}

/** The middle of the box of some vertices; of none, the origin. */
function middleOf(positions: Float32Array, counts: (vertex: number) => boolean): number[] {
  const [low, high] = [Array(3).fill(Infinity), Array(3).fill(-Infinity)];
  positions.forEach((value, i) => {
    if (!counts(Math.floor(i / 3))) return;
    low[i % 3] = Math.min(low[i % 3], value);
    high[i % 3] = Math.max(high[i % 3], value);
  });
  return low.map((value, axis) => (value <= high[axis] ? (value + high[axis]) / 2 : 0));
}

/** What a transfer depends on besides its models. */
type TransferRules = Pick<Rules, 'preset' | 'weldTolerance'>;

/** Whether a projection is what rules and choices lead to. */
export const isUpToDate = (made: SplitProjection, { preset, weldTolerance }: TransferRules, chosen: Locks): boolean =>
  made.preset === preset &&
  made.weldTolerance === weldTolerance &&
  String(made.leftOut) === String(leftOutBy(chosen, made));

/**
 * Transfers to a model. If parts are left out, this takes a second transfer: the first finds the segments that choices are for.
 * @param choicesFor Gives the choices for the segments of a projection.
 */
export async function projectBy(
  transferer: Transferer,
  { cage, target }: { cage: Model; target: Model },
  { preset, weldTolerance }: TransferRules,
  choicesFor: (projection: Projection) => Locks,
  onProjected?: () => void,
): Promise<SplitProjection> {
  const options = { preset, weldTolerance };
  const whole = await transferer.ask('project', cage, target, options, onProjected);
  const leftOut = leftOutBy(choicesFor(whole), whole);
  const projection =
    leftOut.length === 0
      ? whole
      : await transferer.ask(
          'project',
          cage,
          withoutParts(target, { leftOut, segments: whole.segments }),
          options,
          onProjected,
        );
  return { ...projection, weldTolerance, leftOut };
}
