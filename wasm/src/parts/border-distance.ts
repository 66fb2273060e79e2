import { firstInPlace } from '../inspect/geometry.js';

/**
 * For each vertex its distance from the border of the paint, along painted edges: 0 where painted and other triangles meet. The
 * edge of the mesh itself is no border. Distances are exact up to about `reach`; beyond they are at least `reach`.
 * @param positions  3 per vertex. Vertices in one place count as one.
 * @param cosmetic   1 per triangle: 1 if it is painted.
 */
export function borderDistances(
  positions: Float32Array,
  indices: ArrayLike<number>,
  cosmetic: Uint8Array,
  reach: number,
): Float32Array {
  const place = firstInPlace(positions);
  const { starts, neighbours, isBorder } = paintedEdges(place, indices, cosmetic);
  const distances = new Float32Array(place.length).fill(Infinity);
  const queue: number[] = [];
  for (let v = 0; v < place.length; ++v) {
    if (isBorder[v] !== 1) continue;
    distances[v] = 0;
    queue.push(v);
  }
  for (let next = 0; next < queue.length; ++next) {
    const from = queue[next]!;
    if (distances[from]! >= reach) continue;
    for (let n = starts[from]!; n < starts[from + 1]!; ++n) {
      const to = neighbours[n]!;
      const dx = positions[3 * to]! - positions[3 * from]!;
      const dy = positions[3 * to + 1]! - positions[3 * from + 1]!;
      const dz = positions[3 * to + 2]! - positions[3 * from + 2]!;
      const distance = Math.fround(distances[from]! + Math.sqrt(dx * dx + dy * dy + dz * dz));
      if (distance >= distances[to]!) continue;
      distances[to] = distance;
      queue.push(to);
    }
  }
  return distances.map((_, v) => Math.min(distances[place[v]!]!, 2 * reach));
}

/** The edges of painted triangles between places, and 1 for each place that has painted and other triangles. */
function paintedEdges(place: ArrayLike<number>, indices: ArrayLike<number>, cosmetic: Uint8Array) {
  const isPainted = new Uint8Array(place.length);
  const isBare = new Uint8Array(place.length);
  const starts = new Uint32Array(place.length + 1);
  for (let i = 0; i < 3 * cosmetic.length; ++i) {
    const at = place[indices[i]!]!;
    if (cosmetic[Math.floor(i / 3)] !== 1) isBare[at] = 1;
    else {
      isPainted[at] = 1;
      starts[at + 1]! += 2;
    }
  }
  for (let v = 0; v < place.length; ++v) starts[v + 1]! += starts[v]!;
  const neighbours = new Uint32Array(starts[place.length]!);
  const filled = starts.slice();
  for (let t = 0; t < cosmetic.length; ++t) {
    if (cosmetic[t] !== 1) continue;
    for (let k = 0; k < 3; ++k) {
      const at = place[indices[3 * t + k]!]!;
      for (const other of [(k + 1) % 3, (k + 2) % 3]) neighbours[filled[at]!++] = place[indices[3 * t + other]!]!;
    }
  }
  return { starts, neighbours, isBorder: isPainted.map((painted, v) => painted & isBare[v]!) };
}
