import type { Shown } from '../state/scene';
import { distinctColor, type Rgb } from './colors';

/** A colour for each segment; those of the largest are most distinct. */
export function segmentColors({ projection: { segmentStats } }: Shown): Rgb[] {
  const bySize = segmentStats
    .map((_, segment) => segment)
    .sort((a, b) => segmentStats[b]!.area - segmentStats[a]!.area || a - b);
  const colors: Rgb[] = [];
  bySize.forEach((segment, rank) => (colors[segment] = distinctColor(rank)));
  return colors;
}

/** Marks the triangles of segments: 1 for each of them. Undefined without segments. */
export function marksOf({ target, projection }: Shown, segments: readonly number[]): Uint8Array | undefined {
  if (segments.length === 0) return undefined;
  const chosen = new Set(segments);
  const { indices } = target.mesh;
  // All corners of a triangle belong to one segment.
  return new Uint8Array(indices.length / 3).map((_, t) => +chosen.has(projection.segments[indices[3 * t]!]!));
}
