import type { TransferResult } from '../../api/index.js';
import { colorByte, linearOf } from '../../bake/image.js';
import {
  areaOf,
  type Baked,
  fill,
  type Image,
  type Kind,
  type Layout,
  layOver,
  mostTexels,
  resize,
} from '../../bake/index.js';
import { kMaxLayers } from '../../bake/pattern.js';
import { CagecastError } from '../../core/error.js';
import { applySplit } from '../../parts/blend.js';
import type { PreparedPart } from '../../parts/prepare.js';
import { gather } from '../../parts/split-part.js';
import type { Part } from '../../scene/extract.js';
import type { ImageCodec, Materials, Place, Slot, TextureUse } from '../../scene/materials.js';
import { requireFinite } from '../../scene/pieces.js';
import { layUvs, type UvLayout } from '../../scene/uv-layout.js';
import { imageSize, imageType } from '../image-file.js';

const kindOf: Record<Slot, Kind> = { color: 'color', normal: 'normal', orm: 'data' };

/** A model whose materials can be painted. */
export interface BakeModel extends Materials {
  /**
   * Gives materials a new texture in a slot, a file with the factor in it.
   * @param use       Whose UVs and wrap modes it has.
   * @param strength  Of what glows: by what its colours have to be multiplied.
   */
  replace(materials: readonly number[], slot: Place, bytes: Uint8Array, use: TextureUse, strength: number): void;
}

/** Whether a triangle of a part may be painted. */
export const isPainted = (
  { firstTriangle, triangleCount }: Part,
  { cosmeticTriangles }: Pick<TransferResult, 'cosmeticTriangles'>,
): boolean => cosmeticTriangles.subarray(firstTriangle, firstTriangle + triangleCount).includes(1);

/** Paints in the cage's UVs: colours; a normal map; occlusion, roughness and metalness in red, green and blue. Each has an alpha. */
export interface Paints {
  color?: Image | undefined;
  normal?: Image | undefined;
  orm?: Image | undefined;
}

/** What `bake` did. */
export interface BakeReport {
  /** The textures that have paint now: of which parts, and how their UVs overlap. */
  textures: {
    slot: Place;
    parts: string[];
    width: number;
    height: number;
    overlap: Baked['overlap'];
    /** The media type of its image, and of the one before, if there was one. */
    mimeType: string;
    before: string | undefined;
  }[];
  /** Parts whose textures cannot hold the paint, and why; with the material, if it is a variant's. */
  left: { part: string; material?: string; reason: string }[];
  /** Materials whose textures are moved while they are shown, by scrolling UVs or an expression of an avatar: the paint moves, too. */
  moving: { material: string; reason: string }[];
}

/** Bakes an image in the cage's UVs into those of a texture. */
export type Fill = (image: Image, kind: Kind) => Baked;

/** The texture of a material as it was, and by what its values are multiplied. */
export interface Base {
  image: Image;
  factor: readonly [number, number, number];
  /** By what the relief of a normal map is multiplied. */
  relief: number;
}

/** A texture as it is to be, with all factors in it. */
interface Coated {
  image: Image;
  /** The paint that is in it. */
  baked: Baked;
  /** Of what glows: by what its colours have to be multiplied. Default: 1. */
  strength?: number;
}

/** Lays something over a texture. @returns undefined if that leaves it as it is. */
export type Coat = (base: Base, fill: Fill) => Coated | undefined;

/** What is laid over textures, and on the materials of which lighting it is seen; by default, of any. */
export type Coats = Partial<Record<Place, { lay: Coat; on?: readonly ReturnType<Materials['lightingOf']>[] }>>;

const kPlaces: readonly Place[] = ['color', 'shade', 'normal', 'orm', 'emissive'];

/** Paint as it is in the texture of the shade. */
export function inShade(baked: Baked, factor: Base['factor']): Baked {
  const toByte = colorByte();
  const data = baked.data.map((byte, at) => (at % 4 === 3 ? byte : toByte(linearOf[byte]! * factor[at % 4]!)));
  return factor.every((share) => share === 1) ? baked : { ...baked, data };
}

/** Paints as they are laid over textures. */
export function coatsOf(paints: Paints): Coats {
  const coats: Coats = {};
  for (const slot of Object.keys(kindOf) as Slot[]) {
    const paint = paints[slot];
    if (!paint) continue;
    coats[slot] = {
      lay({ image, factor }, fill) {
        const baked = fill(paint, kindOf[slot]);
        return { baked, image: layOver(image, baked, factor) };
      },
    };
  }
  const { color } = paints;
  if (color)
    coats.shade = {
      lay({ image, factor }, fill) {
        const baked = fill(color, 'color');
        return { baked, image: layOver(image, inShade(baked, factor)) };
      },
      on: ['toon'],
    };
  return coats;
}

/** What is baked. */
export interface BakeInput {
  result: Pick<TransferResult, 'cosmeticTriangles'>;
  /** What the transfer makes of a part. */
  prepared: (part: Part) => PreparedPart;
  coats: Coats;
  codec: ImageCodec;
  /** The longer side of new textures; that of the model's own by default. */
  size?: number | undefined;
}

/** If more of the paint than this has no area in the texture, it is a palette, which cannot hold paint. */
const kMaxFlat = 0.1; // of its area in the cage's UVs
const kFlat = 0.01; // texels
const kMaxLost = 0.6; // of the paint; the same for a part of the texture
/** The type of images that say no other. */
const kPng = 'image/png';
/** Side of a texture that a material did not have. */
const kNewSide = 1024;

const slotNames: Record<Place, string> = {
  color: 'base colour',
  normal: 'normal',
  orm: 'metallic-roughness',
  emissive: 'emissive',
  shade: 'shade',
};

/** A part, and its material or one that a variant gives it. */
interface User {
  part: Part;
  material: number | undefined;
}

/** A texture with a factor, and the materials that use it so, with all their parts, painted or not. */
interface SharedTexture {
  /** How the texture is used: whoever uses it in the same way shares its copy. */
  key: string;
  slot: Place;
  use: TextureUse;
  /** Whether the material has no texture in this slot yet. */
  isNew: boolean;
  /** Whether the red of its texture meant nothing, and will be occlusion. */
  redIsNew: boolean;
  factor: readonly [number, number, number];
  relief: number;
  users: (User & { material: number })[];
}

/**
 * Bakes paints into the textures of a model; see `bake` of cagecast/gltf. If it throws, the model is unchanged.
 * @returns what was done, and the parts that are baked: with their colours, if there are any.
 */
export async function bakeModel(model: BakeModel, input: BakeInput): Promise<{ report: BakeReport; baked: Set<Part> }> {
  const report: BakeReport = { textures: [], left: [], moving: [] };
  const baked = new Set<Part>();
  const replacements: (() => void)[] = [];
  /** Materials that cannot have the colours: what shows these there shows them in the shade, too. */
  const uncolored = new Set<number | undefined>();
  for (const slot of kPlaces) {
    const coat = input.coats[slot];
    if (!coat) continue;
    const refused = new Map<User, string>();
    const isSeen = (material: number) =>
      (coat.on?.includes(model.lightingOf(material)) ?? true) && !(slot === 'shade' && uncolored.has(material));
    for (const shared of listTextures(model, slot, refused, isSeen)) {
      const painted = new Set(shared.users.map(({ part }) => part).filter((part) => isPainted(part, input.result)));
      if (painted.size === 0) continue;
      const made = await bakeTexture(model, shared, coat.lay, input);
      if (!made) continue;
      if (typeof made === 'string') {
        for (const user of shared.users) refused.set(user, made);
        continue;
      }
      const { width, height, overlap, bytes, before, strength } = made;
      const materials = [...new Set(shared.users.map(({ material }) => material))];
      replacements.push(() => model.replace(materials, slot, bytes, shared.use, strength));
      for (const { part, material } of shared.users) if (material === model.materialOf(part)) baked.add(part);
      const parts = [...painted].map(({ name }) => name);
      report.textures.push({ slot, parts, width, height, overlap, mimeType: imageType(bytes) ?? kPng, before });
    }
    for (const [{ part, material }, reason] of refused) {
      if (slot === 'color') uncolored.add(material);
      const ofVariant = material !== model.materialOf(part) && { material: model.nameOf(material!) };
      const left = { part: part.name, ...ofVariant, reason };
      const isTold = report.left.some((one) => JSON.stringify(one) === JSON.stringify(left));
      if (isPainted(part, input.result) && !isTold) report.left.push(left);
    }
  }
  for (const replace of replacements) replace();
  for (const part of baked) if (uncolored.has(model.materialOf(part))) baked.delete(part);
  for (const number of new Set([...baked].flatMap((part) => [model.materialOf(part)!, ...model.variantsOf(part)])))
    for (const reason of model.movedBy(number)) report.moving.push({ material: model.nameOf(number), reason });
  return { report, baked };
}

/**
 * The textures that can be painted.
 * @param refused  Gets what cannot be, and why.
 * @param isSeen   Whether the slot of a material is seen; the others are left out.
 */
function listTextures(
  model: BakeModel,
  slot: Place,
  refused: Map<User, string>,
  isSeen: (material: number) => boolean,
): SharedTexture[] {
  const textures: SharedTexture[] = [];
  const users = new Map<number, Part[]>();
  for (const part of model.parts)
    for (const material of new Set([model.materialOf(part), ...model.variantsOf(part)]))
      if (material === undefined) refused.set({ part, material }, 'it has no material');
      else if (isSeen(material)) users.set(material, [...(users.get(material) ?? []), part]);
  for (const [material, parts] of users) {
    const own = model.useOf(material, slot);
    const use = own ?? model.useOf(material, 'color');
    const reason = !use
      ? 'its material has no texture'
      : parts.some((part) => !model.uvsOf(part, use.set))
        ? `it has no ${use.set}, the UVs of its texture`
        : slot === 'color' && parts.some((part) => isTinted(model, part))
          ? 'its vertices have colours'
          : undefined;
    if (!use || reason) {
      for (const part of parts) refused.set({ part, material }, reason!);
      continue;
    }
    // It is painted with the colours then.
    if (slot === 'shade' && isSameInShade(model, material)) continue;
    const factor = model.factorOf(material, slot);
    const relief = slot === 'normal' ? model.reliefOf(material) : 1;
    const isNew = !own;
    const redIsNew = slot === 'orm' && !model.hasOcclusion(material);
    // A new texture lies as that of the colours, which are painted once for each factor.
    const key = JSON.stringify([isNew && model.factorOf(material, 'color'), redIsNew, factor, relief, use.wraps]);
    const known = textures.find((shared) => shared.key === key && shared.use.texture === use.texture);
    const shared = known ?? { key, slot, use, isNew, redIsNew, factor, relief, users: [] };
    if (!known) textures.push(shared);
    for (const part of parts) shared.users.push({ part, material });
  }
  return textures;
}

/** Whether a toon material shows in the shade the very texture that it shows in the light. */
function isSameInShade(model: BakeModel, material: number): boolean {
  const [lit, shade] = [model.useOf(material, 'color'), model.useOf(material, 'shade')];
  const isPlain = model.factorOf(material, 'color').every((share) => share === 1);
  return isPlain && lit !== undefined && lit.texture === shade?.texture;
}

/** Whether its vertices have colours, by which its texture is multiplied. Many programs write white ones. */
function isTinted(model: BakeModel, part: Part): boolean | undefined {
  const colors = model.colorsOf(part, 'COLOR_0');
  return colors?.values.some((value, i) => i % colors.size < 3 && value !== 1);
}

/** A texture that was baked: as a file, and the type of the one before. */
type Made = Baked & { bytes: Uint8Array; before: string | undefined; strength: number };

/** Bakes a shared texture. @returns why not, if it cannot be; undefined if it stays as it is. */
async function bakeTexture(
  model: BakeModel,
  shared: SharedTexture,
  lay: Coat,
  input: BakeInput,
): Promise<Made | string | undefined> {
  const { use, factor, relief } = shared;
  const base = await baseOf(model, shared, input);
  if (typeof base === 'string') return base;
  const layouts = layoutsOn(model, shared, input);
  const wrong = unusable(layouts, base.width * base.height);
  if (wrong) return wrong;
  const { width, height } = base;
  const coated = lay({ image: base, factor, relief }, (image, kind) =>
    fill('bake', layouts, image, { width, height, wrap: use.wraps, kind }),
  );
  if (!coated) return undefined;
  const { image, baked, strength = 1 } = coated;
  if (use.wraps.includes('clamp') && isEmpty(baked)) return kOutside;
  if (baked.overlap.lost > kMaxLost) return 'most of its paint would lie on that of others';
  const before = shared.isNew ? undefined : (await model.source.imageOf(use.texture))?.mimeType;
  return { ...baked, bytes: await input.codec.encode(image, before), before, strength };
}

/** Why a texture that is clamped has nothing of a paint. */
export const kOutside =
  'its UVs lie outside of 0..1, where its texture is clamped: nothing of the paint would be in it';

/** Whether nothing of a paint is in a texture. */
export const isEmpty = ({ mask }: Baked): boolean => mask.every((one) => one === 0);

/** The triangles on a shared texture; once, where several materials lay a part in the same way. */
function layoutsOn(model: BakeModel, { slot, users }: SharedTexture, input: BakeInput): Layout[] {
  const known = new Set<string>();
  return users.flatMap(({ part, material }) => {
    const use = model.useOf(material, slot) ?? model.useOf(material, 'color')!;
    const key = JSON.stringify([part.firstTriangle, use.set, use.transform]);
    if (known.has(key)) return [];
    known.add(key);
    return layoutOf(model, part, use, input);
  });
}

/** The image of a shared texture, or what stands for it: a flat normal map, say. */
async function baseOf(
  model: BakeModel,
  { use, isNew, redIsNew, slot }: SharedTexture,
  { codec, size }: BakeInput,
): Promise<Image | string> {
  if (isNew) {
    const side = size ?? kNewSide;
    const color = slot === 'normal' ? [128, 128, 255, 255] : [255, 255, 255, 255];
    return { width: side, height: side, data: new Uint8ClampedArray(4 * side * side).map((_, i) => color[i % 4]!) };
  }
  const file = await model.source.imageOf(use.texture);
  if (!file) return 'its texture has no image';
  const name = `its ${slotNames[slot]} texture (${file.mimeType})`;
  const said = imageSize(file.bytes);
  if (said && Math.max(said.width, said.height) > mostTexels)
    return `${name} has ${said.width} × ${said.height} pixels, more than ${mostTexels} × ${mostTexels}`;
  let image: Image;
  try {
    image = await codec.decode(file.bytes, file.mimeType);
  } catch (error) {
    if (error instanceof CagecastError) throw error;
    return `${name} cannot be read: ${error instanceof Error ? error.message : error}`;
  }
  if (redIsNew) image = { ...image, data: image.data.map((byte, i) => (i % 4 === 0 ? 255 : byte)) };
  return size === undefined ? image : resize(image, ...scaledTo(image, size));
}

/** Width and height of an image whose longer side is scaled to a size, if one is given. */
export function scaledTo({ width, height }: Image, size = Math.max(width, height)): [number, number] {
  const scaled = (side: number) => Math.max(1, Math.round((size * side) / Math.max(width, height)));
  return [scaled(width), scaled(height)];
}

/** The triangles of a part, cut where the result is, in the UVs of a texture and in the cage's. */
export function layoutOf(
  model: Materials,
  part: Part,
  { set, transform }: UvLayout,
  { prepared: prepare }: Pick<BakeInput, 'prepared'>,
): Layout {
  const prepared = prepare(part);
  const stored = model.uvsOf(part, set)!;
  requireFinite(`"${part.name}"`, set, stored, 2);
  const ofCorners = (values: Float32Array, size: number) =>
    gather(applySplit(values, size, prepared), size, prepared.indices);
  return {
    name: part.name,
    to: ofCorners(layUvs(stored, transform), 2),
    from: gather(prepared.uvs, 2, prepared.indices),
    painted: prepared.cosmeticTriangles,
    positions: ofCorners(part.localPositions, 3),
  };
}

/** Why UVs are not an unwrapping, if so. */
function unusable(layouts: readonly Layout[], texels: number): string | undefined {
  let [laid, flat, drawn] = [0, 0, 0];
  for (const { to, from, painted } of layouts) {
    painted.forEach((isPainted, t) => {
      const area = Math.abs(areaOf(to, 6 * t));
      laid += area;
      if (!isPainted) return;
      const own = Math.abs(areaOf(from, 6 * t));
      drawn += own;
      if (area * texels < kFlat) flat += own;
    });
  }
  if (laid > kMaxLayers) return 'its texture is a pattern that repeats';
  return flat > kMaxFlat * drawn ? 'its texture is a palette, or too small for paint' : undefined;
}
