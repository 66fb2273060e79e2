/** The functions on documents of glTF-Transform: a file of their own in the package, which pages that use files do not carry. */
import type { Document, Transform } from '@gltf-transform/core';
import type { Mesh, TransferOptions, TransferResult } from '../api/index.js';
import type { Parts } from '../api/parts.js';
import { noteOf } from '../inspect/bare.js';
import { type Borders, isCut } from '../parts/cut-part.js';
import type { LeftOut } from '../parts/drawn.js';
import type { Piece } from '../scene/pieces.js';
import type { MaskSources } from './bake/mask-sources.js';
import { addTransfer } from './document/add-transfer.js';
import { transferDocument, wrong } from './document/transfer-document.js';

export type { ImageCodec } from '../scene/materials.js';
export { type BakeOptions, bake } from './bake/bake-document.js';
export type { MaskSources } from './bake/mask-sources.js';
export type { BakeReport, Paints } from './bake/plan.js';
export { addCage, type CageModelOptions, cageModel, cageTemplate } from './document/document-cages.js';
export type { LeftOut, Parts };

/** The ranges of a part of a document in the arrays of a result, and its name. */
export type PartRange = Pick<Piece, 'name' | 'firstVertex' | 'vertexCount' | 'firstTriangle' | 'triangleCount'>;

/** Options of `cagecast`: those of `transfer`, and what to transfer. */
export interface CagecastOptions extends Omit<TransferOptions, 'parts'>, MaskSources {
  /**
   * The cage that the texture was drawn for: a mesh, or a document, of which the default scene is used. It must have UVs.
   * Default: the meshes of the document that are named as the outer cages of others, as `Head_OuterCage` of `Head_Geo`.
   */
  cage?: Document | Mesh | undefined;
  /**
   * The number of the cage's UV set that the texture was drawn in, from 0. Default: that of the cage's own base colour texture, else the
   * first.
   */
  cageUvs?: number | undefined;
  /** The bytes of a PNG or JPEG file in the cage's UV space, shown as an overlay on the cosmetic triangles. Default: no overlay. */
  texture?: Uint8Array | undefined;
  /**
   * Where the paint ends: at existing triangle edges (`triangle`, the default), or exactly at holes and seams, where triangles are
   * then cut (`cut`): smooth borders, but more triangles.
   */
  borders?: Borders | undefined;
  /**
   * What counts, by the names of nodes, meshes and materials. What a viewer does not draw is ignored, and so are cages, markers and
   * collision shapes; glasses, hats, weapons and what the cage was made without are excluded, by their names; unless `keep` names them.
   */
  parts?: Parts | undefined;
  /**
   * Called with a copy of the result, and with the parts of the document in the order of the result's arrays, before the document is changed:
   * if it throws, the document stays as it was. `note` says why nothing, or less than 5 % of what the cage covers, may be painted, and
   * what helps; the document's logger warns of it, too. `leftOut` are the parts that do not count.
   */
  onResult?:
    | ((result: TransferResult, parts: PartRange[], note: string | undefined, leftOut: LeftOut[]) => void)
    | undefined;
}

/**
 * Makes a transform that adds a cage's UVs to the meshes of a document, as `cagecast transfer` does for a file.
 *
 * Every triangle primitive that is drawn of the document's default scene gets a new `TEXCOORD` set and `_NCZ` (the `Zone`: 0 may be painted) and,
 * with a texture, an overlay primitive of its cosmetic triangles. Everything else stays unchanged; if several nodes share a mesh,
 * each gets a copy. An earlier transfer to the document is replaced. Cut borders add vertices that blend existing ones, in all
 * attributes, skin weights and morph deltas. If the transform throws, the document is unchanged.
 *
 * glTF-Transform itself drops extensions that it does not know, such as those of VRM, when it reads a file: avatars are for `paintGlb`.
 *
 * Functions that change vertices, such as `simplify`, `weld` and `join`, belong before this one: simplified afterwards, an overlay
 * no longer lies on its surface, and new UVs stay beside those of a later transfer. `prune` takes UVs without a texture: after a
 * transfer without one, give it `keepAttributes: true`.
 * @throws {CagecastError} with the reason and the place, if target, cage, texture or options cannot be used.
 *
 * @example
 * import { NodeIO } from '@gltf-transform/core';
 * import { cagecast } from 'cagecast/gltf';
 *
 * const io = new NodeIO();
 * const document = await io.read('head.glb');
 * await document.transform(cagecast({ cage: await io.read('cage.glb'), texture: await readFile('paint.png') }));
 * await io.write('painted.glb', document);
 */
export function cagecast(options: CagecastOptions): Transform {
  if (typeof options !== 'object' || options === null) throw wrong('cagecast', 'the argument', options, 'an object');
  const { borders, onResult, ...own } = options;
  return async function cagecast(document: Document): Promise<void> {
    const cuts = isCut('cagecast', borders);
    const { target, around, result, cut, paint } = await transferDocument('cagecast', document, own, cuts);
    const note = noteOf(target.mesh, result, target.parts, around);
    if (note) document.getLogger().warn(`cagecast: ${note}`);
    onResult?.(
      structuredClone(result),
      target.parts.map(({ name, firstVertex, vertexCount, firstTriangle, triangleCount }) => ({
        name,
        firstVertex,
        vertexCount,
        firstTriangle,
        triangleCount,
      })),
      note,
      target.leftOut,
    );
    addTransfer(document, target, result, { paint, cut });
  };
}
