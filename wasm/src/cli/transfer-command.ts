import { basename, dirname, join } from 'node:path';
import { dracoOf, meshoptView } from '../gltf/check.js';
import { primitivePath } from '../gltf/extract.js';
import type { Form } from '../gltf/glb-writer.js';
import { InputError } from '../gltf/input-error.js';
import { diagonal, isShown, type Paint, zoneAttribute } from '../gltf/overlay.js';
import { type Added, writeTransfer } from '../gltf/write.js';
import type { CutTarget } from '../index.js';
import { vertexAreas } from '../inspect/geometry.js';
import type { Finding, Verdict } from '../inspect/index.js';
import { refuseOverwritingRead } from './beside.js';
import { inspectionReport, verdicts } from './inspect-command.js';
import { configLine, type EffectiveOptions, effectiveOptions } from './options.js';
import { writeFiles } from './output.js';
import { boundsOfTile, type UvBounds } from './paint/cage-area.js';
import { isTiled, readPaint, readTiles } from './paint/read-paint.js';
import { type Stretch, stretchOf } from './paint/stretch.js';
import { jsonText } from './print.js';
import type { Progress } from './progress.js';
import { cutTarget, type Models, type Run, readModel, run, type Sources } from './run.js';
import { integer, percent, table, takenAway } from './table.js';
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
  /** Further cages with textures: each paints only what none before it does. */
  regions?: readonly Region[] | undefined;
  /** Whether to inspect the cage as well. */
  inspects?: boolean | undefined;
}

/** A further cage, and the texture that was drawn for it. */
export interface Region {
  cage: string;
  texture: string;
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
  const { output, regions = [] } = command;
  const first = await transferRegion(command, command.texture, progress, { models, isLast: regions.length === 0 });
  const report = makeReport(command, first.done, output === undefined ? undefined : first.written, first.cut);
  if (command.inspects) {
    const { verdict, findings } = inspectionReport(command, first.done, first.textures);
    Object.assign(report, { verdict, findings });
  }
  let last = first;
  for (const [r, { cage, texture }] of regions.entries()) {
    const { uvBounds: _, referenceCage: __, ...same } = command;
    last = await transferRegion({ ...same, cage }, texture, progress, {
      models,
      isLast: r === regions.length - 1,
      before: { painted: last.painted, bytes: last.written!.data, form: finalForm(command, first.done) },
      zones: `${zoneAttribute}_${r + 1}`,
    });
    report.regions.push(regionReport({ cage, texture, output }, last));
    if (command.inspects) {
      const { verdict, findings } = inspectionReport({ ...command, cage }, last.done, last.textures);
      report.verdict = worse(report.verdict!, verdict);
      report.findings!.push(...findings.map((finding) => ({ ...finding, sentence: `${cage}: ${finding.sentence}` })));
    }
  }
  const files: { path: string; data: Uint8Array | string }[] = [];
  if (output !== undefined) {
    const { data, beside } = last.written!;
    const others = beside.map(({ name, data }) => ({ path: join(dirname(output), name), data }));
    files.push({ path: output, data }, ...others);
  }
  if (command.report !== undefined) files.push({ path: command.report, data: jsonText(report, 2) });
  refuseOverwritingRead(
    command,
    first.done,
    files.map(({ path }) => path),
  );
  writeFiles(files);
  return { text: summary(command, report), report, done: first.done };
}

/** The worse of two verdicts. */
const worse = (a: Verdict, b: Verdict): Verdict => (verdicts.indexOf(a) < verdicts.indexOf(b) ? a : b);

/** What a region's transfer is given besides its files. */
interface RegionContext {
  models: Models | undefined;
  /** Whether what it writes is the output. */
  isLast: boolean;
  /** What earlier regions made of the target: 1 per triangle that they paint, the bytes of a GLB, and the form of the output. */
  before?: { painted: Uint8Array; bytes: Uint8Array; form: Form };
  /** The name of the attribute with its zones. */
  zones?: string;
}

/** What a transfer came to. */
interface DoneRegion {
  done: Run;
  cut: CutTarget | undefined;
  /** 1 per triangle of what was written that this or an earlier region paints. */
  painted: Uint8Array;
  /** How many of them an earlier region paints. */
  before: number;
  written: Awaited<ReturnType<typeof writeTransfer>> | undefined;
  zones: string;
  /** Where the cage's UVs have textures. */
  textures: UvBounds[];
}

/** Runs the transfer of a region. Triangles that an earlier one paints are not painted again. */
async function transferRegion(
  command: TransferCommand,
  texture: string | undefined,
  progress: Progress,
  { models, isLast, before, zones = zoneAttribute }: RegionContext,
): Promise<DoneRegion> {
  const { target, output, reading, uvBounds } = command;
  const paint = texture === undefined || isTiled(texture) ? undefined : await readPaint(texture, reading.limits);
  const model = before && (await readModel(target, reading, progress, before.bytes));
  const done = await run(command, progress, models, model);
  const cage = { file: done.cageFile, extracted: done.cage };
  const tiles = texture !== undefined && isTiled(texture) ? await readTiles(texture, cage, reading.limits) : [];
  const paints = paint
    ? [{ ...paint, ...(uvBounds && { area: 'bounded' as const }) }]
    : tiles.map(({ tile, ...one }) => ({ ...one, area: { tile } }));
  const cut = output !== undefined && command.borders === 'cut' ? cutTarget(done, progress) : undefined;
  const { cosmeticTriangles } = cut ?? done.result;
  const painted = Uint8Array.from(cosmeticTriangles, (_, t) => before?.painted[cut ? cut.triangles[t]! : t] ?? 0);
  const earlier = sumOf(painted);
  const shows = showing(paints, cut ?? done.result, cut?.indices ?? done.target.mesh.indices);
  const own = cosmeticTriangles.map((isCosmetic, t) => (isCosmetic && !painted[t] && shows(t) ? 1 : 0));
  own.forEach((isPainted, t) => {
    if (isPainted) painted[t] = 1;
  });
  const textures = uvBounds ? [uvBounds] : tiles.map(({ tile }) => boundsOfTile(tile));
  const found = { done, cut, painted, before: earlier, zones, textures };
  if (output === undefined && isLast) return { ...found, written: undefined };
  progress.step(`writing ${output ?? target}`);
  const finalOne = before?.form ?? command.compress;
  const isText = isLast && output !== undefined && /\.gltf$/i.test(output);
  const written = await writeTransfer(
    done.targetFile,
    done.target,
    cut ? done.result : { ...done.result, cosmeticTriangles: own },
    {
      paints,
      cut: cut && { ...cut, cosmeticTriangles: own },
      // Draco changes the order of triangles, which says what is painted already.
      form: isLast ? finalOne : compressionOf(done) === undefined ? 'keep' : 'none',
      zones,
      isFurther: before !== undefined,
      stem: isText ? basename(output).slice(0, -'.gltf'.length) : undefined,
    },
  ).catch((error: unknown) => {
    throw error instanceof InputError ? error.in(target) : error;
  });
  return { ...found, written };
}

/** Whether a triangle shows one of some paints, if there are any. */
function showing(
  paints: readonly Paint[],
  { uvs, cornerUvs }: Pick<CutTarget, 'uvs' | 'cornerUvs'>,
  indices: Uint32Array,
): (triangle: number) => boolean {
  if (paints.every(({ area }) => area === undefined)) return () => true;
  const isOwn = cornerUvs.length > 0;
  const vertex = (corner: number): number => (isOwn ? corner : indices[corner]!);
  const all = isOwn ? cornerUvs : uvs;
  return (t) => paints.some(({ area }) => isShown(area, all, vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2)));
}

/** How the geometry of a target is compressed. */
function compressionOf({ targetFile: { json } }: Run): Form | undefined {
  if (json.meshes?.some(({ primitives }) => primitives.some(dracoOf))) return 'draco';
  return json.bufferViews?.some(meshoptView) ? 'meshopt' : undefined;
}

/** The form of an output that several regions are written to: as the target was, if it is to be kept. */
const finalForm = ({ compress }: TransferCommand, first: Run): Form =>
  compress === 'keep' ? (compressionOf(first) ?? 'keep') : compress;

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
  /** How the texture is stretched where it may be painted; `null` if nowhere. */
  stretch: Stretch | null;
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
  /** Milliseconds of CPU time. */
  timings: Run['result']['timings'];
  peakBytes: number;
}

const trianglesOf = (cosmetic: Uint8Array): Report['triangles'] => ({
  total: cosmetic.length,
  cosmetic: sumOf(cosmetic),
});

function makeReport(
  command: TransferCommand,
  { target, cage, result }: Run,
  written: { added: Added[]; replaced: number } | undefined,
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
    stretch: stretchOf(mesh, result),
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
      place: primitivePath(part),
      vertices: part.vertexCount,
      triangles: part.triangleCount,
      counts: perZone(result.zones, undefined, part.firstVertex, part.firstVertex + part.vertexCount),
      uvSet: written?.added[p]?.uvSet ?? null,
      overlayTriangles: written?.added[p]?.overlayTriangles ?? 0,
      fillsCutOuts: written?.added[p]?.fillsCutOuts ?? false,
      splitVertices: written?.added[p]?.splitVertices ?? null,
      cutTriangles: written?.added[p]?.cutTriangles ?? null,
    })),
    replacedOverlays: written?.replaced ?? 0,
    regions: [],
    timings: result.timings,
    peakBytes: result.peakBytes,
  };
}

function regionReport(
  { cage, texture, output }: Region & Pick<TransferCommand, 'output'>,
  { done, painted, before, written, zones }: DoneRegion,
): Report['regions'][number] {
  const sets = [...new Set(output === undefined ? [] : written?.added.map(({ uvSet }) => uvSet))];
  return {
    cage,
    texture,
    uvSet: sets.length > 0 ? sets.join(', ') : null,
    zones,
    counts: perZone(done.result.zones),
    triangles: { total: painted.length, cosmetic: sumOf(painted) - before },
  };
}

const sumOf = (flags: Uint8Array): number => flags.reduce((sum, one) => sum + one, 0);

function summary(
  command: TransferCommand,
  { target, counts, areas, triangles, cut, segments, parts, replacedOverlays, regions, timings, output }: Report,
): string {
  const zones = ['cosmetic', 'occluded', 'uncovered', 'culled'] as const;
  const rows = [
    ['', 'vertices', 'area'],
    ...zones.map((zone) => [zone, integer(counts[zone]), percent(areas.total > 0 ? areas[zone] / areas.total : 0)]),
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
  const lines = [
    `${command.target}: ${integer(target.vertices)} vertices, ${integer(target.triangles)} triangles, ${integer(segments.length)} segments (${integer(culled)} culled)`,
    table(rows),
    `${integer(triangles.cosmetic)} of ${integer(triangles.total)} triangles may be painted${cut ? `; cut along borders, ${integer(cut.triangles.cosmetic)} of ${integer(cut.triangles.total)}` : ''}; ${timings.total.toFixed(1)} ms`,
    output === null
      ? ''
      : `wrote ${output}: ${sets}, ${zoneAttribute}${overlay}${splits === 0 ? '' : `; ${integer(splits)} vertices split at seams of the texture`}${replacedOverlays === 0 ? '' : `; ${takenAway(replacedOverlays)}`}`,
    filled && `the overlay fills what the material cuts out of ${filled}; cagecast bake paints only the rest`,
    ...regions.map(
      ({ cage, texture, triangles: { cosmetic, total } }) =>
        `${cage}: ${integer(cosmetic)} of ${integer(total)} triangles more may be painted, by ${texture}`,
    ),
    command.report === undefined ? '' : `wrote ${command.report}`,
    configLine(command.rules.config),
    output === null && command.report === undefined
      ? 'nothing written; to save the result, add -o OUT.glb or --report R.json'
      : '',
  ];
  return lines.filter(Boolean).join('\n');
}
