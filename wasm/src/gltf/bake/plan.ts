import {
  areaOf,
  type Baked,
  fill,
  type Image,
  type Kind,
  type Layout,
  layOver,
  resize,
  type Wrap,
} from '../../bake/index.js';
import { CagecastError, type CutTarget, type TransferResult } from '../../index.js';
import { blend } from '../../parts/blend.js';
import { gather } from '../../parts/split-part.js';
import { InputError } from '../input-error.js';
import type { Piece } from '../pieces.js';
import { groupMember } from '../primitive-group.js';
import { transformUvs, type UvTransform } from '../uv-transform.js';

/** What of a material a paint goes to: its base colour, its normals, or occlusion, roughness and metalness. */
export const slots = ['color', 'normal', 'orm'] as const;
export type Slot = (typeof slots)[number];
const kindOf: Record<Slot, Kind> = { color: 'color', normal: 'normal', orm: 'data' };

/** How a texture is used by a material. */
export interface TextureUse<Texture> {
  texture: Texture;
  /** The UV set: "TEXCOORD_0". */
  set: string;
  transform: Partial<UvTransform> | undefined;
  wraps: readonly [Wrap, Wrap];
}

/** A model as baking sees it: a document, or a file as it is. */
export interface BakeModel<Material, Texture> {
  parts: readonly Piece[];
  materialOf(part: Piece): Material | undefined;
  /** The materials that variants give a part instead of its own. */
  variantsOf(part: Piece): Material[];
  nameOf(material: Material): string;
  /** The values of a set of UVs, decoded. */
  uvsOf(part: Piece, set: string): Float32Array | undefined;
  /** The values of an attribute of colours, decoded, and how many a vertex has. */
  colorsOf(part: Piece, semantic: string): { values: Float32Array; size: number } | undefined;
  /** Whether its vertices have colours, by which its texture is multiplied. */
  isTinted(part: Piece): boolean;
  useOf(material: Material, slot: Slot): TextureUse<Texture> | undefined;
  /** By what the values of the texture are multiplied. */
  factorOf(material: Material, slot: Slot): readonly [number, number, number];
  /** Whether a texture shows occlusion: the metallic-roughness one, or one of its own. */
  hasOcclusion(material: Material): boolean;
  imageOf(texture: Texture): Promise<{ bytes: Uint8Array; mimeType: string } | undefined>;
  /** Gives materials a new texture in a slot, a PNG with the factor in it. @param use  Whose UVs and wrap modes it has. */
  replace(materials: readonly Material[], slot: Slot, png: Uint8Array, use: TextureUse<Texture>): void;
}

/** Reads and writes image files. */
export interface ImageCodec {
  /** @throws {Error} if it cannot read such a file; the parts with this texture are not baked then. */
  decode: (bytes: Uint8Array, mimeType: string) => Promise<Image>;
  encode: (image: Image) => Promise<Uint8Array>;
}

/** Paints in the cage's UVs: colours; a normal map; occlusion, roughness and metalness in red, green and blue. Each has an alpha. */
export interface Paints {
  color?: Image | undefined;
  normal?: Image | undefined;
  orm?: Image | undefined;
}

/** What `bake` did. */
export interface BakeReport {
  /** The textures that have paint now: of which parts, and how their UVs overlap. */
  textures: { slot: Slot; parts: string[]; width: number; height: number; overlap: Baked['overlap'] }[];
  /** The parts that should be painted but have no texture that can hold it, and why; with a variant's material, if it is about that. */
  left: { part: string; material?: string; reason: string }[];
}

/** What is baked. */
export interface BakeInput {
  result: Pick<TransferResult, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>;
  cut?: { target: CutTarget; ownCount: number } | undefined;
  paints: Paints;
  codec: ImageCodec;
  /** The longer side of new textures; that of the model's own by default. */
  size?: number | undefined;
}

/** If more of the surface than this has no area in the texture, it is a palette, which cannot hold paint. */
const kMostFlat = 0.1; // of the painted surface
const kFlat = 0.01; // texels
/** A texture that is repeated more often than this is a pattern; mirrored halves use it twice at most. */
const kMostRepeats = 2.5;
const kMostLost = 0.6; // of the paint; the same for a part of the texture
/** Side of a texture that a material did not have. */
const kNewSide = 1024;

const kinds: Record<Slot, string> = { color: 'base colour', normal: 'normal', orm: 'metallic-roughness' };

/** A part, and its material or one that a variant gives it. */
interface User<Material> {
  part: Piece;
  material: Material | undefined;
}

/** A texture with a factor, and the materials that use it so, with all their parts, painted or not. */
interface Sheet<Material, Texture> {
  slot: Slot;
  use: TextureUse<Texture>;
  /** Whether the material has no texture in this slot yet. */
  isNew: boolean;
  /** Whether the red of its texture meant nothing, and will be occlusion. */
  redIsNew: boolean;
  factor: readonly [number, number, number];
  users: (User<Material> & { material: Material })[];
}

/** Bakes paints into the textures of a model; see `bake` of cagecast/gltf. @returns what was done, and the parts that are baked. */
export async function bakeModel<Material, Texture>(
  model: BakeModel<Material, Texture>,
  input: BakeInput,
): Promise<{ report: BakeReport; baked: Set<Piece> }> {
  const report: BakeReport = { textures: [], left: [] };
  const baked = new Set<Piece>();
  const { cosmeticTriangles } = input.result;
  const isPainted = ({ firstTriangle, triangleCount }: Piece) =>
    cosmeticTriangles.subarray(firstTriangle, firstTriangle + triangleCount).includes(1);
  for (const slot of slots) {
    const paint = input.paints[slot];
    if (!paint) continue;
    const refused = new Map<User<Material>, string>();
    for (const sheet of listSheets(model, slot, refused)) {
      const painted = new Set(sheet.users.map(({ part }) => part).filter(isPainted));
      if (painted.size === 0) continue;
      const done = await bakeSheet(model, sheet, paint, input);
      if (typeof done === 'string') {
        for (const user of sheet.users) refused.set(user, done);
        continue;
      }
      for (const { part, material } of sheet.users) if (material === model.materialOf(part)) baked.add(part);
      const { width, height, overlap } = done;
      report.textures.push({ slot, parts: [...painted].map(({ name }) => name), width, height, overlap });
    }
    for (const [{ part, material }, reason] of refused) {
      if (!isPainted(part)) continue;
      const ofVariant = material !== undefined && material !== model.materialOf(part);
      report.left.push({ part: part.name, ...(ofVariant && { material: model.nameOf(material) }), reason });
    }
  }
  return { report, baked };
}

/** The textures that can be painted. @param refused  Gets what cannot be, and why. */
function listSheets<Material, Texture>(
  model: BakeModel<Material, Texture>,
  slot: Slot,
  refused: Map<User<Material>, string>,
): Sheet<Material, Texture>[] {
  const sheets = new Map<string, Sheet<Material, Texture>>();
  const numbers = new Map<Texture, number>();
  const users = new Map<Material, Piece[]>();
  for (const part of model.parts) {
    const own = model.materialOf(part);
    if (own === undefined) refused.set({ part, material: own }, 'it has no material');
    for (const material of new Set([...(own === undefined ? [] : [own]), ...model.variantsOf(part)]))
      users.set(material, [...(users.get(material) ?? []), part]);
  }
  for (const [material, parts] of users) {
    const own = model.useOf(material, slot);
    const use = own ?? (slot === 'color' ? undefined : model.useOf(material, 'color'));
    const reason = !use
      ? 'its material has no texture'
      : parts.some((part) => !model.uvsOf(part, use.set))
        ? `it has no ${use.set}, the UVs of its texture`
        : slot === 'color' && parts.some((part) => model.isTinted(part))
          ? 'its vertices have colours'
          : undefined;
    if (reason !== undefined || !use) {
      for (const part of parts) refused.set({ part, material }, reason!);
      continue;
    }
    if (!numbers.has(use.texture)) numbers.set(use.texture, numbers.size);
    const factor = model.factorOf(material, slot);
    const isNew = own === undefined;
    const redIsNew = slot === 'orm' && !model.hasOcclusion(material);
    const key = JSON.stringify([numbers.get(use.texture), isNew, redIsNew, factor, use.wraps]);
    const sheet = sheets.get(key) ?? { slot, use, isNew, redIsNew, factor, users: [] };
    sheet.users.push(...parts.map((part) => ({ part, material })));
    sheets.set(key, sheet);
  }
  return [...sheets.values()];
}

/** Paints the texture of a sheet. @returns what was baked, or why not. */
async function bakeSheet<Material, Texture>(
  model: BakeModel<Material, Texture>,
  sheet: Sheet<Material, Texture>,
  paint: Image,
  input: BakeInput,
): Promise<Baked | string> {
  const { slot, use, factor } = sheet;
  const base = await baseOf(model, sheet, input);
  if (typeof base === 'string') return base;
  const layouts = sheetLayouts(model, sheet, input);
  const wrong = unusable(layouts, base.width * base.height);
  if (wrong) return wrong;
  const { width, height } = base;
  const baked = fill('bake', layouts, paint, { width, height, wrap: use.wraps, kind: kindOf[slot] });
  if (baked.overlap.lost > kMostLost) return 'most of its paint would lie in texels that others use';
  const image = layOver(base, baked, slot === 'normal' ? [1, 1, 1] : factor);
  model.replace([...new Set(sheet.users.map(({ material }) => material))], slot, await input.codec.encode(image), use);
  return baked;
}

/** The triangles on a sheet; those of a part that several materials lay on it in the same way only once. */
function sheetLayouts<Material, Texture>(
  model: BakeModel<Material, Texture>,
  { slot, users }: Sheet<Material, Texture>,
  input: BakeInput,
): Layout[] {
  const known = new Set<string>();
  return users.flatMap(({ part, material }) => {
    const use = model.useOf(material, slot) ?? model.useOf(material, 'color')!;
    const key = JSON.stringify([part.firstTriangle, use.set, use.transform]);
    if (known.has(key)) return [];
    known.add(key);
    return layoutsOf(model, [part], input, () => use);
  });
}

/** The image of a sheet, or what stands for it: a flat normal map, say. */
async function baseOf<Material, Texture>(
  model: BakeModel<Material, Texture>,
  { use, isNew, redIsNew, slot }: Sheet<Material, Texture>,
  { codec, size }: BakeInput,
): Promise<Image | string> {
  if (isNew) {
    const side = size ?? kNewSide;
    const color = slot === 'normal' ? [128, 128, 255, 255] : [255, 255, 255, 255];
    return {
      width: side,
      height: side,
      data: Uint8ClampedArray.from({ length: 4 * side * side }, (_, i) => color[i % 4]!),
    };
  }
  const file = await model.imageOf(use.texture);
  if (!file) return 'its texture has no image';
  let image: Image;
  try {
    image = await codec.decode(file.bytes, file.mimeType);
  } catch (error) {
    return `its ${kinds[slot]} texture (${file.mimeType}) cannot be read: ${error instanceof Error ? error.message : error}`;
  }
  if (redIsNew) image = { ...image, data: image.data.map((byte, i) => (i % 4 === 0 ? 255 : byte)) };
  if (size === undefined) return image;
  const scale = size / Math.max(image.width, image.height);
  return resize(image, Math.max(1, Math.round(scale * image.width)), Math.max(1, Math.round(scale * image.height)));
}

/** The triangles of parts, cut where the result is, in the UVs of a texture and in the cage's. */
export function layoutsOf<Material, Texture>(
  model: BakeModel<Material, Texture>,
  parts: readonly Piece[],
  { result, cut }: Pick<BakeInput, 'result' | 'cut'>,
  useOf: (part: Piece) => Pick<TextureUse<Texture>, 'set' | 'transform'>,
): Layout[] {
  return parts.map((part): Layout => {
    const { split, cosmetic, blends } = groupMember(part, result, cut);
    const { set, transform } = useOf(part);
    const stored = model.uvsOf(part, set)!;
    const bad = stored.findIndex((value) => !Number.isFinite(value));
    if (bad >= 0)
      throw new InputError(
        `"${part.name}": ${set} of vertex ${Math.floor(bad / 2)} has ${stored[bad]}, which is not a finite number`,
      );
    const uvs = transform ? transformUvs(stored, transform) : stored;
    const ofCorners = (values: Float32Array, size: number) => {
      const all = gather(blend(values, size, blends), size, split.sources);
      return gather(all, size, split.indices);
    };
    return {
      name: part.name,
      to: ofCorners(uvs, 2),
      from: gather(split.uvs, 2, split.indices),
      painted: cosmetic,
      positions: ofCorners(part.localPositions, 3),
    };
  });
}

/** Why UVs are not an unwrapping, if so. */
function unusable(layouts: readonly Layout[], texels: number): string | undefined {
  let [laid, flat, surface] = [0, 0, 0];
  for (const { to, painted, positions } of layouts) {
    painted.forEach((isPainted, t) => {
      const area = Math.abs(areaOf(to, 6 * t));
      laid += area;
      if (!isPainted) return;
      const own = surfaceOf(positions!, 9 * t);
      surface += own;
      if (area * texels < kFlat) flat += own;
    });
  }
  if (laid > kMostRepeats) return 'its texture is a pattern that repeats';
  return flat > kMostFlat * surface ? 'its texture is a palette: much of its surface has no area in it' : undefined;
}

/** Twice the area of a triangle in space. */
function surfaceOf(positions: ArrayLike<number>, at: number): number {
  const [a, b] = [3, 6].map((to) => [0, 1, 2].map((k) => positions[at + to + k]! - positions[at + k]!)) as number[][];
  const across = (i: number, j: number) => a![i]! * b![j]! - a![j]! * b![i]!;
  return Math.hypot(across(1, 2), across(2, 0), across(0, 1));
}

/** Checks paints. @throws {CagecastError} `badArgument` */
export function checkPaints(fn: string, paints: unknown): Paints {
  if (typeof paints !== 'object' || paints === null || !slots.some((slot) => (paints as Paints)[slot]))
    throw new CagecastError(
      'badArgument',
      `${fn}: paints has none of ${slots.join(', ')}; each is an image in the cage's UVs`,
    );
  return paints as Paints;
}
