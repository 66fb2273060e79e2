import type { Accessor, Document, ExtensionProperty, Material, Texture, TextureInfo } from '@gltf-transform/core';
import { type BakeModel, type Paints, type TextureUse, wrapOf } from '../bake/plan.js';
import { imageType } from '../image-file.js';
import { type DocumentPart, uvLayoutOf } from './extract-document.js';

/** The extension of glTF-Transform, which is no dependency. */
interface MaterialMappings extends ExtensionProperty {
  listMappings(): { getMaterial(): Material | null }[];
}

/** A document as baking sees it. */
export class DocumentModel implements BakeModel<Material, Texture> {
  readonly #document: Document;
  readonly parts: readonly DocumentPart[];

  constructor(document: Document, parts: readonly DocumentPart[]) {
    this.#document = document;
    this.parts = parts;
  }

  materialOf(part: DocumentPart): Material | undefined {
    return part.primitive.getMaterial() ?? undefined;
  }

  variantsOf({ primitive }: DocumentPart): Material[] {
    const mappings = primitive.getExtension('KHR_materials_variants') as MaterialMappings | null;
    return mappings?.listMappings().flatMap((mapping) => mapping.getMaterial() ?? []) ?? [];
  }

  nameOf(material: Material): string {
    return material.getName();
  }

  attributeOf({ primitive }: DocumentPart, semantic: string): Accessor | undefined {
    return primitive.getAttribute(semantic) ?? undefined;
  }

  useOf(material: Material, slot: keyof Paints): TextureUse<Texture> | undefined {
    const [texture, info] = textureIn(material, slot);
    if (!texture || !info) return undefined;
    return { texture, ...uvLayoutOf(info), wraps: [wrapOf(info.getWrapS()), wrapOf(info.getWrapT())] };
  }

  factorOf(material: Material, slot: keyof Paints): [number, number, number] {
    if (slot === 'normal') return [1, 1, 1];
    if (slot === 'orm') return [1, material.getRoughnessFactor(), material.getMetallicFactor()];
    const [r, g, b] = material.getBaseColorFactor();
    return [r, g, b];
  }

  isOpaque(material: Material): boolean {
    return material.getAlphaMode() === 'OPAQUE';
  }

  hasOcclusion(material: Material): boolean {
    return material.getOcclusionTexture() !== null;
  }

  async imageOf(texture: Texture): Promise<{ bytes: Uint8Array; mimeType: string } | undefined> {
    const bytes = texture.getImage();
    return bytes ? { bytes, mimeType: texture.getMimeType() } : undefined;
  }

  replace(materials: readonly Material[], slot: keyof Paints, png: Uint8Array, use: TextureUse<Texture>): void {
    const painted = this.#document
      .createTexture(use.texture.getName())
      .setMimeType(imageType(png) ?? 'image/png')
      .setImage(png as Uint8Array<ArrayBuffer>);
    for (const material of materials) setTexture(material, slot, painted);
    const { texture } = use;
    if (texture.listParents().every((parent) => parent.propertyType === 'Root')) texture.dispose();
  }
}

function textureIn(material: Material, slot: keyof Paints): [Texture | null, TextureInfo | null] {
  if (slot === 'color') return [material.getBaseColorTexture(), material.getBaseColorTextureInfo()];
  if (slot === 'normal') return [material.getNormalTexture(), material.getNormalTextureInfo()];
  return [material.getMetallicRoughnessTexture(), material.getMetallicRoughnessTextureInfo()];
}

function setTexture(material: Material, slot: keyof Paints, painted: Texture): void {
  if (slot === 'color') {
    material.setBaseColorTexture(painted).setBaseColorFactor([1, 1, 1, material.getBaseColorFactor()[3]]);
    return;
  }
  const [before] = textureIn(material, slot);
  if (slot === 'normal') material.setNormalTexture(painted);
  else {
    const occlusion = material.getOcclusionTexture();
    if (occlusion === null || occlusion === before) {
      material.setOcclusionTexture(painted);
      copyUse(
        material.getMetallicRoughnessTextureInfo() ?? material.getBaseColorTextureInfo(),
        material.getOcclusionTextureInfo(),
      );
    }
    material.setMetallicRoughnessTexture(painted).setRoughnessFactor(1).setMetallicFactor(1);
  }
  // A new texture lies as that of the base colour does.
  if (before === null) copyUse(material.getBaseColorTextureInfo(), textureIn(material, slot)[1]);
}

/** Lays a texture as another one. */
function copyUse(from: TextureInfo | null, to: TextureInfo | null): void {
  if (!from || !to) return;
  to.setTexCoord(from.getTexCoord()).setWrapS(from.getWrapS()).setWrapT(from.getWrapT());
  const transform = from.getExtension('KHR_texture_transform');
  if (transform) to.setExtension('KHR_texture_transform', transform as ExtensionProperty);
}
