import type { Document } from '@gltf-transform/core';
import type { Mesh, TransferOptions } from '../../api/index.js';
import type { Parts } from '../../api/parts.js';
import { mostTexels } from '../../bake/index.js';
import { type Borders, isCut } from '../../parts/cut-part.js';
import { type ImageCodec, type Slot, slots } from '../../scene/materials.js';
import { addTransfer } from '../document/add-transfer.js';
import { removeOverlays } from '../document/earlier-in-document.js';
import { ofArgument, transferDocument, wrong } from '../document/transfer-document.js';
import { checkedDecode } from '../host-decode.js';
import { preparePiece } from '../primitive-group.js';
import type { MaskSources } from './mask-sources.js';
import { type BakeReport, bakeModel, coatsOf, type Paints } from './plan.js';

/** Options of `bake`: those of `transfer`, and what to bake. */
export interface BakeOptions extends Omit<TransferOptions, 'parts'>, MaskSources {
  /**
   * The cage that the paints were drawn for: a mesh, or a document, of which the default scene is used. It must have UVs.
   * Default: the meshes of the document that are named as the outer cages of others, as `Head_OuterCage` of `Head_Geo`.
   */
  cage?: Document | Mesh | undefined;
  /** The number of its UV set that the paints were drawn in, as for `cagecast`. */
  cageUvs?: number | undefined;
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
  /** What counts, as for `cagecast`. */
  parts?: Parts | undefined;
  /** Called with what was done. */
  onBaked?: ((report: BakeReport) => void) | undefined;
}

/**
 * Makes a transform that bakes paints into the textures of a document's own materials, in their own UVs. Geometry stays as it is, without
 * overlays of an earlier transfer.
 *
 * A texture is copied if other materials use it differently. Its size and alpha stay; a base colour factor is baked in. A part is
 * not painted if its material has no texture, if the part has no UVs for it or vertex colours that are not white, or if its UVs are not
 * an unwrapping; `onBaked` says which. Where UVs overlap, as mirrored halves do, the part that comes first has the texels.
 *
 * If the transform throws, the document is unchanged.
 *
 * Memory: 32 bytes a texel of the largest texture, and the images. Cost: 0.3 to 0.5 s for 1024², and reading and writing images.
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
  if (typeof options !== 'object' || options === null) throw wrong('bake', 'the argument', options, 'an object');
  const { paints, images, size, borders, onBaked, ...own } = options;
  return async function bake(document: Document): Promise<void> {
    const cuts = isCut('bake', borders);
    if (!slots.some((slot) => paints?.[slot]) || Object.keys(paints).some((name) => !slots.includes(name as Slot)))
      throw wrong('bake', 'paints', paints, `{ ${slots.join(', ')} }`);
    if (typeof images?.decode !== 'function' || typeof images.encode !== 'function')
      throw wrong('bake', 'images', images, '{ decode, encode }');
    if (size !== undefined && !(Number.isInteger(size) && size > 0 && size <= mostTexels))
      throw wrong('bake', 'size', size, `a whole number of texels from 1 to ${mostTexels}`);
    const { target, model, result, cut, paint } = await transferDocument('bake', document, own, cuts);
    const { report, baked } = await bakeModel(model, {
      result,
      prepared: (part) => preparePiece(part, result, cut),
      coats: coatsOf(paints),
      codec: { ...images, decode: checkedDecode('bake', 'images.decode', images.decode) },
      size,
    }).catch((error) => {
      throw ofArgument('bake', 'target', error);
    });
    removeOverlays(
      document,
      target.parts.map((part) => target.source.partOf(part).node),
    );
    if (paint) addTransfer(document, target, result, { paint, cut, baked });
    onBaked?.(report);
  };
}
