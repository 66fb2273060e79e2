import { counted } from '../inspect/finding.js';
import { boxOf, vertexAreas } from '../inspect/geometry.js';
import { type Inspection, inspect, unfitFrom, usableFrom, type Verdict } from '../inspect/index.js';
import { type CageReport, cageReport, excludedLine } from './cage-report.js';
import { inspectionPage } from './inspect-page.js';
import { adviceOn, configLine, type EffectiveOptions, effectiveOptions } from './options.js';
import { writeFiles } from './output.js';
import { boundsAround, type UvBounds, withinBounds } from './paint/cage-area.js';
import type { Progress } from './progress.js';
import { type Run, runTransfer, type Sources } from './run.js';
import { cut, integer, percent, segmentCells, segmentColumns, short, table } from './table.js';
import { type PerZone, perZone, zoneNames } from './zones.js';

/** The arguments of `cagecast inspect`. */
interface InspectCommand extends Sources {
  html?: string | undefined;
}

export const verdicts: readonly Verdict[] = ['unfit', 'usable', 'good'];

/** Whether one verdict is worse than another. */
export const isWorse = (a: Verdict, b: Verdict): boolean => verdicts.indexOf(a) < verdicts.indexOf(b);

/** The JSON output of `inspect`: the inspection, and its inputs. */
export interface InspectionReport extends Inspection {
  versions: { cagecast: string; node: string };
  target: { file: string; vertices: number; triangles: number; points: number; diagonal: number };
  cage: CageReport;
  options: EffectiveOptions;
  /** Vertices of the target in each zone. */
  counts: PerZone;
  /** Share of the target's area in each zone. */
  coverage: PerZone;
}

/**
 * Checks whether a cage fits a target.
 * @returns what is printed, and the verdict.
 * @throws {InputError} that names the file at fault.
 */
export async function inspectCommand(
  command: InspectCommand,
  progress: Progress,
): Promise<{ lines: string[]; report: InspectionReport; verdict: Verdict }> {
  const run = await runTransfer(command, progress);
  progress.step('inspecting');
  const report = inspectionReport(command, run, command.uvBounds ? [command.uvBounds] : []);
  if (command.html !== undefined) {
    progress.step(`writing ${command.html}`);
    writeFiles([{ path: command.html, data: inspectionPage(report, run) }]);
  }
  return {
    lines: describe(report, command.html),
    report,
    verdict: report.verdict,
  };
}

/** Inspects the cage of a run. @param textures  Where its UVs have textures, besides 0..1. */
export function inspectionReport(
  command: Omit<Sources, 'reading'>,
  run: Run,
  textures: readonly UvBounds[],
): InspectionReport {
  const { target, wholeCage, options, result } = run;
  const cage = withinBounds(wholeCage, textures.length > 0 ? boundsAround(textures) : undefined).extracted;
  const { mesh, parts } = target;
  const areas = perZone(result.zones, vertexAreas(mesh));
  const total = areas.cosmetic + areas.occluded + areas.uncovered + areas.culled || 1;
  return {
    ...inspect(cage.mesh, mesh, { ...options, result, parts }),
    versions: { cagecast: CAGECAST_VERSION, node: process.versions.node },
    target: {
      file: command.target,
      vertices: mesh.positions.length / 3,
      triangles: mesh.indices.length / 3,
      points: result.segmentStats.reduce((sum, { points }) => sum + points, 0),
      diagonal: boxOf(mesh.positions).diagonal,
    },
    cage: cageReport(command.cage, cage, run),
    options: effectiveOptions(command),
    counts: perZone(result.zones),
    coverage: {
      cosmetic: areas.cosmetic / total,
      occluded: areas.occluded / total,
      uncovered: areas.uncovered / total,
      culled: areas.culled / total,
    },
  };
}

/** How many rows a table has at most. */
const kMaxRows = 15;
const conclusions: Record<Verdict, string> = {
  good: 'GOOD: the cage fits.',
  usable: 'USABLE: the cage fits, with reservations.',
  unfit: 'UNFIT: the cage does not fit.',
};

/** The verdict and the findings, for people. */
export function conclusionOf({ verdict, findings }: Inspection): string[] {
  return [
    conclusions[verdict],
    ...findings.flatMap((finding) => [
      `${finding.weight >= unfitFrom ? '✗' : finding.weight >= usableFrom ? '!' : '·'} ${finding.sentence}.`,
      `  → ${adviceOn(finding)}`,
    ]),
  ];
}

function segmentTable(listed: (InspectionReport['segments'][number] & { s: number })[]): string[] {
  return table([
    ['part', 'segment', ...segmentColumns],
    ...listed.map((segment) => [cut(segment.part, 40), String(segment.s), ...segmentCells(segment)]),
  ]);
}

function describe(report: InspectionReport, html: string | undefined): string[] {
  const { target, cage, counts, coverage, placement, inside, inward, topology, uv, holes, segments } = report;
  const { outside, distances } = placement;
  const listed = segments
    .map((segment, s) => ({ ...segment, s }))
    .sort((a, b) => b.exposedArea - a.exposedArea || a.s - b.s)
    .slice(0, kMaxRows);
  const more = (n: number) => (n > kMaxRows ? `, the ${kMaxRows} largest` : '');
  return [
    `target  ${target.file}: ${integer(target.vertices)} vertices (${integer(target.points)} points), ${integer(target.triangles)} triangles, diagonal ${short(target.diagonal)}`,
    `cage    ${cage.file}: ${integer(cage.vertices)} vertices, ${integer(cage.triangles)} triangles`,
    '',
    'zones',
    ...table([
      ['', 'vertices', 'area'],
      ...zoneNames.map((zone) => [zone, integer(counts[zone]), percent(coverage[zone])]),
    ]),
    '',
    'fit (lengths as shares of the diagonal)',
    `  outside the cage: ${percent(outside.vertices)} of the vertices, ${percent(outside.area)} of the area; ${percent(outside.exposedArea)} of the exposed area by more than 0.25 %`,
    `  distance to the cage: median ${percent(distances.p50)}, 90 % within ${percent(distances.p90)}, 99 % within ${percent(distances.p99)}, most ${percent(distances.max)}`,
    `  cage vertices inside the target: ${integer(inside.vertices)} (${percent(inside.area)} by area)`,
    '',
    'cage',
    `  facing inward: ${counted(inward.triangles.length, 'triangle')}; without area: ${integer(topology.degenerateTriangles)}; doubled: ${integer(topology.doubledTriangles)}; edges of more than two triangles: ${integer(topology.nonManifoldEdges)}; cracks: ${integer(topology.crackEdges + topology.slits)}; pieces: ${integer(topology.pieces)}`,
    `  UVs: ${counted(uv.charts, 'chart')}, ${counted(uv.seams.edges, 'seam edge')}, ${percent(uv.used)} of the texture in use, ${percent(uv.overlap.share)} of that twice; ${counted(uv.outside.vertices, 'vertex', 'vertices')} outside 0..1; ${counted(uv.withoutArea.triangles, 'triangle')} without area`,
    '',
    `holes: ${integer(holes.length)}${more(holes.length)}`,
    ...(holes.length === 0
      ? []
      : table([
          ['beneath', 'kind', 'size', 'perimeter', 'cut off'],
          ...holes.slice(0, kMaxRows).map(({ beneath, kind, diagonal: size, perimeter, cutOff }) => [
            cut(
              beneath
                .slice(0, 3)
                .map(({ part, share }) => `${part} ${Math.round(100 * share)} %`)
                .join(', ') || 'nothing',
              60,
            ),
            kind,
            percent(size),
            percent(perimeter),
            percent(cutOff),
          ]),
        ])),
    '',
    `segments: ${integer(segments.length)}${more(segments.length)}`,
    ...segmentTable(listed),
    '',
    ...conclusionOf(report),
    ...[html === undefined ? '' : `wrote ${html}`, excludedLine(cage), configLine(report.options.config)].filter(
      Boolean,
    ),
  ];
}
