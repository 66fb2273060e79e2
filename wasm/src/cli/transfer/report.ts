import type { SegmentStats, TransferResult } from '../../api/index.js';
import type { Added } from '../../gltf/write-transfer.js';
import { vertexAreas } from '../../inspect/geometry.js';
import type { Finding, Segment, Verdict } from '../../inspect/index.js';
import { hasArea, segmentsOf } from '../../inspect/segments.js';
import type { Borders } from '../../parts/cut-part.js';
import { type Part, primitivePath } from '../../scene/extract.js';
import type { Region, TransferCommand } from '../model/sources.js';
import type { PerZone } from '../model/zones.js';
import { countOf, type RegionRun } from './region.js';
import {
  bareNote,
  type CageReport,
  cageReport,
  effectiveOptions,
  perZone,
  type TargetReport,
  targetReport,
  versions,
} from './report-parts.js';
import { type Stretch, stretchOf } from './stretch.js';

/** The JSON report of a transfer. Areas are in squared units of the target; lengths in its units. */
export interface Report {
  versions: ReturnType<typeof versions>;
  target: TargetReport;
  cage: CageReport;
  texture: string | null;
  output: string | null;
  borders: Borders;
  options: ReturnType<typeof effectiveOptions>;
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
  /** Every connected component of the target that has an area, in the order of their first vertices. */
  segments: (Segment & Pick<SegmentStats, 'depth'> & { vertices: number })[];
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
    /** Whether the cage faced the other way, and was turned by half. */
    isTurned?: boolean;
    /** As `otherUvSets` of a `Mesh`. */
    otherUvSets?: readonly number[];
  }[];
  /** Why next to nothing may be painted, if so, and what helps. */
  note?: string;
  /** Whether all of the cages fit, and why not; if they were inspected. */
  verdict?: Verdict;
  findings?: Finding[];
  /** Milliseconds of wall time. */
  timings: TransferResult['timings'];
  peakBytes: number;
}

/** Triangles of a target. */
interface Triangles {
  total: number;
  /** Triangles that may be painted, with UVs inside the texture. */
  cosmetic: number;
  /** With bounds of UVs: those that might be painted, but are outside of them. */
  outOfBounds?: number;
}

/** @param shown  1 per triangle that is within the bounds of UVs as well, if there are any. */
const trianglesOf = (cosmetic: Uint8Array, shown: Uint8Array, isBounded: boolean): Triangles => ({
  total: cosmetic.length,
  cosmetic: countOf(shown),
  ...(isBounded && { outOfBounds: countOf(cosmetic) - countOf(shown) }),
});

/** The report of a transfer from the first cage. */
export function makeReport(command: TransferCommand, { run, shown, cut, ...rest }: RegionRun): Report {
  const { target, result } = run;
  const { mesh, parts } = target.extracted;
  const written = command.output === undefined ? undefined : rest.written;
  const isBounded = command.uvBounds !== undefined;
  const areas = vertexAreas(mesh);
  const note = bareNote(run);
  return {
    versions: versions(),
    target: targetReport(command.target, run),
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
    segments: segmentReports(parts, result),
    parts: parts.map((part, p) => partReport(part, result, written?.added[p])),
    replacedOverlays: written?.replaced ?? 0,
    ...(note && { note }),
    regions: [],
    timings: result.timings,
    peakBytes: result.peakBytes,
  };
}

function segmentReports(parts: readonly Part[], result: TransferResult): Report['segments'] {
  const vertices = new Uint32Array(result.segmentStats.length);
  for (const s of result.segments) ++vertices[s]!;
  return segmentsOf({ parts, result })
    .filter(hasArea)
    .map((segment) => ({
      ...segment,
      vertices: vertices[segment.segment]!,
      depth: result.segmentStats[segment.segment]!.depth,
    }));
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
  const { otherUvSets } = run.cage.extracted.mesh;
  const sets = [...new Set(output === undefined ? [] : written?.added.map(({ uvSet }) => uvSet))];
  return {
    cage,
    texture,
    uvSet: sets.length > 0 ? sets.join(', ') : null,
    zones,
    counts: perZone(run.result.zones),
    triangles: { total: painted.length, cosmetic: countOf(painted) - paintedBefore },
    ...(run.isTurned && { isTurned: true }),
    ...(otherUvSets && { otherUvSets }),
  };
}
