import type { Landmarks, Position, Template } from './types.js';

/**
 * The named holes of a cage that was moved: each name stays with its loop of open edges.
 * @param before     The cage before, with the holes that have names.
 * @param positions  3 per vertex after.
 * @returns the middle of each, the mean of its vertices.
 */
export function movedHoles({ positions: old, indices, holes }: Partial<Template>, positions: Float32Array): Landmarks {
  if (!old || !indices || !holes || old.length !== positions.length) return {};
  const loops = openLoops(old, indices);
  if (loops.length === 0) return {};
  const places = loops.map((loop) => middleOf(old, loop));
  return Object.fromEntries(
    Object.entries(holes).map(([name, at]) => {
      const distances = places.map((place) => Math.hypot(place[0] - at[0], place[1] - at[1], place[2] - at[2]));
      return [name, middleOf(positions, loops[distances.indexOf(Math.min(...distances))]!)];
    }),
  );
}

function middleOf(positions: Float32Array, vertices: readonly number[]): Position {
  const sum = [0, 0, 0];
  for (const v of vertices) for (let k = 0; k < 3; ++k) sum[k]! += positions[3 * v + k]! / vertices.length;
  return sum as unknown as Position;
}

/** The vertices of each connected set of open edges; vertices in the same place are one. */
function openLoops(positions: Float32Array, indices: Template['indices']): number[][] {
  const first = new Map<string, number>();
  const place = Array.from({ length: positions.length / 3 }, (_, v) => {
    const key = positions.subarray(3 * v, 3 * v + 3).join();
    if (!first.has(key)) first.set(key, v);
    return first.get(key)!;
  });
  const uses = new Map<string, [number, number, number]>();
  for (let i = 0; i < indices.length; ++i) {
    const [a, b] = [place[indices[i]!]!, place[indices[i % 3 === 2 ? i - 2 : i + 1]!]!].sort((x, y) => x - y);
    const edge = uses.get(`${a} ${b}`) ?? [a!, b!, 0];
    ++edge[2];
    uses.set(`${a} ${b}`, edge);
  }
  const neighbours = new Map<number, number[]>();
  for (const [a, b, count] of uses.values()) {
    if (count !== 1) continue;
    neighbours.set(a, [...(neighbours.get(a) ?? []), b]);
    neighbours.set(b, [...(neighbours.get(b) ?? []), a]);
  }
  const loops: number[][] = [];
  const seen = new Set<number>();
  for (const start of neighbours.keys()) {
    if (seen.has(start)) continue;
    const loop: number[] = [];
    seen.add(start);
    for (const stack = [start]; stack.length > 0; ) {
      const v = stack.pop()!;
      loop.push(v);
      for (const next of neighbours.get(v)!) {
        if (seen.has(next)) continue;
        seen.add(next);
        stack.push(next);
      }
    }
    loops.push(loop);
  }
  return loops;
}
