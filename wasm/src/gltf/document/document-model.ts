import type { Document, ExtensionProperty, Material, Texture, TextureInfo } from '@gltf-transform/core';
import type { Part } from '../../scene/extract.js';
import { Materials, type Place, type Slot, type TextureUse } from '../../scene/materials.js';
import type { BakeModel } from '../bake/plan.js';
import { imageType } from '../image-file.js';
import type { DocumentSource } from './document-source.js';

/** A document whose materials are painted. */
export class DocumentModel extends Materials implements BakeModel {
  readonly #document: Document;
  readonly #source: DocumentSource;

  constructor(document: Document, source: DocumentSource, parts: readonly Part[]) {
    super(source, parts);
    this.#document = document;
    this.#source = source;
  }

  replace(materials: readonly number[], slot: Place, png: Uint8Array, use: TextureUse): void {
    const before = this.#source.textureOf(use.texture);
    const painted = this.#document
      .createTexture(before.getName())
      .setMimeType(imageType(png) ?? 'image/png')
      .setImage(png as Uint8Array<ArrayBuffer>);
    for (const material of materials) setTexture(this.#source.materials[material]!, slot as Slot, painted);
    if (before.listParents().every((parent) => parent.propertyType === 'Root')) before.dispose();
  }
}

function textureIn(material: Material, slot: Slot): [Texture | null, TextureInfo | null] {
  if (slot === 'color') return [material.getBaseColorTexture(), material.getBaseColorTextureInfo()];
  if (slot === 'normal') return [material.getNormalTexture(), material.getNormalTextureInfo()];
  return [material.getMetallicRoughnessTexture(), material.getMetallicRoughnessTextureInfo()];
}

function setTexture(material: Material, slot: Slot, painted: Texture): void {
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
