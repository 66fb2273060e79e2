import type { Shown } from '../scene/session';
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

/** The triangles of segments. */
export function trianglesOf({ target, projection }: Shown, segments: readonly number[]): number[] {
  const triangles: number[] = [];
  if (segments.length === 0) return triangles;
  const chosen = new Set(segments);
  const { indices } = target.mesh;
  // All corners of a triangle belong to one segment.
  for (let t = 0; 3 * t < indices.length; t++) if (chosen.has(projection.segments[indices[3 * t]!]!)) triangles.push(t);
  return triangles;
}
