import type { GLTF } from '@gltf-transform/core';
import type { Part } from '../../scene/extract.js';
import { glow, infoOf, Materials, type Place, type TextureUse } from '../../scene/materials.js';
import { shadeInfoOf, toonExtension, toonGamma, toonProperties } from '../../scene/toon.js';
import type { GlbWriter } from '../glb-writer.js';
import { imageType } from '../image-file.js';
import { type GltfFile, sourceExtensions, sourceOf } from '../open-gltf.js';
import type { BakeModel } from './plan.js';

const kToonShader = 'VRM/MToon';

/** A file whose materials are painted. What is painted goes to a writer of the file. */
export class FileModel extends Materials implements BakeModel {
  readonly #writer: GlbWriter;

  constructor(file: GltfFile, parts: readonly Part[], writer: GlbWriter) {
    super(file, parts, writer.json);
    this.#writer = writer;
  }

  replace(materials: readonly number[], slot: Place, bytes: Uint8Array, use: TextureUse, strength = 1): void {
    const [json, writer] = [this.json, this.#writer];
    const before = json.textures![use.texture]!;
    const isOwn = this.useOf(materials[0]!, slot) !== undefined;
    const name = before.name ?? json.images?.[sourceOf(before) ?? -1]?.name ?? 'painted';
    let number = writer.addTexture({ bytes, mimeType: imageType(bytes) ?? 'image/png', name });
    const made = json.textures![number]!;
    if (before.sampler !== undefined) made.sampler = before.sampler;
    if (isOwn && this.#isOnlyFor(use.texture, materials, slot)) {
      // In its place, so that extensions with materials of their own, such as those of avatars, show it, too.
      const image = json.images!.pop()!;
      json.textures!.pop();
      number = use.texture;
      const source = sourceOf(before)!;
      const isShared = json.textures!.some((other) => other !== before && sourceOf(other) === source);
      for (const extension of sourceExtensions) delete before.extensions?.[extension];
      if (before.extensions && Object.keys(before.extensions).length === 0) delete before.extensions;
      if (isShared) before.source = json.images!.push(image) - 1;
      else {
        const { name: own = name, extras } = json.images![source]!;
        json.images![source] = { ...image, name: own, ...(extras && { extras }) };
        before.source = source;
      }
      for (const extension of sourceExtensions)
        if (!json.textures!.some((texture) => texture.extensions?.[extension])) writer.unlistExtension(extension);
    }
    for (const material of materials) {
      if (isOwn && slot === 'color') this.#followInExtensions(material, use.texture, number);
      if (slot === 'shade') this.#layInShade(material, number);
      else lay(this.material(material), slot, number);
      resetFactors(this.material(material), slot);
      if (slot === 'normal') this.#setToon(material, '_BumpMap', number);
      if (slot === 'emissive') this.#glow(material, number, strength);
    }
  }

  /** Gives a toon material a texture for the shade. */
  #layInShade(number: number, texture: number): void {
    const toon = this.material(number).extensions?.[toonExtension] as { shadeMultiplyTexture?: object } | undefined;
    const own = shadeInfoOf(this.json, number) ?? this.material(number).pbrMetallicRoughness?.baseColorTexture;
    if (toon) toon.shadeMultiplyTexture = { ...own, index: texture };
    else this.#setToon(number, '_ShadeTexture', texture);
  }

  /** Makes a material glow as its texture says. */
  #glow(number: number, texture: number, strength: number): void {
    glow(this.json, this.material(number), strength);
    // What reads VRM 0 takes its colours for ones of a display.
    const stored = strength ** (1 / toonGamma);
    this.#setToon(number, '_EmissionMap', texture, { _EmissionColor: [stored, stored, stored, 1] });
  }

  /** Gives a toon material of VRM 0 a texture, and the colours that belong to it. */
  #setToon(number: number, name: string, texture: number, colors: Record<string, number[]> = {}): void {
    const properties = toonProperties(this.json, number);
    if (properties?.shader !== kToonShader) return;
    properties.textureProperties = { ...properties.textureProperties, [name]: texture };
    properties.vectorProperties = { ...properties.vectorProperties, ...colors };
    if (name === '_BumpMap') properties.keywordMap = { ...properties.keywordMap, _NORMALMAP: true };
  }

  /** Makes the materials of avatars, which name their textures once more, show a new one, too. */
  #followInExtensions(material: number, before: number, now: number): void {
    const { textureProperties: textures = {}, vectorProperties: colors } = toonProperties(this.json, material) ?? {};
    // The factor, once more: it is in the texture now.
    if (colors?.['_Color']) colors['_Color'] = [1, 1, 1, colors['_Color'][3] ?? 1];
    for (const [name, texture] of Object.entries(textures)) if (texture === before) textures[name] = now;
    const mtoon = this.material(material).extensions?.[toonExtension] as
      | { shadeMultiplyTexture?: GLTF.ITextureInfo }
      | undefined;
    if (mtoon?.shadeMultiplyTexture?.index === before) mtoon.shadeMultiplyTexture.index = now;
  }

  /** Whether toon materials use a texture in the shade of some materials alone. */
  #isOnlyInShade(texture: number, materials: readonly number[]): boolean {
    return (this.json.materials ?? []).every(({ extensions }, m) => {
      const toon = Object.entries(
        (extensions?.[toonExtension] ?? {}) as Record<string, { index?: number } | undefined>,
      );
      const old = Object.entries(toonProperties(this.json, m)?.textureProperties ?? {});
      const uses = [
        ...toon.flatMap(([name, info]) => (info?.index === texture ? name : [])),
        ...old.flatMap(([name, index]) => (index === texture ? name : [])),
      ];
      return uses.every((name) => materials.includes(m) && /^(shadeMultiplyTexture|_ShadeTexture)$/.test(name));
    });
  }

  /** Whether the standard materials and their extensions, which add to them, use a texture in no other way. */
  #isOnlyFor(texture: number, materials: readonly number[], slot: Place): boolean {
    if (slot === 'shade' && !this.#isOnlyInShade(texture, materials)) return false;
    return (this.json.materials ?? []).every((material, m) => {
      const { pbrMetallicRoughness: pbr, normalTexture, occlusionTexture, emissiveTexture } = material;
      const uses: [GLTF.ITextureInfo | undefined, Place | undefined][] = [
        [pbr?.baseColorTexture, 'color'],
        [pbr?.metallicRoughnessTexture, 'orm'],
        [occlusionTexture, 'orm'],
        [normalTexture, 'normal'],
        [emissiveTexture, 'emissive'],
        ...addedTextures(material).map((info) => [info, undefined] as [GLTF.ITextureInfo, undefined]),
      ];
      return uses.every(([info, used]) => info?.index !== texture || (used === slot && materials.includes(m)));
    });
  }
}

/** The textures of extensions that add to a material, such as KHR_materials_transmission; not of the one that replaces it. */
function addedTextures({ extensions }: GLTF.IMaterial): GLTF.ITextureInfo[] {
  return Object.entries(extensions ?? {})
    .filter(([name]) => /^KHR_materials_(?!pbrSpecularGlossiness)/.test(name))
    .flatMap(([, added]) => Object.values((added ?? {}) as object))
    .filter((value) => Number.isInteger(value?.index));
}

/** Gives a material a texture. A new one lies as that of the base colour does. */
function lay(material: GLTF.IMaterial, slot: Exclude<Place, 'shade'>, index: number): void {
  const pbr = (material.pbrMetallicRoughness ??= {});
  const info = { ...(infoOf(material, slot) ?? pbr.baseColorTexture), index };
  if (slot === 'color') pbr.baseColorTexture = info;
  else if (slot === 'normal') material.normalTexture = info;
  else if (slot === 'emissive') material.emissiveTexture = info;
  else {
    const { occlusionTexture } = material;
    if (!occlusionTexture || occlusionTexture.index === pbr.metallicRoughnessTexture?.index)
      material.occlusionTexture = { ...occlusionTexture, ...info };
    pbr.metallicRoughnessTexture = info;
  }
}

/** The factors are in the texture now. */
function resetFactors({ pbrMetallicRoughness: pbr }: GLTF.IMaterial, slot: Place): void {
  if (slot === 'orm' && pbr) {
    delete pbr.roughnessFactor;
    delete pbr.metallicFactor;
    return;
  }
  if (slot !== 'color' || !pbr) return;
  const alpha = pbr.baseColorFactor?.[3] ?? 1;
  if (alpha === 1) delete pbr.baseColorFactor;
  else pbr.baseColorFactor = [1, 1, 1, alpha];
}
