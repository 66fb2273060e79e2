import { type Finding, percent } from './finding.js';
import { cross, dot, length, minus, pointAt, type Vector } from './geometry.js';
import type { Reverse } from './reverse.js';
import { partsOf, type Scene } from './scene.js';
import { placeOfSegment, type Segment } from './segments.js';

/** A hole is explained if the unpainted parts at it have at least this share of the area that it cuts off. */
const kMinExplained = 0.02;
/** The area that a hole cuts off is reported from this share of the exposed area on. */
const kMinCut = 5e-4;
/** A surface does not lie beneath a hole if its direction from the hole deviates from the normal by more than this sine. */
const kMaxSideways = 0.7;

/** A hole in the cage, or a border where it ends. Lengths are shares of the target's diagonal, areas of the target's exposed area. */
export interface Hole {
  /** `end`: the cage ends here, and the target lies beside the loop instead of beneath it, as at the neck of a head. */
  kind: 'hole' | 'end';
  /** Diagonal of its bounding box. */
  diagonal: number;
  perimeter: number;
  /** Area of the surface that spans it. */
  area: number;
  /** The middle of its border, in the space of the input. */
  centre: [number, number, number];
  /** Parts of the target that lie beneath it, with the share of the hole that they fill, the largest first. */
  beneath: { part: string; share: number }[];
  /** Area that the hole leaves unpainted although its segment is painted. */
  cutOff: number;
  /** The numbers of the segments with such area, the largest share first. */
  cuts: number[];
  /** Area of unpainted segments whose nearest point of the cage is on the hole's border, occluded or not. */
  excluded: number;
}

/** Points on the surfaces that span the cage's holes: two in each triangle between an edge and the middle. 3 numbers each. */
export function spanPoints({ surface, cage }: Scene): Float32Array {
  const points: number[] = [];
  for (const { edges, centre } of surface.loops) {
    for (const { a, b } of edges) {
      const [p, q] = [pointAt(cage.positions, a), pointAt(cage.positions, b)];
      for (const weight of kSpanWeights) points.push(...spanPoint(p, q, centre, weight));
    }
  }
  return Float32Array.from(points);
}
/** The weights of the edge in these points; the rest is the weight of the middle. Each stands for about half of the triangle. */
const kSpanWeights = [0.4, 0.85];

/**
 * Finds the cage's holes, largest first, and what lies beneath them.
 * @param reversed    The nearest points on the target, for the points of `spanPoints` among others.
 * @param firstPoint  The number of the first point of `spanPoints`.
 */
export function holesOf(
  { surface, cage, target, parts, areas, diagonal, sides, result, isInRegion }: Scene,
  reversed: Reverse | undefined,
  firstPoint: number,
): Hole[] {
  const { loops } = surface;
  const partOf = partsOf(parts, areas.length);
  const excluded = new Float64Array(loops.length);
  const cuts = loops.map(() => new Map<number, number>());
  let exposed = 0;
  for (let v = 0; v < areas.length; ++v) {
    if (!isInRegion(v)) continue;
    const l = sides.loops[v]!;
    if (result.zones[v] !== 1) exposed += areas[v]!;
    if (l < 0) continue;
    const segment = result.segments[v]!;
    const { culled, coveredArea } = result.segmentStats[segment]!;
    if (culled || coveredArea === 0) excluded[l]! += areas[v]!;
    else if (result.zones[v] === 2) cuts[l]!.set(segment, (cuts[l]!.get(segment) ?? 0) + areas[v]!);
  }
  let point = firstPoint;
  const holes = loops.map((loop, l): Hole => {
    const beneath = new Map<number, number>();
    let [total, sideways] = [0, 0];
    for (const { a, b } of loop.edges) {
      const [p, q] = [pointAt(cage.positions, a), pointAt(cage.positions, b)];
      const normal = cross(minus(p, loop.centre), minus(q, loop.centre));
      const area = length(normal) / 2;
      for (const weight of kSpanWeights) {
        total += area;
        if (reversed && isBeneath(reversed, point, spanPoint(p, q, loop.centre, weight), normal)) {
          const part = partOf[target.indices[3 * reversed.triangles[point]!]!]!;
          beneath.set(part, (beneath.get(part) ?? 0) + area);
        } else sideways += area;
        ++point;
      }
    }
    return {
      kind: sideways > 0.5 * total ? 'end' : 'hole',
      diagonal: loop.diagonal / diagonal,
      perimeter: loop.perimeter / diagonal,
      area: loop.area / (exposed || 1),
      centre: [...loop.centre],
      beneath: [...beneath]
        .flatMap(([part, area]) => (area > 0 ? { part: parts[part]!.name, share: area / total } : []))
        .sort((x, y) => y.share - x.share),
      cutOff: [...cuts[l]!.values()].reduce((sum, area) => sum + area, 0) / (exposed || 1),
      cuts: [...cuts[l]!].sort(([, a], [, b]) => b - a).map(([segment]) => segment),
      excluded: excluded[l]! / (exposed || 1),
    };
  });
  return holes.sort((x, y) => y.diagonal - x.diagonal);
}

const spanPoint = (p: Vector, q: Vector, centre: Vector, weight: number): Vector =>
  [0, 1, 2].map((k) => (weight * (p[k]! + q[k]!)) / 2 + (1 - weight) * centre[k]!) as unknown as Vector;

function isBeneath(reversed: Reverse, point: number, from: Vector, normal: Vector): boolean {
  const way = minus(reversed.nearest(point), from);
  const size = length(way) * length(normal);
  return size === 0 || Math.abs(dot(way, normal)) >= Math.sqrt(1 - kMaxSideways ** 2) * size;
}

/** Holes that cut off paint although no unpainted part lies behind them. */
export function checkHoles(holes: readonly Hole[], segments: readonly Segment[]): Finding[] {
  const unexplained = holes.filter(
    ({ kind, cutOff, excluded }) => kind === 'hole' && cutOff >= kMinCut && excluded < kMinExplained * cutOff,
  );
  if (unexplained.length === 0) return [];
  const cut = unexplained.reduce((sum, { cutOff }) => sum + cutOff, 0);
  const where = [...new Set(unexplained.flatMap(({ beneath }) => beneath.slice(0, 1).map(({ part }) => `"${part}"`)))]
    .slice(0, 3)
    .join(', ');
  return [
    {
      code: 'holeUnexplained',
      weight: 0.3,
      sentence: `${unexplained.length === 1 ? 'A hole of the cage has' : `${unexplained.length} holes of the cage have`} only ${where} behind ${unexplained.length === 1 ? 'it' : 'them'}, and no part that stays unpainted: ${percent(cut)} of the exposed area is left bare there`,
      advice: 'If there are eyes or similar parts, give them a mesh or material of their own. If not, close the hole.',
      numbers: { holes: unexplained.length, cutOff: cut },
      places: [...new Set(unexplained.flatMap(({ cuts }) => cuts))].map((s) => placeOfSegment(s, segments[s]!)),
    },
  ];
}
