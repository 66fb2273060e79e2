import type { GLTF } from '@gltf-transform/core';
import type { Image, Wrap } from '../bake/index.js';
import { type AccessorData, decodeFloats } from './accessor.js';
import type { Part } from './extract.js';
import { movedBy } from './moved-uvs.js';
import type { SceneSource } from './source.js';
import { shadeFactorOf, shadeInfoOf, toonExtension, toonProperties } from './toon.js';
import { type UvLayout, uvLayoutOf } from './uv-layout.js';

/** What of a material a paint goes to: its base colour, its normals, or occlusion, roughness and metalness. */
export const slots = ['color', 'normal', 'orm'] as const;
export type Slot = (typeof slots)[number];
/** All that paint changes of a material: its own light, and what MToon of avatars shows in the shade, too. */
export type Place = Slot | 'emissive' | 'shade';

/** How a texture is used by a material. */
export interface TextureUse extends UvLayout {
  texture: number;
  wraps: readonly [Wrap, Wrap];
}

/** Reads and writes image files. */
export interface ImageCodec {
  /** @throws {Error} if it cannot read such a file; the parts with this texture are not baked then. */
  decode: (bytes: Uint8Array, mimeType: string) => Promise<Image>;
  /** @param mimeType  Of the replaced image; undefined for a new one. The result may have any type of glTF. */
  encode: (image: Image, mimeType?: string) => Promise<Uint8Array>;
}

/** A wrap mode by its number in glTF. */
const wrapOf = (wrap?: number): Wrap => (wrap === 33071 ? 'clamp' : wrap === 33648 ? 'mirror' : 'repeat');

/** A factor below stands for darkness, as none can be divided by. */
const kDarkest = 1e-3;
/** The extension of glTF for materials without light and shade. */
export const unlitExtension = 'KHR_materials_unlit';
/** The extension of glTF for materials that glow more than the screen's white. */
export const emissiveExtension = 'KHR_materials_emissive_strength';

/** Makes a material glow as its texture says, times a strength. */
export function glow(json: GLTF.IGLTF, material: GLTF.IMaterial, strength: number): void {
  material.emissiveFactor = [1, 1, 1];
  const { [emissiveExtension]: _, ...others } = material.extensions ?? {};
  material.extensions = { ...others, ...(strength !== 1 && { [emissiveExtension]: { emissiveStrength: strength } }) };
  if (Object.keys(material.extensions).length === 0) delete material.extensions;
  if (strength !== 1 && !json.extensionsUsed?.includes(emissiveExtension))
    (json.extensionsUsed ??= []).push(emissiveExtension);
}

/** The texture of a material in a slot. */
export function infoOf(material: GLTF.IMaterial, slot: Exclude<Place, 'shade'>): GLTF.ITextureInfo | undefined {
  if (slot === 'color') return material.pbrMetallicRoughness?.baseColorTexture;
  if (slot === 'emissive') return material.emissiveTexture;
  return slot === 'normal' ? material.normalTexture : material.pbrMetallicRoughness?.metallicRoughnessTexture;
}

/** The materials of a scene, and the parts that they are on. Materials and textures are their numbers. */
export class Materials {
  readonly source: SceneSource;
  readonly parts: readonly Part[];
  /** Of the materials. */
  protected readonly json: GLTF.IGLTF;

  /** @param json  Of the materials, if they are not those of the source. */
  constructor(source: SceneSource, parts: readonly Part[], json = source.json) {
    this.source = source;
    this.parts = parts;
    this.json = json;
  }

  #primitive({ mesh, primitive }: Part): GLTF.IMeshPrimitive {
    return this.source.json.meshes![mesh]!.primitives[primitive]!;
  }

  protected material(number: number): GLTF.IMaterial {
    return this.json.materials![number]!;
  }

  materialOf(part: Part): number | undefined {
    const { material } = this.#primitive(part);
    return material !== undefined && this.json.materials?.[material] ? material : undefined;
  }

  /** The materials that variants give a part instead of its own. */
  variantsOf(part: Part): number[] {
    const { mappings = [] } = (this.#primitive(part).extensions?.['KHR_materials_variants'] ?? {}) as {
      mappings?: { material: number }[];
    };
    return mappings.map(({ material }) => material).filter((material) => this.json.materials?.[material]);
  }

  nameOf(material: number): string {
    return this.material(material).name ?? `materials[${material}]`;
  }

  attributeOf(part: Part, semantic: string): AccessorData | undefined {
    return this.source.accessors[this.#primitive(part).attributes[semantic] ?? -1];
  }

  useOf(material: number, slot: Place): TextureUse | undefined {
    const info = slot === 'shade' ? shadeInfoOf(this.json, material) : infoOf(this.material(material), slot);
    if (!info || !this.json.textures?.[info.index]) return undefined;
    return { texture: info.index, ...uvLayoutOf(info), wraps: this.wrapsOf(info.index) };
  }

  /** How a texture goes on beyond its border. */
  wrapsOf(texture: number): [Wrap, Wrap] {
    const { wrapS, wrapT } = this.json.samplers?.[this.json.textures![texture]!.sampler ?? -1] ?? {};
    return [wrapOf(wrapS), wrapOf(wrapT)];
  }

  /** By what the values of the texture are multiplied; for the shade, paint that it shows, so that there it is as much darker as the material's own two colours differ. */
  factorOf(material: number, slot: Place): [number, number, number] {
    if (slot === 'shade') {
      const [lit, shade] = [this.factorOf(material, 'color'), shadeFactorOf(this.json, material)];
      return lit.map((share, k) => 1 / Math.max(share, shade[k]!, kDarkest)) as [number, number, number];
    }
    if (slot === 'emissive') {
      const { emissiveFactor = [0, 0, 0], extensions } = this.material(material);
      const { emissiveStrength = 1 } = (extensions?.[emissiveExtension] ?? {}) as { emissiveStrength?: number };
      return emissiveFactor.map((share) => share * emissiveStrength) as [number, number, number];
    }
    const {
      baseColorFactor = [1, 1, 1],
      roughnessFactor = 1,
      metallicFactor = 1,
    } = this.material(material).pbrMetallicRoughness ?? {};
    if (slot === 'normal') return [1, 1, 1];
    if (slot === 'orm') return [1, roughnessFactor, metallicFactor];
    return [baseColorFactor[0]!, baseColorFactor[1]!, baseColorFactor[2]!];
  }

  /** By what the relief of its normal map is multiplied. */
  reliefOf(material: number): number {
    return this.material(material).normalTexture?.scale ?? 1;
  }

  /** What moves its textures while they are shown. */
  movedBy(material: number): string[] {
    return movedBy(this.json, material);
  }

  /** How a material is lit: as glTF says, as MToon of avatars does, or not at all. */
  lightingOf(number: number): 'standard' | 'toon' | 'none' {
    const { extensions } = this.material(number);
    const shader = toonProperties(this.json, number)?.shader ?? '';
    if (extensions?.[toonExtension] || shader === 'VRM/MToon') return 'toon';
    return extensions?.[unlitExtension] || shader.startsWith('VRM/Unlit') ? 'none' : 'standard';
  }

  /** Whether the alpha of its base colour does not count. */
  isOpaque(material: number): boolean {
    return (this.material(material).alphaMode ?? 'OPAQUE') === 'OPAQUE';
  }

  /** Whether a texture shows occlusion: the metallic-roughness one, or one of its own. */
  hasOcclusion(material: number): boolean {
    return this.material(material).occlusionTexture !== undefined;
  }

  /** The UVs of a part in a set, if it has one that is complete. */
  uvsOf(part: Part, set: string): Float32Array | undefined {
    const accessor = this.attributeOf(part, set);
    return accessor?.getElementSize() === 2 && accessor.getCount() === part.vertexCount
      ? decodeFloats(accessor)
      : undefined;
  }

  /** The colours of a part by an attribute, and how many numbers each has. */
  colorsOf(part: Part, semantic: string): { values: Float32Array; size: number } | undefined {
    const accessor = this.attributeOf(part, semantic);
    return accessor && { values: decodeFloats(accessor), size: accessor.getElementSize() };
  }

  /** How the texture of its base colour lies on a part, if it has one. */
  colorUseOf(part: Part): TextureUse | undefined {
    const material = this.materialOf(part);
    return material === undefined ? undefined : this.useOf(material, 'color');
  }
}
