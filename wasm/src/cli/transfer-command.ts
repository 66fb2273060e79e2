import { basename } from 'node:path';
import { placeOf } from '../gltf/extract.js';
import { readBytes } from '../gltf/files.js';
import type { Form } from '../gltf/glb-writer.js';
import { InputError } from '../gltf/input-error.js';
import type { ReadLimits } from '../gltf/limits.js';
import { diagonal, type Paint, paintOf, zoneAttribute } from '../gltf/overlay.js';
import { type Added, writeTransfer } from '../gltf/write.js';
import { type CutTarget, cutBorders } from '../index.js';
import { vertexAreas } from '../inspect/geometry.js';
import { configLine, type EffectiveOptions, effectiveOptions } from './options.js';
import { writeFiles } from './output.js';
import type { Progress } from './progress.js';
import { inFile, type Models, type Run, run, type Sources } from './run.js';
import { integer, percent, table } from './table.js';
import { type PerZone, perZone } from './zones.js';

/** The arguments of `cagecast transfer`. */
export interface TransferCommand extends Sources {
  texture?: string | undefined;
  output?: string | undefined;
  report?: string | undefined;
  /** Whether the paint ends at existing triangle edges, or triangles are cut where it ends. */
  borders: 'triangle' | 'cut';
  /** How the geometry of the output is compressed. */
  compress: Form;
}

/**
 * Runs the transfer and writes the requested files.
 * @param models  How the cage is read.
 * @returns a summary for people, the report, and what it is about.
 * @throws {InputError} that names the file at fault; then no file is written.
 */
export async function transferCommand(
  command: TransferCommand,
  progress: Progress,
  models?: Models,
): Promise<{ text: string; report: Report; done: Run }> {
  const paint = command.texture === undefined ? undefined : await readPaint(command.texture, command.reading.limits);
  const done = await run(command, progress, models);
  let added: Added[] | undefined;
  let cut: CutTarget | undefined;
  const files: { path: string; data: Uint8Array | string }[] = [];
  if (command.output !== undefined) {
    if (command.borders === 'cut') cut = cutTarget(done, progress);
    progress.step(`writing ${command.output}`);
    const written = await writeTransfer(done.targetFile, done.target, done.result, {
      paint,
      cut,
      form: command.compress,
    }).catch((error: unknown) => {
      throw error instanceof InputError ? error.in(command.target) : error;
    });
    added = written.added;
    files.push({ path: command.output, data: written.glb });
  }
  const report = makeReport(command, done, added, cut);
  if (command.report !== undefined) files.push({ path: command.report, data: `${JSON.stringify(report, null, 2)}\n` });
  writeFiles(files);
  return { text: summary(command, report), report, done };
}

/** Cuts the target. @throws {InputError} that names the file and the element at fault. */
function cutTarget(done: Run, progress: Progress): CutTarget {
  progress.step('cutting borders');
  try {
    return cutBorders(done.cage.mesh, done.target.mesh, done.result, done.options);
  } catch (error) {
    throw inFile(error, done);
  }
}

async function readPaint(path: string, limits: ReadLimits): Promise<Paint> {
  try {
    return paintOf(await readBytes(path, limits), basename(path), ['image/png', 'image/jpeg', 'image/webp']);
  } catch (error) {
    throw error instanceof InputError ? error.in(path) : error;
  }
}

/** The JSON report of a transfer. Areas are in squared units of the target; lengths in its units. */
export interface Report {
  versions: { cagecast: string; node: string };
  target: { file: string; vertices: number; triangles: number; diagonal: number };
  cage: { file: string; vertices: number; triangles: number };
  texture: string | null;
  output: string | null;
  borders: TransferCommand['borders'];
  options: EffectiveOptions;
  /** Vertices of the target in each zone. */
  counts: PerZone;
  /** Area of the target in each zone: a third of each triangle for each of its corners. */
  areas: PerZone & { total: number };
  triangles: { total: number; cosmetic: number };
  /**
   * The target after borders were cut and before vertices are split; `null` if borders were not cut. All other fields describe the
   * target as it was read.
   */
  cut: { vertices: number; counts: PerZone; triangles: { total: number; cosmetic: number } } | null;
  /** Every connected component of the target, in the order of their first vertices. */
  segments: {
    part: string;
    vertices: number;
    points: number;
    area: number;
    exposedArea: number;
    coveredArea: number;
    coverage: number;
    depthWeightedArea: number;
    /** `null` if no area is required. */
    score: number | null;
    culled: boolean;
    culledBy: Run['result']['segmentStats'][number]['culledBy'];
  }[];
  /**
   * Every primitive of every node, in scene order. `uvSet` is the added attribute, `splitVertices` the number of vertices that were
   * added because corners at the same vertex have different UVs, and `cutTriangles` the number of triangles that were added by
   * cutting borders; these three are `null` if no output was written.
   */
  parts: {
    name: string;
    place: string;
    vertices: number;
    triangles: number;
    counts: PerZone;
    uvSet: string | null;
    overlayTriangles: number;
    splitVertices: number | null;
    cutTriangles: number | null;
  }[];
  /** Milliseconds of CPU time. */
  timings: Run['result']['timings'];
  peakBytes: number;
}

const trianglesOf = (cosmetic: Uint8Array): Report['triangles'] => ({
  total: cosmetic.length,
  cosmetic: cosmetic.reduce((sum, one) => sum + one, 0),
});

function makeReport(
  command: TransferCommand,
  { target, cage, result }: Run,
  added: Added[] | undefined,
  cut: CutTarget | undefined,
): Report {
  const { mesh, parts } = target;
  const areas = vertexAreas(mesh);
  const partOfVertex = new Uint32Array(mesh.positions.length / 3);
  parts.forEach((part, p) => partOfVertex.fill(p, part.firstVertex, part.firstVertex + part.vertexCount));
  const segmentVertices = new Uint32Array(result.segmentStats.length);
  const segmentPart = new Uint32Array(result.segmentStats.length);
  for (let v = partOfVertex.length - 1; v >= 0; --v) {
    ++segmentVertices[result.segments[v]!]!;
    segmentPart[result.segments[v]!] = partOfVertex[v]!;
  }
  return {
    versions: { cagecast: CAGECAST_VERSION, node: process.versions.node },
    target: {
      file: command.target,
      vertices: mesh.positions.length / 3,
      triangles: mesh.indices.length / 3,
      diagonal: diagonal(mesh.positions),
    },
    cage: { file: command.cage, vertices: cage.mesh.positions.length / 3, triangles: cage.mesh.indices.length / 3 },
    texture: command.texture ?? null,
    output: command.output ?? null,
    borders: command.borders,
    options: effectiveOptions(command.rules),
    counts: perZone(result.zones),
    areas: { total: areas.reduce((sum, area) => sum + area, 0), ...perZone(result.zones, areas) },
    triangles: trianglesOf(result.cosmeticTriangles),
    cut: cut
      ? { vertices: cut.zones.length, counts: perZone(cut.zones), triangles: trianglesOf(cut.cosmeticTriangles) }
      : null,
    segments: result.segmentStats.map(
      ({ points, area, exposedArea, coveredArea, coverage, depthWeightedArea, score, culled, culledBy }, s) => ({
        part: parts[segmentPart[s]!]!.name,
        vertices: segmentVertices[s]!,
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
    ),
    parts: parts.map((part, p) => ({
      name: part.name,
      place: placeOf(part),
      vertices: part.vertexCount,
      triangles: part.triangleCount,
      counts: perZone(result.zones, undefined, part.firstVertex, part.firstVertex + part.vertexCount),
      uvSet: added?.[p]?.uvSet ?? null,
      overlayTriangles: added?.[p]?.overlayTriangles ?? 0,
      splitVertices: added?.[p]?.splitVertices ?? null,
      cutTriangles: added?.[p]?.cutTriangles ?? null,
    })),
    timings: result.timings,
    peakBytes: result.peakBytes,
  };
}

function summary(
  command: TransferCommand,
  { target, counts, areas, triangles, cut, segments, parts, timings, output }: Report,
): string {
  const zones = ['cosmetic', 'occluded', 'uncovered', 'culled'] as const;
  const rows = [
    ['', 'vertices', 'area'],
    ...zones.map((zone) => [zone, integer(counts[zone]), percent(areas.total > 0 ? areas[zone] / areas.total : 0)]),
  ];
  const sets = [...new Set(parts.map((part) => part.uvSet))].join(', ');
  const splits = parts.reduce((sum, { splitVertices }) => sum + (splitVertices ?? 0), 0);
  const culled = segments.filter((segment) => segment.culled).length;
  const lines = [
    `${command.target}: ${integer(target.vertices)} vertices, ${integer(target.triangles)} triangles, ${integer(segments.length)} segments (${integer(culled)} culled)`,
    table(rows),
    `${integer(triangles.cosmetic)} of ${integer(triangles.total)} triangles may be painted${cut ? `; cut along borders, ${integer(cut.triangles.cosmetic)} of ${integer(cut.triangles.total)}` : ''}; ${timings.total.toFixed(1)} ms`,
    output === null
      ? ''
      : `wrote ${output}: ${sets}, ${zoneAttribute}${command.texture === undefined ? '' : ', and an overlay with the texture'}${splits === 0 ? '' : `; ${integer(splits)} vertices split at seams of the texture`}`,
    command.report === undefined ? '' : `wrote ${command.report}`,
    configLine(command.rules.config),
    output === null && command.report === undefined
      ? 'nothing written; to save the result, add -o OUT.glb or --report R.json'
      : '',
  ];
  return lines.filter(Boolean).join('\n');
}
