import type { Document, ExtensionProperty, Material, Texture, TextureInfo } from '@gltf-transform/core';
import { show } from '../../api/error.js';
import type { Wrap } from '../../bake/index.js';
import { CagecastError, cutBorders, init, type Mesh, type TransferOptions, transfer } from '../../index.js';
import { type Borders, isCut } from '../../parts/borders-option.js';
import { type DocumentPart, extractDocument } from '../document.js';
import { addTransfer } from '../document-write.js';
import { InputError } from '../input-error.js';
import { paintOf } from '../overlay.js';
import { decodeFloats } from '../pieces.js';
import type { UvTransform } from '../uv-transform.js';
import { type MaskSources, masksOf } from './masks.js';
import {
  type BakeModel,
  type BakeReport,
  bakeModel,
  checkPaints,
  type ImageCodec,
  type Paints,
  type TextureUse,
} from './plan.js';

/** Options of `bake`: those of `transfer`, and what to bake. */
export interface BakeOptions extends TransferOptions, MaskSources {
  /** The cage that the paints were drawn for: a mesh, or a document, of which the default scene is used. It must have UVs. */
  cage: Document | Mesh;
  /** Images in the cage's UVs; at least one. */
  paints: Paints;
  /** Reads and writes the model's images, as this package does not: by sharp, say, or a canvas. Images are written as PNG. */
  images: ImageCodec;
  /** The longer side of painted textures, in texels. Default: as before; 1024 for a normal or ORM texture that a material lacks. */
  size?: number | undefined;
  /** Where the paint ends: at triangle edges (`triangle`, the default), or exactly at holes and seams of the cage (`cut`). */
  borders?: Borders | undefined;
  /**
   * The bytes of a PNG or JPEG file of the colours. With it, geometry is changed as by `cagecast`, and parts whose textures cannot
   * hold the paint get an overlay. Default: the geometry stays as it is, and such parts are not painted.
   */
  texture?: Uint8Array | undefined;
  /** Called with what was done. */
  onBaked?: ((report: BakeReport) => void) | undefined;
}

/**
 * Makes a transform that bakes paints into the textures of a document's own materials, in their own UVs. Geometry stays as it is.
 *
 * A texture is copied if other materials use it differently. Its size and alpha stay; a base colour factor is baked in. A part is
 * not painted if its material has no texture, if the part has no UVs for it or vertex colours, or if its UVs are not an unwrapping;
 * `onBaked` says which. Where UVs overlap, as mirrored halves do, the part that comes first has the texels.
 *
 * Memory: 24 bytes a texel of the largest texture. Cost: 0.2 s for 1024², and reading and writing images.
 * @throws {CagecastError} with the reason and the place, if target, cage, paints or options cannot be used.
 *
 * @example
 * const images = {
 *   decode: async (bytes) => {
 *     const { data, info } = await sharp(bytes).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
 *     return { width: info.width, height: info.height, data };
 *   },
 *   encode: ({ width, height, data }) => sharp(data, { raw: { width, height, channels: 4 } }).png().toBuffer(),
 * };
 * await document.transform(bake({ cage, paints: { color }, images }));
 */
export function bake(options: BakeOptions): (document: Document) => Promise<void> {
  if (typeof options !== 'object' || options === null)
    throw new CagecastError('badArgument', `bake: the argument is ${show(options)}, not an object`);
  const { cage, paints: given, images, size, borders, texture, onBaked, maskImages, maskColors, ...own } = options;
  return async function bake(document: Document): Promise<void> {
    const cuts = isCut('bake', borders);
    const paints = checkPaints('bake', given);
    if (typeof images?.decode !== 'function' || typeof images.encode !== 'function')
      throw new CagecastError('badArgument', `bake: images is ${show(images)}, not { decode, encode }`);
    if (typeof cage !== 'object' || cage === null)
      throw new CagecastError('badArgument', `bake: cage is ${show(cage)}, not a document or a mesh`);
    await init();
    const overlay = texture && within('texture', () => paintOf(texture));
    const source = 'getRoot' in cage ? within('cage', () => extractDocument(cage).mesh) : cage;
    const target = within('target', () => extractDocument(document));
    const model = new DocumentModel(document, target.parts);
    const masks = within('target', () => masksOf(model, own.masks, { images: maskImages, colors: maskColors }));
    const rules = { ...own, masks };
    const result = transfer(source, target.mesh, rules);
    const cut = cuts ? cutBorders(source, target.mesh, result, rules) : undefined;
    const ownCount = target.mesh.positions.length / 3;
    const { report, baked } = await bakeModel(model, {
      result,
      cut: cut && { target: cut, ownCount },
      paints,
      codec: images,
      size,
    }).catch((error) => within('target', () => raise(error)));
    if (overlay) {
      // What is baked is not shown twice.
      const triangles = target.parts.filter((part) => baked.has(part));
      const isBaked = (t: number) =>
        triangles.some((part) => t >= part.firstTriangle && t < part.firstTriangle + part.triangleCount);
      const shown = { ...result, cosmeticTriangles: result.cosmeticTriangles.map((is, t) => (isBaked(t) ? 0 : is)) };
      const shownCut = cut && {
        ...cut,
        cosmeticTriangles: cut.cosmeticTriangles.map((is, t) => (isBaked(cut.triangles[t]!) ? 0 : is)),
      };
      addTransfer(document, target, shown, overlay, shownCut);
    }
    onBaked?.(report);
  };
}

function raise(error: unknown): never {
  throw error;
}

function within<T>(argument: string, read: () => T): T {
  try {
    return read();
  } catch (error) {
    throw error instanceof InputError
      ? new CagecastError('badArgument', `bake: ${argument}: ${error.message}`, 0, { cause: error })
      : error;
  }
}

/** The extension of glTF-Transform, which is no dependency. */
interface KHRTransform extends ExtensionProperty {
  getOffset(): number[];
  getRotation(): number;
  getScale(): number[];
  getTexCoord(): number | null;
}

const wrapOf = (wrap: number): Wrap => (wrap === 33071 ? 'clamp' : wrap === 33648 ? 'mirror' : 'repeat');

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

  uvsOf({ primitive, vertexCount }: DocumentPart, set: string): Float32Array | undefined {
    const accessor = primitive.getAttribute(set);
    return accessor?.getElementSize() === 2 && accessor.getCount() === vertexCount ? decodeFloats(accessor) : undefined;
  }

  colorsOf({ primitive }: DocumentPart, semantic: string): { values: Float32Array; size: number } | undefined {
    const accessor = primitive.getAttribute(semantic);
    return accessor ? { values: decodeFloats(accessor), size: accessor.getElementSize() } : undefined;
  }

  isTinted({ primitive }: DocumentPart): boolean {
    return primitive.getAttribute('COLOR_0') !== null;
  }

  useOf(material: Material, slot: keyof Paints): TextureUse<Texture> | undefined {
    const [texture, info] = textureIn(material, slot);
    if (!texture || !info) return undefined;
    const found = info.getExtension('KHR_texture_transform') as KHRTransform | null;
    const transform: Partial<UvTransform> | undefined = found
      ? { offset: found.getOffset(), rotation: found.getRotation(), scale: found.getScale() }
      : undefined;
    const set = `TEXCOORD_${found?.getTexCoord() ?? info.getTexCoord()}`;
    return { texture, set, transform, wraps: [wrapOf(info.getWrapS()), wrapOf(info.getWrapT())] };
  }

  factorOf(material: Material, slot: keyof Paints): [number, number, number] {
    if (slot === 'normal') return [1, 1, 1];
    if (slot === 'orm') return [1, material.getRoughnessFactor(), material.getMetallicFactor()];
    const [r, g, b] = material.getBaseColorFactor();
    return [r, g, b];
  }

  async imageOf(texture: Texture): Promise<{ bytes: Uint8Array; mimeType: string } | undefined> {
    const bytes = texture.getImage();
    return bytes ? { bytes, mimeType: texture.getMimeType() } : undefined;
  }

  replace(materials: readonly Material[], slot: keyof Paints, png: Uint8Array, use: TextureUse<Texture>): void {
    const painted = this.#document
      .createTexture(use.texture.getName())
      .setMimeType('image/png')
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
