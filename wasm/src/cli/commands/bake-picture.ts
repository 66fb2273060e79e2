import type { CutTarget } from '../../api/index.js';
import { mostTexels } from '../../bake/image.js';
import { type Baked, cageTexture, fill, type Image, type Layout, resize, type Wrap } from '../../bake/index.js';
import { isEmpty, isPainted, kOutside, layoutOf, scaledTo } from '../../gltf/bake/plan.js';
import { preparePiece } from '../../gltf/primitive-group.js';
import { partsNamed } from '../../gltf/read-model.js';
import type { Part } from '../../scene/extract.js';
import { InputError } from '../../scene/input-error.js';
import { Materials } from '../../scene/materials.js';
import type { UvLayout } from '../../scene/uv-layout.js';
import { decodeImage } from '../io/images.js';
import { listed, quoted } from '../model/text.js';
import { noSuchName } from '../transfer/part-names.js';
import type { Run } from '../transfer/run-transfer.js';

/** What a picture is made for. */
interface PictureOptions {
  /** Names of the parts whose texture is meant; empty for all. */
  part?: readonly string[];
  /** Its longer side. */
  size?: number | undefined;
}

/** A picture, and the parts that it is of. */
interface Picture {
  image: Baked;
  parts: readonly Part[];
}

/** Side of a picture if the model has no texture. */
const kSide = 1024;
/** How many names a message lists at most. */
const kMaxNames = 8;

/** The paint alone, in the model's UVs. @throws {InputError} */
export async function paintForModel(
  { part = [], size }: PictureOptions,
  run: Run,
  cut: CutTarget | undefined,
  paint: Image,
): Promise<Picture> {
  const model = materialsOf(run);
  const { parts, texture } = oneTexture(model, run, part);
  const own = await imageOf(model, texture, size === undefined);
  const layouts = layoutsOf(model, parts, run, cut);
  const [width, height] = own ? scaledTo(own, size) : [size ?? kSide, size ?? kSide];
  const wraps = model.colorUseOf(parts[0]!)?.wraps;
  const image = fill('bake', layouts, paint, { width, height, wrap: wraps });
  if (wraps?.includes('clamp') && isEmpty(image)) throw new InputError(`${quoted(parts[0]!.name)}: ${kOutside}`);
  return { image, parts };
}

/** What is painted on the model, in the cage's UVs. @throws {InputError} */
export async function paintOfModel(
  { part = [], size = kSide }: PictureOptions,
  run: Run,
  cut: CutTarget | undefined,
): Promise<Picture> {
  const model = materialsOf(run);
  const { parts, texture } = oneTexture(model, run, part);
  const own = await imageOf(model, texture, true);
  const layouts = layoutsOf(model, parts, run, cut);
  if (!own) throw new InputError('its painted parts have no texture to take the paint from');
  const shown = parts.every((part) => isOpaque(model, part)) ? withoutAlpha(own) : own;
  const there = unrolled(shown, layouts, model.colorUseOf(parts[0]!)!.wraps);
  return { image: cageTextureOf(there, distancesOf(parts, run, cut), size), parts };
}

const materialsOf = ({ target: { file, extracted } }: Run) => new Materials(file, extracted.parts);

/** The image of a texture, if there is one. @param isNeeded  Whether one that cannot be decoded is an error. */
async function imageOf(model: Materials, texture: number | undefined, isNeeded: boolean): Promise<Image | undefined> {
  const file = texture === undefined ? undefined : await model.source.imageOf(texture);
  return (
    file &&
    decodeImage(file.bytes).catch((error: unknown) => {
      if (isNeeded) throw new InputError(`its texture ${(error as Error).message}`, { cause: error });
      return undefined;
    })
  );
}

/** How the triangles of parts lie in their texture and in the cage's. */
function layoutsOf(model: Materials, parts: readonly Part[], run: Run, cut: CutTarget | undefined): Layout[] {
  return parts.map((part) =>
    layoutOf(model, part, uvLayoutOf(model, part), { prepared: (part) => preparePiece(part, run.result, cut) }),
  );
}

/** An image of which all is opaque, as the materials have it that show it. */
const withoutAlpha = (image: Image): Image => ({
  ...image,
  data: image.data.map((byte, i) => (i % 4 === 3 ? 255 : byte)),
});

/** Whether a part's material pays no heed to the alpha of its texture. */
function isOpaque(model: Materials, part: Part): boolean {
  const material = model.materialOf(part);
  return material !== undefined && model.isOpaque(material);
}

/** The texture of a model, and how its triangles lie in it. */
interface ModelTexture {
  image: Image;
  layouts: readonly Layout[];
}

/** A texture that is mirrored or clamped where UVs leave 0..1, as one that repeats. */
function unrolled(image: Image, layouts: readonly Layout[], wraps: readonly [Wrap, Wrap]): ModelTexture {
  let texture: ModelTexture = { image, layouts };
  for (const [axis, wrap] of wraps.entries()) {
    const isInside = (at: number, i: number) => i % 2 !== axis || (at >= 0 && at <= 1);
    if (wrap === 'repeat' || layouts.every(({ to }) => to.every(isInside))) continue;
    texture = wrap === 'mirror' ? mirrored(texture, axis) : clamped(texture, axis);
  }
  return texture;
}

/** A texture and its mirror image, side by side or one above the other; coarser if that would be too large. */
function mirrored({ image, layouts }: ModelTexture, axis: number): ModelTexture {
  const most = mostTexels / 2;
  const fits = axis === 0 ? [Math.min(image.width, most), image.height] : [image.width, Math.min(image.height, most)];
  const length = fits[axis]!;
  return {
    image: extended(resize(image, fits[0]!, fits[1]!), axis, 2 * length, (at) => Math.min(at, 2 * length - 1 - at)),
    layouts: placed(layouts, axis, (at) => at / 2),
  };
}

/**
 * A texture with its outer texels repeated as far as UVs reach beyond them, but half its length at most, and not if that would be too
 * large. Corners of triangles that reach further are clamped.
 */
function clamped({ image, layouts }: ModelTexture, axis: number): ModelTexture {
  const length = axis === 0 ? image.width : image.height;
  const most = Math.floor(Math.min(length, mostTexels - length) / 2);
  let [low, high] = [0, 1];
  for (const { to } of layouts)
    for (let i = axis; i < to.length; i += 2) [low, high] = [Math.min(low, to[i]!), Math.max(high, to[i]!)];
  const before = Math.min(most, Math.ceil(-low * length));
  const all = before + length + Math.min(most, Math.ceil((high - 1) * length));
  const middle = 0.5 / all; // of the first texel
  return {
    image: extended(image, axis, all, (at) => Math.min(length - 1, Math.max(0, at - before))),
    layouts: placed(layouts, axis, (at) => Math.min(1 - middle, Math.max(middle, (before + at * length) / all))),
  };
}

/** Layouts whose UVs along an axis are elsewhere. */
const placed = (layouts: readonly Layout[], axis: number, place: (at: number) => number): Layout[] =>
  layouts.map((layout) => ({ ...layout, to: layout.to.map((at, i) => (i % 2 === axis ? place(at) : at)) }));

/** An image of another length along an axis. @param from  The place of each of its texels in the image before. */
function extended(image: Image, axis: number, length: number, from: (at: number) => number): Image {
  const { width, height, data } = image;
  const [wide, high] = axis === 0 ? [length, height] : [width, length];
  const out = new Uint8ClampedArray(4 * wide * high);
  for (let y = 0; y < high; ++y)
    for (let x = 0; x < wide; ++x) {
      const there = axis === 0 ? y * width + from(x) : from(y) * width + x;
      out.set(data.subarray(4 * there, 4 * there + 4), 4 * (y * wide + x));
    }
  return { width: wide, height: high, data: out };
}

/** How far each triangle of the layouts of some parts is from the cage, on average. */
function distancesOf(parts: readonly Part[], { target, result }: Run, cut: CutTarget | undefined): number[] {
  const { indices } = target.extracted.mesh;
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

/** The cage's texture of a painted model. @param distances  Of each triangle: the nearest ones are seen. */
function cageTextureOf({ image, layouts }: ModelTexture, distances: readonly number[], width: number): Baked {
  const all = (values: Layout['to'][]) => Float32Array.from(values.flatMap((one) => [...one]));
  const painted = Uint8Array.from(layouts.flatMap((layout) => [...layout.painted]));
  const indices = Uint32Array.from({ length: 3 * painted.length }, (_, i) => i);
  const result = {
    uvs: all(layouts.map(({ from }) => from)),
    cornerUvs: new Float32Array(0),
    cosmeticTriangles: painted,
    distances: Float32Array.from(indices, (corner) => distances[Math.floor(corner / 3)]!),
  };
  return cageTexture({ indices, uvs: all(layouts.map(({ to }) => to)) }, result, image, { width });
}

/** The UVs by which a texture lies on a part: those of its own, else the first. */
const uvLayoutOf = (model: Materials, part: Part): UvLayout =>
  model.colorUseOf(part) ?? { set: 'TEXCOORD_0', transform: undefined };

/** The parts that share one texture. @throws {InputError} if there are several textures, or a part has no UVs. */
function oneTexture(model: Materials, { result, target }: Run, names: readonly string[]) {
  const meant = names.flatMap((name) => {
    const found = partsNamed(name, target);
    if (found.length === 0) throw noSuchName(`--part ${name}`, target);
    return found;
  });
  const isChosen = (p: number) => names.length === 0 || meant.includes(p);
  const all = target.extracted.parts;
  const chosen = all.filter((part, p) => isPainted(part, result) && isChosen(p));
  const textured = chosen.filter((part) => model.colorUseOf(part));
  const painted = textured.length > 0 ? textured : chosen;
  if (painted.length === 0) throw new InputError('nothing of it may be painted');
  const withoutUvs = painted.find((part) => !model.uvsOf(part, uvLayoutOf(model, part).set));
  if (withoutUvs)
    throw new InputError(
      `${quoted(withoutUvs.name)} has no ${uvLayoutOf(model, withoutUvs).set}: a texture can only be laid on a model that is unwrapped`,
    );
  const textures = new Set(painted.map((part) => model.colorUseOf(part)?.texture));
  if (textures.size > 1)
    throw new InputError(
      `its painted parts have ${textures.size} textures, which a PNG cannot hold; choose parts of one by --part: ${listNames(painted.map(({ name }) => name))}`,
    );
  const [texture] = textures;
  // Other parts with this texture take their place in it.
  const parts =
    texture === undefined || names.length > 0
      ? painted
      : all.filter(
          (part) => model.colorUseOf(part)?.texture === texture && model.uvsOf(part, uvLayoutOf(model, part).set),
        );
  return { parts, texture };
}

/** Names in a message. */
export const listNames = (names: readonly string[]): string => listed(names.map(quoted), kMaxNames);
