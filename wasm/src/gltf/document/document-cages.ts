import type { Document, Node } from '@gltf-transform/core';
import type { Cage, CageModel, Template } from '../../cages/types.js';
import { CagecastError } from '../../core/error.js';
import type { VrmExtensions } from '../../parts/joints.js';
import { cageModelOf, templateOf } from '../../scene/cage-model.js';
import { extract } from '../../scene/extract.js';
import type { ImageCodec } from '../../scene/materials.js';
import { createAccessor } from './add-transfer.js';
import { DocumentSource } from './document-source.js';
import { read, wrong } from './transfer-document.js';

/** Options of `cageModel`. */
export interface CageModelOptions {
  /** The `extensions` of the file's JSON. A VRM's skeleton and expressions are in them: without it, names of nodes and morph targets count. */
  extensions?: VrmExtensions | undefined;
  /**
   * Decodes an image, as for `bake`, to find a face that is only painted. Rejected images are left out.
   * Default: colours are not looked at.
   */
  decode?: ImageCodec['decode'] | undefined;
}

/**
 * What `cagecast/cages` needs of a document: the triangles of its default scene, a part for each primitive of each node, the
 * joints of its skins, in the bind pose, where its morph targets say that its face is, and what its parts look like.
 * Cost: with `decode`, that of decoding, and some milliseconds for each image.
 * @throws {CagecastError} `badArgument` that names the primitive.
 *
 * @example
 * const fit = await fitCage(template, await cageModel(document, { decode })); // of cagecast/cages
 */
export async function cageModel(document: Document, { extensions, decode }: CageModelOptions = {}): Promise<CageModel> {
  const { source, ...extracted } = read('cageModel', 'model', document, () => {
    const source = new DocumentSource(document, extensions);
    return { source, ...extract(source) };
  });
  return cageModelOf(source, extracted, decode);
}

/**
 * A document as a template: its mesh, and the landmarks that the `extras` of its cage's node or mesh have.
 * @throws {CagecastError} `badArgument`, `missingUvs`
 */
export function cageTemplate(document: Document): Template {
  return read('cageTemplate', 'template', document, () => {
    const source = new DocumentSource(document);
    const extracted = extract(source, undefined, 'cage');
    if (extracted.mesh.uvs === undefined)
      throw new CagecastError('missingUvs', 'cageTemplate', 'template has a primitive without UVs', {
        argument: 'template',
      });
    return templateOf(source, extracted);
  });
}

/**
 * Adds a cage to a document: a node named `cage` in its default scene, with landmarks, holes and kind in its `extras`, so that the
 * document is a template. `cageGlb` of `cagecast/cages` writes a file at once.
 * @throws {CagecastError} `badArgument`
 *
 * @example
 * await new NodeIO().write('cage.glb', addCage(new Document(), await makeCage(document)).document);
 */
export function addCage<D extends Document>(
  document: D,
  cage: Pick<Cage, 'positions' | 'uvs' | 'indices'> & Partial<Cage>,
): { document: D; node: Node } {
  const { positions, uvs, indices, landmarks = {}, holes = {}, kind = 'automatic', regions, bare } = cage;
  const root = read('addCage', 'document', document, () => document.getRoot());
  for (const [name, array] of Object.entries({ positions, uvs, indices }))
    if (!ArrayBuffer.isView(array)) throw wrong('addCage', `cage.${name}`, array, 'an array');
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', createAccessor(document, positions, 'VEC3'))
    .setAttribute('TEXCOORD_0', createAccessor(document, uvs, 'VEC2'))
    .setIndices(createAccessor(document, indices, 'SCALAR'));
  const node = document
    .createNode('cage')
    .setMesh(document.createMesh('cage').addPrimitive(primitive))
    .setExtras({ landmarks, holes, kind, ...(regions && { regions }), ...(bare && { bare }) } as object as Record<
      string,
      unknown
    >);
  (root.getDefaultScene() ?? root.listScenes()[0] ?? document.createScene()).addChild(node);
  return { document, node };
}
