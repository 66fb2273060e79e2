import { basename } from 'node:path';
import type { CutTarget, TransferResult } from '../../api/index.js';
import { dracoOf, meshoptView } from '../../gltf/checks/check-geometry.js';
import type { Form } from '../../gltf/glb-writer.js';
import { isShown, type Paint, type PaintArea, zoneAttribute } from '../../gltf/overlay.js';
import { opacityOf } from '../../gltf/paint/opacity.js';
import { preparePiece } from '../../gltf/primitive-group.js';
import { writeTransfer } from '../../gltf/write-transfer.js';
import { naming } from '../../scene/input-error.js';
import { packDraco } from '../io/draco-write.js';
import { decodeImage } from '../io/images.js';
import type { Io } from '../io/io.js';
import { isByTemplate, type TransferCommand, texturePath } from '../model/sources.js';
import { boundsOfTile, isTiled, type UvBounds } from '../model/uv-bounds.js';
import type { readModel } from './models.js';
import { readTarget } from './read-target.js';
import { cutTarget, type Run, runTransfer } from './run-transfer.js';
import { readPaint, readTiles } from './textures.js';

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

/** How many of some flags are 1. */
export const countOf = (flags: Uint8Array): number => flags.reduce((sum, one) => sum + one, 0);

/** Runs the transfer of a region. Triangles that an earlier one paints are not painted again. */
export async function transferRegion(
  command: TransferCommand,
  texture: string | undefined,
  io: Io,
  { readCage, isLast, before, zones = zoneAttribute }: RegionContext,
): Promise<RegionRun> {
  const { target, output, reading, uvBounds } = command;
  const isKnown = texture !== undefined && !isByTemplate(texture);
  const known = isKnown && !isTiled(texture) ? await readPaint(texture, reading.limits) : undefined;
  const model = before && (await readTarget(target, reading, io, command.rules, before.bytes));
  const run = await runTransfer(command, io, readCage, model);
  const path = texture && texturePath(texture, run.choice?.template);
  const tiles = path && isTiled(path) ? await readTiles(path, run.cage, reading.limits) : [];
  const paint = known ?? (path && !isTiled(path) ? await readPaint(path, reading.limits) : undefined);
  const areas: PaintArea[] = uvBounds ? ['bounded'] : tiles.map(({ tile }) => ({ tile }));
  const paints: Paint[] = (paint ? [paint] : tiles).map((one, i) => ({ ...one, area: areas[i] }));
  // Triangles in an overlay change the order of all, by which painted ones are known.
  if (output !== undefined && isLast) for (const one of paints) one.hides = await opacityOf(one, decodeImage);
  const cutMesh = output !== undefined && command.borders === 'cut' ? cutTarget(run, io) : undefined;
  const shown = shownTriangles(areas, run.result, run.target.extracted.mesh.indices);
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
  io.step(`writing ${output ?? target}`);
  const form = before?.form ?? command.compress;
  const isText = isLast && output !== undefined && /\.gltf$/i.test(output);
  const { file, extracted } = run.target;
  const prepared = extracted.parts.map((part) =>
    preparePiece(
      part,
      cut ? run.result : { ...run.result, cosmeticTriangles: own },
      cut && { ...cut, cosmeticTriangles: own },
    ),
  );
  const written = await naming(target, () =>
    writeTransfer(file, extracted, prepared, {
      paints,
      // Draco changes the order of triangles, which says what is painted already.
      form: isLast ? form : compressionOf(run) === undefined ? 'keep' : 'none',
      packDraco,
      zones,
      isFurther: before !== undefined,
      stem: isText ? basename(output).slice(0, -'.gltf'.length) : undefined,
    }),
  );
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
export function compressionOf({ target: { file } }: Run): Form | undefined {
  const { meshes = [], bufferViews = [] } = file.json;
  if (meshes.some(({ primitives }) => primitives.some(dracoOf))) return 'draco';
  return bufferViews.some(meshoptView) ? 'meshopt' : undefined;
}
