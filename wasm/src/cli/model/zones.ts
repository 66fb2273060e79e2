/** In the order of their numbers. */
export const kZoneNames = ['cosmetic', 'occluded', 'uncovered', 'culled'] as const;

/** A number for each zone. */
export type PerZone = Record<(typeof kZoneNames)[number], number>;
