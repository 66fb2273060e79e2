import { mostTexels } from '../../bake/image.js';
import { type Baked, cageTexture, fill, type Image, type Layout, resize, type Wrap } from '../../bake/index.js';
import { FileModel } from '../../gltf/bake/file.js';
import { type BakeReport, bakeModel, layoutOf, type Paints, type TextureUse } from '../../gltf/bake/plan.js';
import { takeOverlays } from '../../gltf/earlier-transfer.js';
import type { Part } from '../../gltf/extract.js';
import { GlbWriter } from '../../gltf/glb-writer.js';
import { InputError } from '../../gltf/input-error.js';
import { CagecastError, type CutTarget } from '../../index.js';
import { refuseOverwritingRead } from '../beside.js';
import { configLine, matcher, noSuchName, quoted } from '../options.js';
import { writeFiles } from '../output.js';
import type { Found } from '../print.js';
import type { Progress } from '../progress.js';
import { cutTarget, type Run, runTransfer, type Sources } from '../run.js';
import { percent, takenAway } from '../table.js';
import { decodeImage, encodePng, readImage } from './images.js';

/** The arguments of `cagecast bake`. */
export interface BakeCommand extends Sources {
  /** Files of images in the cage's UVs. */
  paint?: string | undefined;
  normal?: string | undefined;
  orm?: string | undefined;
  /** A GLB or VRM, or a PNG: the paint alone, in the model's UVs. */
  output: string;
  /** Whether the PNG is in the cage's UVs: what is painted on the model. */
  back: boolean;
  /** Names of the parts whose texture is meant, for a PNG; empty for all. */
  part: string[];
  size?: number | undefined;
  borders: 'triangle' | 'cut';
}

/** Side of a PNG if the model has no texture. */
const kSide = 1024;

/**
 * Bakes paints into a model's own textures, or into a PNG.
 * @throws {InputError} that names the file at fault; then no file is written.
 */
export async function bakeCommand(command: BakeCommand, progress: Progress): Promise<Found> {
  const { paint, normal, orm, reading } = command;
  const [color, normals, rough] = await Promise.all(
    [paint, normal, orm].map((path) => (path === undefined ? undefined : readImage(path, reading))),
  );
  const run = await runTransfer(command, progress);
  const cut = command.borders === 'cut' ? cutTarget(run, progress) : undefined;
  progress.step('baking');
  return command.output.toLowerCase().endsWith('.png')
    ? bakePicture(command, run, cut, color)
    : bakeFile(command, run, cut, { color, normal: normals, orm: rough });
}

/** An error of reading or baking the target, with its name. */
function inTarget(error: unknown, path: string): unknown {
  if (error instanceof CagecastError) return new InputError(error.message, { cause: error }).in(path);
  return error instanceof InputError ? error.in(path) : error;
}

/** Writes the output. @throws {InputError} if it would overwrite what was read. */
function write(command: BakeCommand, run: Run, data: Uint8Array): void {
  const { output, paint, normal, orm } = command;
  refuseOverwritingRead(command, run, [output], [paint, normal, orm]);
  writeFiles([{ path: output, data }]);
}

/** Writes the model with the paint in its textures. */
async function bakeFile(command: BakeCommand, run: Run, cut: CutTarget | undefined, paints: Paints): Promise<Found> {
  const { output, target, size } = command;
  const writer = await GlbWriter.from(run.targetFile, 'keep').catch((error) => {
    throw inTarget(error, target);
  });
  const overlays = takeOverlays(
    writer,
    run.target.parts.map(({ mesh }) => writer.json.meshes![mesh]!),
  );
  const model = new FileModel(run.targetFile, run.target.parts, writer);
  const { report } = await bakeModel(model, {
    result: run.result,
    cut: cut && { target: cut, ownCount: run.target.mesh.positions.length / 3 },
    paints,
    codec: { decode: decodeImage, encode: encodePng },
    size,
  }).catch((error) => {
    throw inTarget(error, target);
  });
  if (report.textures.length === 0) {
    const [first] = report.left;
    throw new InputError(
      first ? `nothing can be baked: ${quoted(first.part)}: ${first.reason}` : 'nothing of it may be painted',
    ).in(target);
  }
  write(command, run, writer.finish());
  const { config } = command.rules;
  const lines = [summary(output, report), overlays > 0 ? takenAway(overlays) : '', configLine(config)];
  return {
    text: lines.filter(Boolean).join('\n'),
    report: { output, ...report, replacedOverlays: overlays, config: config ?? null },
  };
}

function summary(output: string, { textures, left }: BakeReport): string {
  return [
    `wrote ${output}`,
    ...textures.map(
      ({ slot, parts, width, height, overlap }) =>
        `${slot}: ${width} × ${height}, on ${list(parts)}${overlapText(overlap)}`,
    ),
    ...left.map(
      ({ part, material, reason }) =>
        `not painted: ${quoted(part)}${material === undefined ? '' : `, with ${quoted(material)} of its variants`}: ${reason}`,
    ),
  ].join('\n');
}

const kMostNames = 8;
const kFewTexels = 0.001; // is due to touching edges

const list = (names: readonly string[]): string =>
  `${names.slice(0, kMostNames).map(quoted).join(', ')}${names.length > kMostNames ? `, and ${names.length - kMostNames} more` : ''}`;

const overlapText = ({ texels, lost, parts }: Baked['overlap']): string =>
  texels < kFewTexels
    ? ''
    : `; UVs overlap: ${percent(texels)} of its texels are claimed twice, ${percent(lost)} of the paint found no room (${list(parts)})`;

/** Writes the paint alone in the model's UVs, or what is painted on the model in the cage's. */
async function bakePicture(command: BakeCommand, run: Run, cut: CutTarget | undefined, color?: Image): Promise<Found> {
  const { output, target, size, back } = command;
  try {
    const writer = await GlbWriter.from(run.targetFile, 'keep');
    const model = new FileModel(run.targetFile, run.target.parts, writer);
    const { parts, texture } = oneTexture(model, run, command.part);
    const file = texture === undefined ? undefined : await model.imageOf(texture);
    const own =
      file &&
      (await decodeImage(file.bytes).catch((error: unknown) => {
        if (back || size === undefined)
          throw new InputError(`its texture ${(error as Error).message}`, { cause: error });
        return undefined; // Only its proportions were asked for.
      }));
    const ownCount = run.target.mesh.positions.length / 3;
    const found = { result: run.result, cut: cut && { target: cut, ownCount } };
    const layouts = parts.map((part) => layoutOf(model, part, useOf(model, part), found));
    if (back && !own) throw new InputError('its painted parts have no texture to take the paint from');
    const [wide, high] = back || !own ? [size ?? kSide, size ?? kSide] : scaledTo(own, size);
    const whole = own && parts.every((part) => isOpaque(model, part)) ? withoutAlpha(own) : own;
    const baked = back
      ? pictureOfCage(unrolled(whole!, layouts, uses(model, parts[0]!)!.wraps), distancesOf(parts, run, cut), wide)
      : fill('bake', layouts, color!, { width: wide, height: high });
    write(command, run, await encodePng(baked));
    const names = parts.map(({ name }) => name);
    const { overlap } = baked;
    const { config } = command.rules;
    const wrote = `wrote ${output}: ${wide} × ${high}, ${back ? 'of' : 'for'} ${list(names)}${back ? '' : overlapText(overlap)}`;
    return {
      text: [wrote, configLine(config)].filter(Boolean).join('\n'),
      report: { output, parts: names, width: wide, height: high, overlap, config: config ?? null },
    };
  } catch (error) {
    throw inTarget(error, target);
  }
}

/** Width and height of an image whose longer side is scaled to a size, if one is given. */
function scaledTo({ width, height }: Image, size = Math.max(width, height)): [number, number] {
  const scaled = (side: number) => Math.max(1, Math.round((size * side) / Math.max(width, height)));
  return [scaled(width), scaled(height)];
}

/** An image of which all is opaque, as the materials have it that show it. */
const withoutAlpha = (image: Image): Image => ({
  ...image,
  data: image.data.map((byte, i) => (i % 4 === 3 ? 255 : byte)),
});

/** Whether a part's material pays no heed to the alpha of its texture. */
function isOpaque(model: FileModel, part: Part): boolean {
  const material = model.materialOf(part);
  return material !== undefined && model.isOpaque(material);
}

/** The texture of a model, and how its triangles lie in it. */
interface ModelTexture {
  image: Image;
  layouts: readonly Layout[];
}

/** A texture that is mirrored or clamped where UVs leave 0..1, as one that repeats. Clamped are the corners of triangles. */
function unrolled(image: Image, layouts: readonly Layout[], wraps: readonly [Wrap, Wrap]): ModelTexture {
  let texture: ModelTexture = { image, layouts };
  for (const [k, wrap] of wraps.entries()) {
    const isInside = (at: number, i: number) => i % 2 !== k || (at >= 0 && at <= 1);
    if (wrap === 'repeat' || layouts.every(({ to }) => to.every(isInside))) continue;
    const middle = 0.5 / (k === 0 ? image.width : image.height); // of the first texel
    const place = (at: number) => (wrap === 'mirror' ? at / 2 : Math.min(1 - middle, Math.max(middle, at)));
    texture = {
      image: wrap === 'mirror' ? withMirrorImage(texture.image, k) : texture.image,
      layouts: texture.layouts.map((layout) => ({
        ...layout,
        to: layout.to.map((at, i) => (i % 2 === k ? place(at) : at)),
      })),
    };
  }
  return texture;
}

/** An image and its mirror image, side by side or one above the other; coarser if that would be too large. */
function withMirrorImage(image: Image, axis: number): Image {
  const most = mostTexels / 2;
  const fits = axis === 0 ? [Math.min(image.width, most), image.height] : [image.width, Math.min(image.height, most)];
  const { width, height, data } = resize(image, fits[0]!, fits[1]!);
  const [wide, high] = axis === 0 ? [2 * width, height] : [width, 2 * height];
  const out = new Uint8ClampedArray(4 * wide * high);
  for (let y = 0; y < high; ++y)
    for (let x = 0; x < wide; ++x) {
      const from = 4 * (Math.min(y, 2 * height - 1 - y) * width + Math.min(x, 2 * width - 1 - x));
      out.set(data.subarray(from, from + 4), 4 * (y * wide + x));
    }
  return { width: wide, height: high, data: out };
}

/** How far each triangle of the layouts of some parts is from the cage, on average. */
function distancesOf(parts: readonly Part[], { target, result }: Run, cut: CutTarget | undefined): number[] {
  const { indices } = target.mesh;
  const far = 1e30; // for triangles that the cage does not reach
  const distance = (t: number) =>
    [0, 1, 2].reduce((sum, k) => sum + Math.min(far, result.distances[indices[3 * t + k]!]!), 0) / 3;
  return parts.flatMap(({ firstTriangle, triangleCount }) => {
    const isOwn = (t: number) => t >= firstTriangle && t < firstTriangle + triangleCount;
    const own = cut
      ? [...cut.triangles].filter(isOwn)
      : Array.from({ length: triangleCount }, (_, t) => firstTriangle + t);
    return own.map(distance);
  });
}

/** What is painted on a model, in the cage's UVs. @param distances  Of each triangle: the nearest ones are seen. */
function pictureOfCage({ image, layouts }: ModelTexture, distances: readonly number[], width: number): Baked {
  const corners = layouts.map(({ painted }) => Uint32Array.from({ length: 3 * painted.length }, (_, i) => i));
  const all = (values: Layout['to'][]) => Float32Array.from(values.flatMap((one) => [...one]));
  const painted = Uint8Array.from(layouts.flatMap((layout) => [...layout.painted]));
  const indices = Uint32Array.from({ length: corners.reduce((sum, { length }) => sum + length, 0) }, (_, i) => i);
  const result = {
    uvs: all(layouts.map(({ from }) => from)),
    cornerUvs: new Float32Array(0),
    cosmeticTriangles: painted,
    distances: Float32Array.from(indices, (corner) => distances[Math.floor(corner / 3)]!),
  };
  return cageTexture({ indices, uvs: all(layouts.map(({ to }) => to)) }, result, image, { width });
}

/** How the texture of a part lies on it, if it has one. */
function uses(model: FileModel, part: Part): TextureUse<number> | undefined {
  const material = model.materialOf(part);
  return material === undefined ? undefined : model.useOf(material, 'color');
}

/** The same; by the first UVs if it has none. */
const useOf = (model: FileModel, part: Part): Pick<TextureUse<number>, 'set' | 'transform'> =>
  uses(model, part) ?? { set: 'TEXCOORD_0', transform: undefined };

/** The parts that share one texture. @throws {InputError} if there are several textures, or a part has no UVs. */
function oneTexture(model: FileModel, { result, target }: Run, names: readonly string[]) {
  const isPainted = ({ firstTriangle, triangleCount }: Part) =>
    result.cosmeticTriangles.subarray(firstTriangle, firstTriangle + triangleCount).includes(1);
  for (const name of names)
    if (!target.parts.some(({ aliases }) => aliases.some(matcher(name))))
      throw noSuchName(`--part ${name}`, target.parts);
  const isChosen = ({ aliases }: Part) => names.length === 0 || names.some((name) => aliases.some(matcher(name)));
  const chosen = target.parts.filter((part) => isPainted(part) && isChosen(part));
  const textured = chosen.filter((part) => uses(model, part));
  const painted = textured.length > 0 ? textured : chosen;
  if (painted.length === 0) throw new InputError('nothing of it may be painted');
  const bare = painted.find((part) => !model.uvsOf(part, useOf(model, part).set));
  if (bare)
    throw new InputError(
      `${quoted(bare.name)} has no ${useOf(model, bare).set}: a texture can only be laid on a model that is unwrapped`,
    );
  const textures = new Set(painted.map((part) => uses(model, part)?.texture));
  if (textures.size > 1)
    throw new InputError(
      `its painted parts have ${textures.size} textures, which a PNG cannot hold; choose parts of one by --part: ${list(painted.map(({ name }) => name))}`,
    );
  const [texture] = textures;
  // Other parts with this texture take their place in it.
  const parts =
    texture === undefined || names.length > 0
      ? painted
      : target.parts.filter(
          (part) => uses(model, part)?.texture === texture && model.uvsOf(part, useOf(model, part).set),
        );
  return { parts, texture };
}
