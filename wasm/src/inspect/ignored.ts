import type { TransferResult } from '../api/index.js';
import type { Mesh } from '../api/mesh.js';

/** A target without the parts that its transfer ignored, and the result for the rest. */
export function withoutIgnored(target: Mesh, result: TransferResult): { target: Mesh; result: TransferResult } {
  const { segments, segmentStats } = result;
  const isIgnored = segmentStats.map(({ culledBy }) => culledBy === 'ignore');
  if (!isIgnored.includes(true)) return { target, result };
  const isThere = (v: number) => !isIgnored[segments[v]!];
  const places = new Uint32Array(segments.length);
  let count = 0;
  for (let v = 0; v < places.length; ++v) places[v] = isThere(v) ? count++ : 0;
  /** Those of the vertices that are there, of arrays with some numbers for each; of poses, of each of them. */
  const rest = <T extends Float32Array | Uint32Array | Uint8Array>(array: T, size = 1) =>
    array.filter((_, i) => isThere(Math.floor(i / size) % segments.length)) as T;
  const { positions, indices, groups, poses, names } = target;
  const isCounted = (t: number) => [0, 1, 2].every((k) => isThere(indices[3 * t + k]!));
  return {
    target: {
      positions: rest(positions, 3),
      indices: Uint32Array.from(
        Array.from(indices).filter((_, i) => isCounted(Math.floor(i / 3))),
        (v) => places[v]!,
      ),
      groups: groups && rest(groups),
      poses: poses && rest(poses, 3),
      names,
    },
    result: {
      ...result,
      zones: rest(result.zones),
      segments: rest(segments),
      triangles: rest(result.triangles),
      distances: rest(result.distances),
      cosmeticTriangles: result.cosmeticTriangles.filter((_, t) => isCounted(t)),
    },
  };
}
