/** In the order of their numbers. */
export const zoneNames = ['cosmetic', 'occluded', 'uncovered', 'culled'] as const;

/** A number for each zone. */
export type PerZone = Record<(typeof zoneNames)[number], number>;

/** Adds up a weight per vertex (1 by default) for each zone, over a range of vertices. */
export function perZone(zones: Uint8Array, weights?: Float64Array, first = 0, end = zones.length): PerZone {
  const sums: PerZone = { cosmetic: 0, occluded: 0, uncovered: 0, culled: 0 };
  for (let v = first; v < end; ++v) sums[zoneNames[zones[v]!]!] += weights ? weights[v]! : 1;
  return sums;
}
