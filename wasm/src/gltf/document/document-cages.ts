import type { Document, Node } from '@gltf-transform/core';
import { CagecastError } from '../../api/index.js';
import type { Cage, CageModel, Template } from '../../cages/types.js';
import { faceHints } from '../../parts/face-hints.js';
import { jointPlace, type ReadJoint, readSkeleton, type VrmExtensions, vrmBones } from '../../parts/joints.js';
import { vrmExpressions } from '../../parts/morph-names.js';
import { readTemplate } from '../../parts/template-extras.js';
import { baseColorsOf } from '../bake/base-colors.js';
import type { ImageCodec } from '../bake/plan.js';
import { InputError } from '../input-error.js';
import { createAccessor } from './add-transfer.js';
import { DocumentModel } from './document-model.js';
import {
  type DocumentPart,
  extractDocument,
  jointMatrix,
  morphedParts,
  partNames,
  skinOf,
} from './extract-document.js';
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
  const { mesh, parts } = read('cageModel', 'model', document, () => extractDocument(document));
  const { positions, indices, groups } = mesh;
  return {
    positions,
    indices,
    groups,
    names: parts.map(partNames),
    ...skeletonOf(document, parts, vrmBones(extensions)),
    hints: faceHints(morphedParts(document, parts, positions, vrmExpressions(extensions))),
    ...(decode && (await baseColorsOf(new DocumentModel(document, parts), decode))),
  };
}

/**
 * A document as a template: its mesh, and the landmarks that the `extras` of its cage's node or mesh have.
 * @throws {CagecastError} `badArgument`, `missingUvs`
 */
export function cageTemplate(document: Document): Template {
  return read('cageTemplate', 'template', document, () => {
    const { mesh, parts } = extractDocument(document, undefined, 'cage');
    if (mesh.uvs === undefined)
      throw new CagecastError('missingUvs', 'cageTemplate', 'template has a primitive without UVs', {
        argument: 'template',
      });
    const sources = parts.flatMap((part) => [
      { ...part, extras: part.mesh.getExtras(), place: `mesh of "${part.name}"` },
      { ...part, extras: part.node.getExtras(), place: `"${part.name}"` },
    ]);
    const { positions, indices, uvs } = mesh;
    return readTemplate({ positions, indices, uvs }, sources, (text) => new InputError(text));
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

function skeletonOf(document: Document, parts: readonly DocumentPart[], bones: Map<number, string>) {
  const nodes = document.getRoot().listNodes();
  const boneOf = new Map([...bones].flatMap(([n, bone]) => (nodes[n] ? [[nodes[n], bone] as const] : [])));
  const nameOf = (node: Node) => boneOf.get(node) ?? (node.getName() || `nodes[${nodes.indexOf(node)}]`);
  const atNode = (node: Node): ReadJoint<Node> => ({
    node,
    name: nameOf(node),
    position: jointMatrix(node).slice(12, 15) as [number, number, number],
  });
  const joints = parts.flatMap(({ node: holder, matrix }) => {
    const skin = holder.getSkin();
    const inverses = skin?.getInverseBindMatrices()?.getArray();
    return (skin?.listJoints() ?? []).map((node, j) => {
      const position = inverses ? jointPlace(matrix, inverses.subarray(16 * j)) : undefined;
      return position ? { node, name: nameOf(node), position } : atNode(node);
    });
  });
  const held = parts.map((part) => ({ ...part, skin: skinOf(part) }));
  return readSkeleton([...joints, ...[...boneOf.keys()].map(atNode)], held, (node) => node.getParentNode());
}
