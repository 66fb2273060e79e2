import type { GLTF } from '@gltf-transform/core';
import type { Image } from '../../bake/index.js';
import { grouped } from '../../inspect/geometry.js';
import { decodeFloats } from '../../scene/accessor.js';
import { firstLine, InputError } from '../../scene/input-error.js';
import { type ImageCodec, Materials, type Slot, slots } from '../../scene/materials.js';
import { isMarked } from '../../scene/overlay-mark.js';
import { layUvs, uvLayoutOf } from '../../scene/uv-layout.js';
import { GlbWriter } from '../glb-writer.js';
import { imageType } from '../image-file.js';
import type { GltfFile } from '../open-gltf.js';
import { sourceExtensions } from '../open-gltf.js';
import { storedUvs } from '../primitive-group.js';
import { drop, eachImage, eachMaterial, eachTexture, materialBinds, numbersOf } from '../references.js';
import { flat, type Place, placed, put, tinted } from './atlas-image.js';

/** What became of the materials of a file. */
export interface AtlasReport {
  /** Materials with shared textures, by name; merged ones together. */
  packed: string[][];
  /** The textures that they share. */
  textures: { slot: Slot; size: number; mimeType: string }[];
  /** The materials that keep their own textures, and why. */
  left: { material: string; reason: string }[];
}

/** A material whose textures can be packed. */
interface Packed {
  number: number;
  material: GLTF.IMaterial;
  /** The UV set that its textures lie by. */
  set: string;
  /** The primitives that it is on, and where they are in its textures. */
  uses: { primitive: GLTF.IMeshPrimitive; uvs: Float32Array }[];
  /** Decoded, and their media types. */
  images: Partial<Record<Slot, Image & { mimeType: string }>>;
}

/** Extensions of files whose materials and textures can be numbered anew. */
const kKnown =
  /^(KHR_(materials_(?!variants)|texture_|mesh_quantization|meshopt|lights|node)|VRMC_|EXT_(texture_|mesh))/;
const kTransform = 'KHR_texture_transform';
/** UVs may be so far outside of a texture, by rounding. */
const kRounding = 1e-3;
/** What a slot holds where a material has no texture in it. */
const kPlain = { color: [255, 255, 255, 255], normal: [128, 128, 255, 255], orm: [255, 255, 255, 255] };

/**
 * Packs the textures of a file's materials into one for colours, one for normals, and one for occlusion, roughness and metalness. UVs are
 * laid anew, and materials that only differ by textures and factors become one.
 * @param side  Of the new textures. Default: a power of two, 4096 at most, in which all keep their size or most of it.
 * @returns the bytes of a GLB; none if there is nothing to pack.
 * @throws {InputError} if `side` has no room.
 */
export async function packTextures(
  file: GltfFile,
  codec: ImageCodec,
  side?: number,
): Promise<{ bytes: Uint8Array | undefined; report: AtlasReport }> {
  const report: AtlasReport = { packed: [], textures: [], left: [] };
  const model = new Materials(file, []);
  const unknown = file.json.extensionsUsed?.find((name) => !kKnown.test(name));
  if (unknown) {
    const left = (_: unknown, m: number) => ({ material: model.nameOf(m), reason: `${unknown} may refer to it` });
    return { bytes: undefined, report: { ...report, left: (file.json.materials ?? []).map(left) } };
  }
  const writer = await GlbWriter.from(file, 'keep');
  const { json } = writer;
  const all: Packed[] = [];
  for (const number of new Set(
    (json.meshes ?? []).flatMap(({ primitives }) => primitives.map((one) => one.material)),
  )) {
    const found = number === undefined ? undefined : await packable(file, json, number, codec);
    if (typeof found === 'object') all.push(found);
    else if (found) report.left.push({ material: model.nameOf(number!), reason: found });
  }
  if (all.length < 2) return { bytes: undefined, report };
  const sizes = all.map(({ images }) => [images.color!.width, images.color!.height] as const);
  const room = placed(sizes, side);
  if (!room) throw new InputError(`${side} texels have no room for ${all.length} textures`);
  const made = await drawAtlases(writer, all, room, codec);
  for (const [slot, { mimeType }] of made) report.textures.push({ slot, size: room.side, mimeType });
  for (const [p, { set, uses }] of all.entries())
    for (const { primitive, uvs } of uses) primitive.attributes[set] = relaid(writer, uvs, room.places[p]!, room.side);
  const gone = new Set<number>();
  for (const members of grouped(all, (one) => lookOf(one, made.has('orm')))) {
    const [{ number }, ...others] = members;
    report.packed.push(members.map((one) => model.nameOf(one.number)));
    json.materials![number] = materialWith(members[0], made, others.length > 0);
    for (const { uses } of members) for (const { primitive } of uses) primitive.material = number;
    for (const other of others) gone.add(other.number);
  }
  drop<unknown>(
    json.materials!,
    (m) => gone.has(m),
    (visit) => eachMaterial(json, visit),
    0,
  );
  for (const [name, each] of [
    ['textures', eachTexture],
    ['images', eachImage],
  ] as const) {
    const [before, now] = [numbersOf(each, file.json), numbersOf(each, json)];
    drop<unknown>(
      json[name]!,
      (n) => before.has(n) && !now.has(n),
      (visit) => each(json, visit),
      0,
    );
  }
  const left = JSON.stringify([json.materials, json.textures]);
  for (const name of [kTransform, ...sourceExtensions]) if (!left.includes(name)) writer.unlistExtension(name);
  return { bytes: writer.finish(), report };
}

/** What of a material is not in its textures. @param hasOrm  Whether roughness and metalness are. */
function lookOf({ material, set }: Packed, hasOrm: boolean): string {
  const { name: _, pbrMetallicRoughness: pbr, normalTexture, occlusionTexture, ...others } = material;
  const { baseColorFactor, roughnessFactor = 1, metallicFactor = 1 } = pbr!;
  const own = [baseColorFactor?.[3] ?? 1, normalTexture?.scale ?? 1, occlusionTexture?.strength ?? 1];
  return JSON.stringify([others, own, set, hasOrm || [roughnessFactor, metallicFactor]]);
}

/** A material whose textures can be packed; or why they cannot be. */
async function packable(file: GltfFile, json: GLTF.IGLTF, number: number, codec: ImageCodec): Promise<Packed | string> {
  const material = json.materials![number]!;
  const reason = whyNot(material);
  if (reason !== undefined) return reason;
  if (materialBinds(json).some((bind) => bind['material'] === number)) return 'an expression of the avatar changes it';
  const { set, transform } = uvLayoutOf(material.pbrMetallicRoughness!.baseColorTexture);
  const uses: Packed['uses'] = [];
  for (const primitive of json.meshes!.flatMap(({ primitives }) => primitives)) {
    if (primitive.material !== number) continue;
    const accessor = file.accessors[primitive.attributes[set] ?? -1];
    if (accessor?.getElementSize() !== 2) return `it has no ${set}, the UVs of its texture`;
    const uvs = layUvs(decodeFloats(accessor), transform);
    const isOutside = (x: number) => !(x >= -kRounding && x <= 1 + kRounding);
    const shown =
      file.accessors[primitive.indices ?? -1]?.getArray() ?? Uint32Array.from({ length: uvs.length / 2 }, (_, v) => v);
    if (shown.some((v) => isOutside(uvs[2 * v]!) || isOutside(uvs[2 * v + 1]!)))
      return 'its UVs lie outside of 0..1, where its texture repeats';
    uses.push({ primitive, uvs });
  }
  const images: Packed['images'] = {};
  const model = new Materials(file, []);
  for (const slot of slots) {
    const use = model.useOf(number, slot);
    if (!use) continue;
    const found = await file.imageOf(use.texture);
    if (!found) return 'its texture has no image';
    try {
      const image = await codec.decode(found.bytes, found.mimeType);
      const shown = slot === 'orm' && !material.occlusionTexture ? withoutOcclusion(image) : image;
      images[slot] = { ...tinted(shown, model.factorOf(number, slot), slot === 'color'), mimeType: found.mimeType };
    } catch (error) {
      return `its texture ${firstLine(error)}`;
    }
  }
  return { number, material, set, uses, images };
}

/** An ORM image with its unused red set to no occlusion. */
const withoutOcclusion = (image: Image): Image => ({
  ...image,
  data: image.data.map((byte, i) => (i % 4 === 0 ? 255 : byte)),
});

/** What of a material keeps its textures from being packed, if anything does. */
function whyNot(material: GLTF.IMaterial): string | undefined {
  const { pbrMetallicRoughness: pbr, normalTexture, occlusionTexture, emissiveTexture, extensions, extras } = material;
  // Others hold textures, or say what more there is to do with the material's own.
  const isPlain = ([name, value]: [string, unknown]) =>
    /^KHR_materials_/.test(name) && numbersOf(eachTexture, { materials: [value] } as GLTF.IGLTF).size === 0;
  const other = Object.entries(extensions ?? {}).find((one) => !isPlain(one))?.[0];
  const rough = pbr?.metallicRoughnessTexture;
  const layouts = [pbr?.baseColorTexture, normalTexture, rough, occlusionTexture]
    .filter((info) => info !== undefined)
    .map((info) => JSON.stringify(uvLayoutOf(info)));
  if (isMarked(extras)) return 'it is an overlay of paint';
  if (!pbr?.baseColorTexture) return 'it has no texture';
  if (other !== undefined) return `it has ${other}`;
  if (emissiveTexture) return 'it has a texture that glows';
  if (occlusionTexture && occlusionTexture.index !== rough?.index) return 'its occlusion has a texture of its own';
  return new Set(layouts).size > 1 ? 'its textures lie in different ways' : undefined;
}

/** Textures that were added, by their slots. */
type Atlases = Map<Slot, { number: number; mimeType: string }>;

/** Draws and adds a texture for each slot that some material has. */
async function drawAtlases(
  writer: GlbWriter,
  all: readonly Packed[],
  { side, places }: { side: number; places: readonly Place[] },
  codec: ImageCodec,
): Promise<Atlases> {
  const made: Atlases = new Map();
  for (const slot of slots) {
    const own = all.flatMap(({ images }) => images[slot] ?? []);
    if (own.length === 0) continue;
    const atlas = { width: side, height: side, data: new Uint8ClampedArray(4 * side * side) };
    for (let i = 0; i < atlas.data.length; i += 4) atlas.data.set(kPlain[slot], i);
    for (const [p, { images, material }] of all.entries()) {
      const { roughnessFactor = 1, metallicFactor = 1 } = material.pbrMetallicRoughness!;
      const factor = slot === 'orm' ? [1, roughnessFactor, metallicFactor] : [1, 1, 1];
      put(atlas, images[slot] ?? tinted(flat(kPlain[slot]), factor, false), places[p]!);
    }
    const before = own.every(({ mimeType }) => mimeType === own[0]!.mimeType) ? own[0]!.mimeType : undefined;
    const bytes = await codec.encode(atlas, before);
    const mimeType = imageType(bytes) ?? 'image/png';
    made.set(slot, { number: writer.addTexture({ bytes, mimeType, name: `atlas ${slot}` }, true), mimeType });
  }
  return made;
}

/** Lays UVs into the place of their texture. @returns the number of their accessor. */
function relaid(writer: GlbWriter, uvs: Float32Array, place: Place, side: number): number {
  const [start, size] = [[place.x, place.y] as const, [place.width, place.height] as const];
  const laid = uvs.map((x, i) => (start[i % 2]! + size[i % 2]! * Math.min(1, Math.max(0, x))) / side);
  return writer.addAttribute(storedUvs(laid), 2, { normalized: true });
}

/** A material with packed textures. */
function materialWith({ material, set }: Packed, made: Atlases, isJoined: boolean): GLTF.IMaterial {
  const texCoord = Number(set.slice('TEXCOORD_'.length));
  const info = (slot: Slot) => ({ index: made.get(slot)!.number, ...(texCoord > 0 && { texCoord }) });
  const { baseColorFactor: [, , , alpha = 1] = [], ...pbr } = material.pbrMetallicRoughness!;
  const now: GLTF.IMaterial = {
    ...material,
    ...(isJoined && { name: 'atlas' }),
    pbrMetallicRoughness: {
      ...pbr,
      ...(alpha !== 1 && { baseColorFactor: [1, 1, 1, alpha] }),
      baseColorTexture: info('color'),
    },
  };
  if (made.has('normal')) now.normalTexture = { ...info('normal'), scale: material.normalTexture?.scale ?? 1 };
  if (!made.has('orm')) return now;
  now.occlusionTexture = { ...info('orm'), strength: material.occlusionTexture?.strength ?? 1 };
  Object.assign(now.pbrMetallicRoughness!, {
    metallicRoughnessTexture: info('orm'),
    roughnessFactor: 1,
    metallicFactor: 1,
  });
  return now;
}
