import type { Session } from '../state/session';
import { countZones } from '../state/zones';

/** The result as JSON, for tools: options, zones per vertex, and segments. */
export function zonesJson({
  shown,
  classification,
  rules: { preset, threshold, weldTolerance },
  locks,
}: Session): string {
  const { target, cage, projection } = shown!;
  const { zones, segmentStats } = classification!;
  const [cosmetic, occluded, uncovered, culled] = countZones(zones);
  return JSON.stringify({
    target: target.name,
    cage: cage.name,
    options: { preset, threshold, weldTolerance, locks },
    counts: { cosmetic, occluded, uncovered, culled },
    parts: target.mesh.primitives.map(({ name, firstVertex, vertexCount, firstTriangle, triangleCount }) => ({
      name,
      firstVertex,
      vertexCount,
      firstTriangle,
      triangleCount,
    })),
    segments: segmentStats.map((stats) => ({ part: target.mesh.primitives[stats.group]!.name, ...stats })),
    /** Per vertex: 0 cosmetic, 1 occluded, 2 uncovered, 3 culled. */
    zones: [...zones],
    /** Per vertex: its segment. */
    segmentOfVertex: [...projection.segments],
  });
}
