import { basename, dirname, join } from 'node:path';
import { dracoOf, meshoptView } from '../../gltf/check-geometry.js';
import type { Form } from '../../gltf/glb-writer.js';
import { withName } from '../../gltf/input-error.js';
import { isShown, type Paint, type PaintArea, zoneAttribute } from '../../gltf/overlay.js';
import { writeTransfer } from '../../gltf/write-transfer.js';
import type { CutTarget, TransferResult } from '../../index.js';
import type { Borders } from '../../parts/borders-option.js';
import { refuseOverwritingRead } from '../beside.js';
import { inspectionReport, isWorse } from '../inspect-command.js';
import { writeFiles } from '../output.js';
import { boundsOfTile, type UvBounds } from '../paint/cage-area.js';
import { isTiled, readPaint, readTiles } from '../paint/read-paint.js';
import { jsonText } from '../print.js';
import type { Progress } from '../progress.js';
import { cutTarget, type Run, readModel, runTransfer, type Sources } from '../run.js';
import { countOf, makeReport, type Report, regionReport, summary } from './report.js';

/** The arguments of `cagecast transfer`. */
export interface TransferCommand extends Sources {
  texture?: string | undefined;
  output?: string | undefined;
  report?: string | undefined;
  /** Whether the paint ends at existing triangle edges, or triangles are cut where it ends. */
  borders: Borders;
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
 * @param readCage  How cages are read.
 * @returns a summary for people, and the report.
 * @throws {InputError} that names the file at fault; then no file is written.
 */
export async function transferCommand(
  command: TransferCommand,
  progress: Progress,
  readCage?: typeof readModel,
): Promise<{ lines: string[]; report: Report }> {
  const { output, regions = [] } = command;
  const first = await transferRegion(command, command.texture, progress, { readCage, isLast: regions.length === 0 });
  const report = makeReport(command, first);
  if (command.inspects) {
    const { verdict, findings } = inspectionReport(command, first.run, first.textures);
    Object.assign(report, { verdict, findings });
  }
  let last = first;
  for (const [r, { cage, texture }] of regions.entries()) {
    const { uvBounds: _, referenceCage: __, ...same } = command;
    last = await transferRegion({ ...same, cage }, texture, progress, {
      readCage,
      isLast: r === regions.length - 1,
      before: { painted: last.painted, bytes: last.written!.data, form: finalForm(command, first.run) },
      zones: `${zoneAttribute}_${r + 1}`,
    });
    report.regions.push(regionReport({ cage, texture, output }, last));
    if (command.inspects) {
      const { verdict, findings } = inspectionReport({ ...command, cage }, last.run, last.textures);
      if (isWorse(verdict, report.verdict!)) report.verdict = verdict;
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
    first.run,
    files.map(({ path }) => path),
  );
  writeFiles(files);
  return { lines: summary(command, report), report };
}

/** What a region's transfer is given besides its files. */
interface RegionContext {
  readCage: typeof readModel | undefined;
  /** Whether what it writes is the output. */
  isLast: boolean;
  /** What earlier regions made of the target: 1 per triangle that they paint, the bytes of a GLB, and the form of the output. */
  before?: { painted: Uint8Array; bytes: Uint8Array; form: Form };
  /** The name of the attribute with its zones. */
  zones?: string;
}

/** What a transfer came to. */
export interface RegionRun {
  run: Run;
  /** 1 per triangle of the target as it was read that may be painted, and is where a texture is. */
  shown: TransferResult['cosmeticTriangles'];
  /** The cut target, and the same of its triangles. */
  cut: (CutTarget & { shown: Uint8Array }) | undefined;
  /** 1 per triangle of what was written that this or an earlier region paints. */
  painted: Uint8Array;
  /** How many of them an earlier region paints. */
  paintedBefore: number;
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
  { readCage, isLast, before, zones = zoneAttribute }: RegionContext,
): Promise<RegionRun> {
  const { target, output, reading, uvBounds } = command;
  const paint = texture === undefined || isTiled(texture) ? undefined : await readPaint(texture, reading.limits);
  const model = before && (await readModel(target, reading, progress, before.bytes));
  const run = await runTransfer(command, progress, readCage, model);
  const cage = { file: run.cageFile, extracted: run.cage };
  const tiles = texture !== undefined && isTiled(texture) ? await readTiles(texture, cage, reading.limits) : [];
  const areas: PaintArea[] = uvBounds ? ['bounded'] : tiles.map(({ tile }) => ({ tile }));
  const paints: Paint[] = (paint ? [paint] : tiles).map((one, i) => ({ ...one, area: areas[i] }));
  const cutMesh = output !== undefined && command.borders === 'cut' ? cutTarget(run, progress) : undefined;
  const shown = shownTriangles(areas, run.result, run.target.mesh.indices);
  const cut = cutMesh && { ...cutMesh, shown: shownTriangles(areas, cutMesh, cutMesh.indices) };
  const ofOutput = cut?.shown ?? shown;
  const painted = ofOutput.map((_, t) => before?.painted[cut ? cut.triangles[t]! : t] ?? 0);
  const paintedBefore = countOf(painted);
  const own = ofOutput.map((isShown, t) => (isShown && !painted[t] ? 1 : 0));
  own.forEach((isPainted, t) => {
    if (isPainted) painted[t] = 1;
  });
  const textures = uvBounds ? [uvBounds] : tiles.map(({ tile }) => boundsOfTile(tile));
  const found = { run, shown, cut, painted, paintedBefore, zones, textures };
  if (output === undefined && isLast) return { ...found, written: undefined };
  progress.step(`writing ${output ?? target}`);
  const form = before?.form ?? command.compress;
  const isText = isLast && output !== undefined && /\.gltf$/i.test(output);
  const written = await writeTransfer(
    run.targetFile,
    run.target,
    cut ? run.result : { ...run.result, cosmeticTriangles: own },
    {
      paints,
      cut: cut && { ...cut, cosmeticTriangles: own },
      // Draco changes the order of triangles, which says what is painted already.
      form: isLast ? form : compressionOf(run) === undefined ? 'keep' : 'none',
      zones,
      isFurther: before !== undefined,
      stem: isText ? basename(output).slice(0, -'.gltf'.length) : undefined,
    },
  ).catch((error: unknown) => {
    throw withName(error, target);
  });
  return { ...found, written };
}

/** 1 per triangle that may be painted, if its UVs are in one of some areas. @param areas  If none, they are everywhere. */
function shownTriangles(
  areas: readonly PaintArea[],
  { cosmeticTriangles, uvs, cornerUvs }: Pick<TransferResult, 'cosmeticTriangles' | 'uvs' | 'cornerUvs'>,
  indices: Uint32Array,
): TransferResult['cosmeticTriangles'] {
  if (areas.length === 0) return cosmeticTriangles;
  const isOwn = cornerUvs.length > 0;
  const vertex = (corner: number): number => (isOwn ? corner : indices[corner]!);
  const all = isOwn ? cornerUvs : uvs;
  const shows = (t: number) =>
    areas.some((area) => isShown(area, all, vertex(3 * t), vertex(3 * t + 1), vertex(3 * t + 2)));
  return cosmeticTriangles.map((isCosmetic, t) => (isCosmetic && shows(t) ? 1 : 0));
}

/** How the geometry of a target is compressed. */
function compressionOf({ targetFile: { json } }: Run): Form | undefined {
  if (json.meshes?.some(({ primitives }) => primitives.some(dracoOf))) return 'draco';
  return json.bufferViews?.some(meshoptView) ? 'meshopt' : undefined;
}

/** The form of an output that several regions are written to: as the target was, if it is to be kept. */
const finalForm = ({ compress }: TransferCommand, first: Run): Form =>
  compress === 'keep' ? (compressionOf(first) ?? 'keep') : compress;
