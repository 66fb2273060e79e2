import type { Classification } from 'cagecast';
import type { Shown } from '../scene';
import { kZones } from '../zones';
import type { Found } from './study';

/** The segments of a target: their areas, in square units of the model, their verdicts, and their vertices by zone. */
export function partsCsv({ target, projection }: Shown, { zones, segmentStats }: Classification): string {
  const counts = segmentStats.map(() => kZones.map(() => 0));
  projection.segments.forEach((segment, vertex) => counts[segment]![zones[vertex]!]!++);
  return csvOf(
    [
      'part',
      'segment',
      'area',
      'exposed',
      'covered',
      'coverage',
      'culled',
      'culledBy',
      ...kZones.map(({ name }) => name),
    ],
    segmentStats.map(({ group, area, exposedArea, coveredArea, coverage, culled, culledBy }, segment) => [
      ...[target.mesh.primitives[group]!.name, segment, area, exposedArea, coveredArea, coverage],
      ...[Number(culled), culledBy, ...counts[segment]!],
    ]),
  );
}

/** The methods: painted vertices and, with labels, wrongly painted vertices, and shares of area: wrongly painted, and wrongly bare. */
export const methodsCsv = (found: readonly Found[]): string =>
  csvOf(
    ['method', 'painted', 'wrong', 'wrongArea', 'bareArea'],
    found.map(({ method, painted, score }) => [method, painted, score?.wrong, score?.wrongArea, score?.bareArea]),
  );

type Value = string | number | undefined;

function csvOf(head: readonly string[], rows: readonly Value[][]): string {
  return [head, ...rows].map((row) => `${row.map(cellOf).join(',')}\r\n`).join('');
}

/** Tables read a text that begins like a formula as one. */
function cellOf(value: Value): string {
  const text = typeof value === 'string' ? value.replace(/^[=+\-@\t]/, "'$&") : String(value ?? '');
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
