import type { Classification } from 'cagecast';

/** The zones, by their number: their names, and their colours for CSS. After Okabe and Ito, so that they are colour-blind safe. */
export const kZones = [
  { name: 'cosmetic', color: 'light-dark(#8fa0ad, #8593a3)' },
  { name: 'occluded', color: '#0072b2' },
  { name: 'uncovered', color: '#e69f00' },
  { name: 'culled', color: '#cc79a7' },
] as const;

/** The number of vertices in each zone. */
export function countZones(zones: Classification['zones']): number[] {
  const counts = kZones.map(() => 0);
  for (const zone of zones) counts[zone]!++;
  return counts;
}
