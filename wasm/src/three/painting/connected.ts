import { Vector3 } from 'three';

/** A triangle with its outward normal. */
interface Facet {
  points: readonly [Vector3, Vector3, Vector3];
  normal: Vector3;
}

/** A box around the middle of a sticker, in the cage's space. @internal */
export interface StickerBox {
  center: Vector3;
  /** Unit vectors to its right and its top edge. */
  right: Vector3;
  up: Vector3;
  width: number;
  height: number;
}

/** Half the depth of the box of a sticker of these sides. @internal */
export const depthOf = (width: number, height: number): number => Math.max(width, height) / 2;

/** What lies beyond each edge of some triangles: 3 for each, as a list, as more than two may meet at an edge. */
export function neighboursOf(facets: readonly Facet[]): (readonly number[])[] {
  const ids = new Map<string, number>();
  const edges = new Map<string, number[]>();
  const keys = facets.flatMap(({ points }) => {
    // Corners at the same place are one: charts of the texture have corners of their own.
    const corners = points.map(({ x, y, z }) => {
      const key = `${x} ${y} ${z}`;
      if (!ids.has(key)) ids.set(key, ids.size);
      return ids.get(key)!;
    });
    return corners.map((corner, i) => {
      const next = corners[(i + 1) % 3]!;
      return corner < next ? `${corner} ${next}` : `${next} ${corner}`;
    });
  });
  keys.forEach((key, at) => {
    const list = edges.get(key) ?? [];
    edges.set(key, list);
    list.push(Math.floor(at / 3));
  });
  return keys.map((key) => edges.get(key)!);
}

/**
 * The triangles that one gets to from one of them without leaving a box or the side that faces it: not an arm beside a chest, unless the
 * shoulder is in the box, too.
 */
export function connected(
  facets: readonly Facet[],
  neighbours: readonly (readonly number[])[],
  from: number,
  { center, right, up, width, height }: StickerBox,
): Set<number> {
  const outward = new Vector3().crossVectors(right, up);
  const axes = [right, up, outward];
  const halves = [width / 2, height / 2, depthOf(width, height)];
  const [start, way] = [new Vector3(), new Vector3()];
  /** Whether an edge comes into the box. */
  const enters = (a: Vector3, b: Vector3): boolean => {
    start.subVectors(a, center);
    way.subVectors(b, a);
    let [first, last] = [0, 1];
    for (const [i, axis] of axes.entries()) {
      const [at, by, half] = [start.dot(axis), way.dot(axis), halves[i]!];
      if (by === 0 && Math.abs(at) > half) return false;
      if (by === 0) continue;
      const [one, other] = [(-half - at) / by, (half - at) / by];
      first = Math.max(first, Math.min(one, other));
      last = Math.min(last, Math.max(one, other));
    }
    return first <= last;
  };
  const found = new Set([from]);
  for (const facet of found) {
    const { points } = facets[facet]!;
    for (let i = 0; i < 3; i++) {
      const others = neighbours[3 * facet + i]!.filter((n) => !found.has(n) && facets[n]!.normal.dot(outward) >= 0);
      if (others.length > 0 && enters(points[i]!, points[(i + 1) % 3]!)) for (const other of others) found.add(other);
    }
  }
  return found;
}

const kSeen = 0.5; // the least cosine between a sticker and what shows it well

/** The share of a box that triangles take along its width, or along its height if that is less: 0..1. */
export function roomIn(
  facets: readonly Facet[],
  found: Iterable<number>,
  { center, right, up, width, height }: StickerBox,
): number {
  const outward = new Vector3().crossVectors(right, up);
  const from = new Vector3();
  const [low, high] = [new Float64Array(2), new Float64Array(2)];
  for (const index of found) {
    const { points, normal } = facets[index]!;
    if (normal.dot(outward) < kSeen) continue;
    for (const point of points) {
      from.subVectors(point, center);
      [from.dot(right) / width, from.dot(up) / height].forEach((at, axis) => {
        low[axis] = Math.max(-0.5, Math.min(low[axis]!, at));
        high[axis] = Math.min(0.5, Math.max(high[axis]!, at));
      });
    }
  }
  return Math.min(high[0]! - low[0]!, high[1]! - low[1]!);
}
