import { type Extracted, type Part, primitivePath } from '../../gltf/extract-file.js';
import { zoneAttribute } from '../../gltf/overlay.js';
import type { Added } from '../../gltf/write-transfer.js';
import type { SegmentStats, TransferResult } from '../../index.js';
import { counted } from '../../inspect/finding.js';
import { boxOf, vertexAreas } from '../../inspect/geometry.js';
import type { Finding, Verdict } from '../../inspect/index.js';
import { type CageReport, cageReport, excludedLine } from '../cage-report.js';
import { configLine, type EffectiveOptions, effectiveOptions } from '../options.js';
import { type Stretch, stretchOf } from '../paint/stretch.js';
import type { Run } from '../run.js';
import { integer, percent, table, takenAway } from '../table.js';
import { type PerZone, perZone, zoneNames } from '../zones.js';
import type { Region, RegionRun, TransferCommand } from './command.js';

/** The JSON report of a transfer. Areas are in squared units of the target; lengths in its units. */
export interface Report {
  versions: { cagecast: string; node: string };
  target: { file: string; vertices: number; triangles: number; diagonal: number };
  cage: CageReport;
  texture: string | null;
  output: string | null;
  borders: TransferCommand['borders'];
  options: EffectiveOptions;
  /** Vertices of the target in each zone. The zones are the cage's, whatever part of it the texture covers. */
  counts: PerZone;
  /** Area of the target in each zone: a third of each triangle for each of its corners. */
  areas: PerZone & { total: number };
  triangles: Triangles;
  /** How the texture is stretched where it may be painted; `null` if nowhere. */
  stretch: Stretch | null;
  /**
   * The target after borders were cut and before vertices are split; `null` if borders were not cut. All other fields describe the
   * target as it was read.
   */
  cut: { vertices: number; counts: PerZone; triangles: Triangles } | null;
  /** Every connected component of the target, in the order of their first vertices. */
  segments: (Omit<SegmentStats, 'group' | 'twinOf' | 'score'> & {
    part: string;
    vertices: number;
    /** `null` if no area is required. */
    score: number | null;
  })[];
  /**
   * Every primitive of every node, in scene order. `uvSet` is the added attribute, `splitVertices` the number of vertices that were
   * added because corners at the same vertex have different UVs, and `cutTriangles` the number of triangles that were added by
   * cutting borders; these three are `null` if no output was written. `fillsCutOuts` says whether the overlay paints over what the
   * material cuts out by its alpha.
   */
  parts: {
    name: string;
    place: string;
    vertices: number;
    triangles: number;
    counts: PerZone;
    uvSet: string | null;
    overlayTriangles: number;
    fillsCutOuts: boolean;
    splitVertices: number | null;
    cutTriangles: number | null;
  }[];
  /** Overlays of an earlier transfer to the target, which are not in the output. */
  replacedOverlays: number;
  /** Further cages with textures. All other fields are about the first cage. `triangles.cosmetic` are those that no cage before paints. */
  regions: {
    cage: string;
    texture: string;
    /** The attributes that were added: UVs and zones; `null` if no output was written. */
    uvSet: string | null;
    zones: string;
    counts: PerZone;
    triangles: { total: number; cosmetic: number };
  }[];
  /** Whether all of the cages fit, and why not; if they were inspected. */
  verdict?: Verdict;
  findings?: Finding[];
  /** Milliseconds of wall time. */
  timings: Run['result']['timings'];
  peakBytes: number;
}

/** Triangles of a target. */
interface Triangles {
  total: number;
  /** Those that may be painted, and whose UVs are where a texture is. */
  cosmetic: number;
  /** With bounds of UVs: those that might be painted, but are outside of them. */
  outOfBounds?: number;
}

/** How many of some flags are 1. */
export const countOf = (flags: Uint8Array): number => flags.reduce((sum, one) => sum + one, 0);

/** @param shown  1 per triangle that is within the bounds of UVs as well, if there are any. */
const trianglesOf = (cosmetic: Uint8Array, shown: Uint8Array, isBounded: boolean): Triangles => ({
  total: cosmetic.length,
  cosmetic: countOf(shown),
  ...(isBounded && { outOfBounds: countOf(cosmetic) - countOf(shown) }),
});

/** The report of a transfer from the first cage. */
export function makeReport(command: TransferCommand, { run, shown, cut, ...rest }: RegionRun): Report {
  const { target, result } = run;
  const { mesh, parts } = target;
  const written = command.output === undefined ? undefined : rest.written;
  const isBounded = command.uvBounds !== undefined;
  const areas = vertexAreas(mesh);
  return {
    versions: { cagecast: CAGECAST_VERSION, node: process.versions.node },
    target: {
      file: command.target,
      vertices: mesh.positions.length / 3,
      triangles: mesh.indices.length / 3,
      diagonal: boxOf(mesh.positions).diagonal,
    },
    cage: cageReport(command.cage, run.cage, run),
    texture: command.texture ?? null,
    output: command.output ?? null,
    borders: command.borders,
    options: effectiveOptions(command),
    counts: perZone(result.zones),
    areas: { total: areas.reduce((sum, area) => sum + area, 0), ...perZone(result.zones, areas) },
    triangles: trianglesOf(result.cosmeticTriangles, shown, isBounded),
    stretch: stretchOf(mesh, { ...result, cosmeticTriangles: shown }),
    cut: cut
      ? {
          vertices: cut.zones.length,
          counts: perZone(cut.zones),
          triangles: trianglesOf(cut.cosmeticTriangles, cut.shown, isBounded),
        }
      : null,
    segments: segmentsOf(target, result),
    parts: parts.map((part, p) => partReport(part, result, written?.added[p])),
    replacedOverlays: written?.replaced ?? 0,
    regions: [],
    timings: result.timings,
    peakBytes: result.peakBytes,
  };
}

function segmentsOf({ parts }: Extracted, { segments, segmentStats }: TransferResult): Report['segments'] {
  const vertices = new Uint32Array(segmentStats.length);
  const names: string[] = []; // of the part of each segment's first vertex
  for (const { name, firstVertex, vertexCount } of parts)
    for (let v = firstVertex; v < firstVertex + vertexCount; ++v) {
      const s = segments[v]!;
      names[s] ??= name;
      ++vertices[s]!;
    }
  return segmentStats.map(
    ({ points, area, exposedArea, coveredArea, coverage, depthWeightedArea, score, culled, culledBy }, s) => ({
      part: names[s]!,
      vertices: vertices[s]!,
      points,
      area,
      exposedArea,
      coveredArea,
      coverage,
      depthWeightedArea,
      score: Number.isFinite(score) ? score : null, // no area is required
      culled,
      culledBy,
    }),
  );
}

function partReport(part: Part, { zones }: TransferResult, added: Added | undefined): Report['parts'][number] {
  const { name, firstVertex, vertexCount, triangleCount } = part;
  return {
    name,
    place: primitivePath(part),
    vertices: vertexCount,
    triangles: triangleCount,
    counts: perZone(zones, undefined, firstVertex, firstVertex + vertexCount),
    uvSet: added?.uvSet ?? null,
    overlayTriangles: added?.overlayTriangles ?? 0,
    fillsCutOuts: added?.fillsCutOuts ?? false,
    splitVertices: added?.splitVertices ?? null,
    cutTriangles: added?.cutTriangles ?? null,
  };
}

/** The report of a further cage. */
export function regionReport(
  { cage, texture, output }: Region & Pick<TransferCommand, 'output'>,
  { run, painted, paintedBefore, written, zones }: RegionRun,
): Report['regions'][number] {
  const sets = [...new Set(output === undefined ? [] : written?.added.map(({ uvSet }) => uvSet))];
  return {
    cage,
    texture,
    uvSet: sets.length > 0 ? sets.join(', ') : null,
    zones,
    counts: perZone(run.result.zones),
    triangles: { total: painted.length, cosmetic: countOf(painted) - paintedBefore },
  };
}

/** The report for people. */
export function summary(
  command: TransferCommand,
  { target, cage, counts, areas, triangles, cut, segments, parts, replacedOverlays, regions, timings, output }: Report,
): string[] {
  const rows = [
    ['', 'vertices', 'area'],
    ...zoneNames.map((zone) => [zone, integer(counts[zone]), percent(areas.total > 0 ? areas[zone] / areas.total : 0)]),
  ];
  const sets = [...new Set(parts.map((part) => part.uvSet))].join(', ');
  const splits = parts.reduce((sum, { splitVertices }) => sum + (splitVertices ?? 0), 0);
  const culled = segments.filter((segment) => segment.culled).length;
  const filled = [...new Set(parts.filter(({ fillsCutOuts }) => fillsCutOuts).map(({ name }) => `“${name}”`))].join(
    ', ',
  );
  const hasOverlay = parts.some(({ overlayTriangles }) => overlayTriangles > 0);
  const overlay =
    command.texture === undefined
      ? ''
      : hasOverlay
        ? ', and an overlay with the texture'
        : '; no overlay, as the texture shows nowhere';
  const { outOfBounds = 0 } = cut?.triangles ?? triangles;
  const lines = [
    `${command.target}: ${integer(target.vertices)} vertices, ${integer(target.triangles)} triangles, ${counted(segments.length, 'segment')} (${integer(culled)} culled)`,
    ...table(rows),
    `${integer(triangles.cosmetic)} of ${integer(triangles.total)} triangles may be painted${cut ? `; cut along borders, ${integer(cut.triangles.cosmetic)} of ${integer(cut.triangles.total)}` : ''}; ${timings.total.toFixed(1)} ms`,
    outOfBounds > 0
      ? `${integer(outOfBounds)} more could be painted, but lie outside of --uv-bounds; zones do not depend on the bounds`
      : '',
    output === null
      ? ''
      : `wrote ${output}: ${sets}, ${zoneAttribute}${overlay}${splits === 0 ? '' : `; ${counted(splits, 'vertex', 'vertices')} split at seams of the texture`}${replacedOverlays === 0 ? '' : `; ${takenAway(replacedOverlays)}`}`,
    filled && `the overlay fills what the material cuts out of ${filled}; cagecast bake paints only the rest`,
    ...regions.map(
      ({ cage, texture, triangles: { cosmetic, total } }) =>
        `${cage}: ${integer(cosmetic)} of ${integer(total)} triangles more may be painted, by ${texture}`,
    ),
    command.report === undefined ? '' : `wrote ${command.report}`,
    excludedLine(cage),
    configLine(command.rules.config),
    output === null && command.report === undefined
      ? 'nothing written; to save the result, add -o OUT.glb or --report R.json'
      : '',
  ];
  return lines.filter(Boolean);
}
