import type { GLTF } from '@gltf-transform/core';
import type { IsFree } from '../bake/alpha.js';
import { InputError } from '../scene/input-error.js';
import { emissiveExtension, unlitExtension } from '../scene/materials.js';
import { uvLayoutOf } from '../scene/uv-layout.js';
import { imageIsWhole, imageType, ktx2Problem } from './image-file.js';

/** The attribute with the `Zone` of each vertex, a byte: 0 may be painted, other values are Non-Cosmetic Zones. */
export const zoneAttribute = '_NCZ';

/** Marks the UVs of a transfer in the `extras` of their accessor, so that the next one can replace them. */
export const uvsMark = { cagecastUvs: true } as const;

/** Whether an attribute, whose accessor has these extras, was added by a transfer. */
export const isOfTransfer = (semantic: string, extras: object | undefined): boolean =>
  /^_NCZ(_\d+)?$/.test(semantic) || (extras as Partial<typeof uvsMark> | undefined)?.cagecastUvs === true;

/** What textures and materials are added to. */
export interface TextureWriter {
  readonly json: GLTF.IGLTF;
  /** @returns the number of the texture. */
  addTexture(image: { bytes: Uint8Array; mimeType: string; name: string }): number;
}

/** A look on materials whose own textures cannot hold it. */
export interface OverlaidLook {
  /**
   * Adds a copy of a material as the surface has it beneath the colours.
   * @param texCoord  The number of the cage's UVs.
   * @returns its number, and whether the surface shows the colours, too, or a relief.
   */
  addSurface(
    writer: TextureWriter,
    material: number | undefined,
    texCoord: number,
  ): { number: number; hasColors: boolean; hasRelief: boolean };
  /** Gives the overlay on a material the same but the colours. */
  lay(writer: TextureWriter, overlay: GLTF.IMaterial, material: number | undefined): void;
}

/** The texture to show: an image file's bytes, in the cage's UVs. */
export interface Paint {
  name: string;
  mimeType: string;
  bytes: Uint8Array;
  /** By default, all triangles show it. */
  area?: PaintArea | undefined;
  /**
   * Whether it hides all of a triangle, whose place the overlay then takes: it is drawn as the surface itself, before what is transparent.
   * Default: all of the overlay is blended
   */
  hides?: IsFree | undefined;
  /** What else there is of a look: it lies on a copy of the surface, in whose place that comes. Default: colours alone */
  look?: OverlaidLook | undefined;
}

/**
 * Which triangles show a texture: those whose UVs have their centre in a tile of UDIM; or those whose UVs reach into 0..1, outside of
 * which the texture is not repeated.
 */
export type PaintArea = { tile: number } | 'bounded';

const imageNames: Record<string, string> = {
  'image/png': 'PNG',
  'image/jpeg': 'JPEG',
  'image/webp': 'WebP',
  'image/ktx2': 'KTX2',
};

/**
 * Checks an image and finds its type.
 * @param types  Those that can be used.
 * @throws {InputError} if it is not a whole file of one of these types.
 */
export function paintOf(
  bytes: Uint8Array,
  name = 'paint',
  types: readonly string[] = ['image/png', 'image/jpeg'],
): Paint {
  const mimeType = imageType(bytes);
  if (mimeType === undefined || !types.includes(mimeType)) {
    const [last, ...others] = types.map((type) => imageNames[type]).reverse();
    throw new InputError(
      others.length === 1
        ? `is neither a ${others[0]} nor a ${last} image`
        : `is not a ${others.reverse().join(', ')} or ${last} image`,
    );
  }
  if (!imageIsWhole(bytes)) throw new InputError(`is truncated: the ${imageNames[mimeType]} image is incomplete`);
  const problem = mimeType === 'image/ktx2' ? ktx2Problem(bytes) : undefined;
  if (problem !== undefined) throw new InputError(`is a KTX2 image that glTF cannot hold: ${problem}`);
  return { name, mimeType, bytes };
}

/** The first free UV set, as the numbers of sets must not have gaps. */
export function freeUvSet(has: (semantic: string) => boolean): string {
  let set = 0;
  while (has(`TEXCOORD_${set}`)) ++set;
  return `TEXCOORD_${set}`;
}

/** The tile of UDIM at a UV: 1001 at 0..1, 1002 to its right, 1011 above. In glTF, v grows downwards. */
export const tileAt = (u: number, v: number): number => 1001 + Math.floor(u) + 10 * Math.floor(1 - v);

/** Whether a triangle shows a texture. @param uvs  2 per vertex. */
export function isShown(area: PaintArea | undefined, uvs: Float32Array, a: number, b: number, c: number): boolean {
  if (area === undefined) return true;
  const [u, v] = [0, 1].map((k) => [uvs[2 * a + k]!, uvs[2 * b + k]!, uvs[2 * c + k]!]) as [number[], number[]];
  if (area === 'bounded') return [u, v].every((of) => Math.max(...of) > 0 && Math.min(...of) < 1);
  return tileAt((u[0]! + u[1]! + u[2]!) / 3, (v[0]! + v[1]! + v[2]!) / 3) === area.tile;
}

/** The corners of those triangles that may be painted; `cosmetic` is 1 per triangle. */
export function cosmeticCorners(indices: Uint32Array, cosmetic: Uint8Array): Uint32Array {
  return indices.filter((_, corner) => cosmetic[Math.floor(corner / 3)] === 1);
}

/**
 * Whether an overlay has an attribute of its base: positions, and those for lighting and deformation. Not colours, which would tint
 * the texture. Tangents are for normal maps only, and have to be named besides.
 *
 * Positions are the very same, so that the overlay has the depth of the surface, bit for bit, and is drawn on it from any distance.
 * Moved off the surface, it would show holes where it is nearer to it than the depth buffer can tell.
 */
export const isOverlaid = (semantic: string): boolean =>
  semantic === 'POSITION' || semantic === 'NORMAL' || /^(JOINTS|WEIGHTS)_\d+$/.test(semantic);

/** Whether an overlay has the deltas of an attribute from the morph targets of its base: of positions, and of normals if it has these. */
export const isMorphed = (semantic: string, hasNormals: boolean): boolean =>
  semantic === 'POSITION' || (semantic === 'NORMAL' && hasNormals);

/** What an overlay's material has of the material below. */
export interface Finish {
  mode: 'OPAQUE' | 'BLEND';
  /** Whether it is in the place of the surface. */
  inPlace: boolean;
  roughness: number;
  metalness: number;
  doubleSided: boolean;
  /** Its opacity, if it is transparent. */
  alpha: number;
  unlit: boolean;
}

/** The maps that light a material, its own light, and by which UV sets of its base they lie on an overlay: its own sets from `TEXCOORD_1` on. */
export interface BaseMaps {
  maps: Pick<
    GLTF.IMaterial,
    'normalTexture' | 'occlusionTexture' | 'emissiveTexture' | 'emissiveFactor' | 'extensions'
  >;
  rough: Pick<GLTF.IMaterialPbrMetallicRoughness, 'metallicRoughnessTexture'>;
  sets: string[];
}

/** The maps of a material with which its overlay is lit, so that pores and scales stay. @param has  Whether the base has an attribute. */
export function baseMaps(material: GLTF.IMaterial | undefined, has: (semantic: string) => boolean): BaseMaps {
  const sets: string[] = [];
  const on = <Info extends GLTF.ITextureInfo>(info: Info | undefined): Info | undefined => {
    if (!info || material?.extensions?.[unlitExtension]) return undefined;
    const { set } = uvLayoutOf(info);
    if (!has(set)) return undefined;
    if (!sets.includes(set)) sets.push(set);
    const own = structuredClone({ ...info, texCoord: 1 + sets.indexOf(set) });
    delete (own.extensions?.['KHR_texture_transform'] as { texCoord?: number } | undefined)?.texCoord;
    return own;
  };
  const [normalTexture, occlusionTexture] = [on(material?.normalTexture), on(material?.occlusionTexture)];
  const metallicRoughnessTexture = on(material?.pbrMetallicRoughness?.metallicRoughnessTexture);
  return {
    maps: {
      ...(normalTexture && { normalTexture }),
      ...(occlusionTexture && { occlusionTexture }),
      ...glowOf(material, on),
    },
    rough: metallicRoughnessTexture ? { metallicRoughnessTexture } : {},
    sets,
  };
}

/** The light that a material has of its own, which paint does not hide. */
function glowOf(
  { emissiveFactor, emissiveTexture, extensions }: GLTF.IMaterial = {},
  on: (info: GLTF.ITextureInfo | undefined) => GLTF.ITextureInfo | undefined,
): Pick<BaseMaps['maps'], 'emissiveFactor' | 'emissiveTexture' | 'extensions'> {
  if (!emissiveFactor?.some((one) => one > 0) || extensions?.[unlitExtension] !== undefined) return {};
  const texture = on(emissiveTexture);
  if (emissiveTexture && !texture) return {};
  const strength = extensions?.[emissiveExtension];
  return {
    emissiveFactor,
    ...(texture && { emissiveTexture: texture }),
    ...(strength !== undefined && { extensions: { [emissiveExtension]: strength } }),
  };
}

/** The metalness of a base, for its overlay; none where the material is of another model, which has no such factor. */
export const metalnessOf = (factor: number | undefined, extensions: readonly string[]): number =>
  extensions.some((name) => /^(KHR_materials_pbrSpecularGlossiness|VRMC_materials_mtoon)$/.test(name))
    ? 0
    : (factor ?? 1);
