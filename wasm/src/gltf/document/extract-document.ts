import type {
  Accessor,
  Document,
  Mesh as DocumentMesh,
  ExtensionProperty,
  Node,
  Primitive,
  TextureInfo,
} from '@gltf-transform/core';
import type { Mesh } from '../../api/index.js';
import type { Parts } from '../../api/parts.js';
import type { Vector } from '../../inspect/geometry.js';
import { identity, type Matrix, multiply } from '../../parts/affine.js';
import {
  chooseParts,
  isClear,
  type LeftOut,
  type Look,
  nameOfGlass,
  transmissionExtension,
  visibilityExtension,
} from '../../parts/drawn.js';
import { upFrom } from '../../parts/joints.js';
import type { Expressions } from '../../parts/morph-names.js';
import { kSceneOrigin, type Origin } from '../../parts/origin.js';
import { type MorphedPart, type MorphTarget, posesOf } from '../../parts/poses.js';
import { placeMeshes, type Skin } from '../../parts/skin.js';
import { decodeFloats } from '../accessors.js';
import { InputError } from '../input-error.js';
import { firstInstance, instancing } from '../instancing.js';
import { isMarked } from '../overlay.js';
import {
  decodePositions,
  decodeTriangles,
  decodeUvs,
  hasTriangles,
  joinPieces,
  moveTo,
  nextPiece,
  type Piece,
  renumber,
} from '../pieces.js';
import type { UvLayout } from '../uv-layout.js';

/** A piece, and its place in the document. */
export interface DocumentPart extends Piece {
  node: Node;
  mesh: DocumentMesh;
  primitive: Primitive;
}

/** The triangles of a document's scene as arrays, and the parts that they come from. */
export interface ExtractedDocument {
  /** With one group per part; with UVs if every primitive has the set of its base colour texture, or the first without one. */
  mesh: Mesh & { indices: Uint32Array };
  /** In the order of their vertices. */
  parts: DocumentPart[];
  leftOut: LeftOut[];
  /** The numbers of parts that a figure wears or carries. */
  accessories: number[];
  /** The numbers of parts that patterns keep, and exclude. */
  kept: number[];
  excluded: number[];
  /** What was subtracted from their places in the scene. */
  origin: Vector;
}

/**
 * Collects the triangles of a document's default scene (else its first), depth first, in the scene's space, by the same
 * rules as the command: vertices keep their order, every primitive of every node is a group of its own, skinned meshes are placed
 * by their skeletons, in the bind pose, and morph targets shape meshes by their weights.
 * @param origin  What is subtracted from positions. Target and cage need the same one.
 * @throws {InputError} that names the primitive and the element.
 */
export function extractDocument(
  document: Document,
  origin: Origin = kSceneOrigin,
  which?: Parts | 'cage',
): ExtractedDocument {
  const all = listParts(document);
  const { parts, leftOut, ...numbers } = chooseParts(all, lookOf, which, (text) => new InputError(text));
  renumber(parts);
  const others = {
    leftOut: leftOut.map(({ name, why }) => ({ name, why })),
    ...numbers,
    origin: moveTo(parts, origin),
  };
  const joined = joinPieces(parts);
  const poses = which === 'cage' ? undefined : posesOf(morphedParts(document, parts, joined.positions));
  const mesh = { ...joined, ...(poses && { poses }) };
  const layouts = parts.map(({ primitive }) => uvLayoutOf(primitive.getMaterial()?.getBaseColorTextureInfo()));
  const sets = parts.map(({ primitive }, p) => primitive.getAttribute(layouts[p]!.set));
  if (parts.length === 0 || sets.some((set) => set === null)) return { mesh, parts, ...others };
  const uvs = new Float32Array((mesh.positions.length / 3) * 2);
  parts.forEach(({ name, firstVertex, vertexCount }, p) =>
    uvs.set(decodeUvs(`"${name}"`, layouts[p]!, sets[p]!, vertexCount), 2 * firstVertex),
  );
  return { mesh: { ...mesh, uvs }, parts, ...others };
}

/**
 * Parts, and what moves them.
 * @param positions    Of all parts, in the space of the model.
 * @param expressions  Those of a VRM. Default: none.
 */
export function morphedParts(
  document: Document,
  parts: readonly DocumentPart[],
  positions: Float32Array,
  expressions: Expressions = () => [],
): MorphedPart[] {
  const root = document.getRoot();
  const [nodes, meshes] = [root.listNodes(), root.listMeshes()];
  return parts.map(({ node, mesh, primitive, aliases, matrix, firstVertex, vertexCount }) => {
    const place = [nodes.indexOf(node), meshes.indexOf(mesh)] as const;
    const names = (mesh.getExtras()['targetNames'] ?? []) as unknown[];
    const weights = weightsOf(node, mesh);
    const targets = primitive.listTargets().map((target, t): MorphTarget => {
      const deltas = target.getAttribute('POSITION');
      return {
        names: [target.getName() || names[t], ...expressions(...place, t)],
        deltas: () => deltas && decodeFloats(deltas),
        shown: weights[t],
      };
    });
    const own = positions.subarray(3 * firstVertex, 3 * (firstVertex + vertexCount));
    return { names: aliases, matrix, positions: own, targets };
  });
}

const weightsOf = (node: Node, mesh: DocumentMesh): number[] =>
  node.getWeights().length > 0 ? node.getWeights() : mesh.getWeights();

/** The nodes above a node, the nearest first. */
function ancestorsOf(node: Node): Node[] {
  const above = node.getParentNode();
  return above ? [above, ...ancestorsOf(above)] : [];
}

function lookOf({ node, primitive, aliases, matrix, localPositions, localIndices }: DocumentPart): Look {
  const material = primitive.getMaterial();
  const isOff = (of: Node) => (of.getExtension(visibilityExtension) as Visibility | null)?.getVisible() === false;
  return {
    names: aliases,
    above: ancestorsOf(node).map((one) => one.getName()),
    isHidden: [node, ...ancestorsOf(node)].some(isOff),
    isClear: isClear(material?.getAlphaMode(), material?.getAlpha(), material?.getAlphaCutoff()),
    sides: material?.getDoubleSided() ? 'both' : 'front',
    positions: localPositions,
    indices: localIndices,
    matrix,
  };
}

/** KHR_materials_transmission, as glTF-Transform has it, whose extensions are no dependency. */
interface Transmission extends ExtensionProperty {
  getTransmissionFactor(): number;
}

/** The names of a part; see-through ones are called glass besides. */
export function partNames({ aliases, name, primitive }: DocumentPart): string[] {
  const material = primitive.getMaterial();
  const transmission = material?.getExtension(transmissionExtension) as Transmission | null | undefined;
  const glass = nameOfGlass(material?.getAlphaMode(), material?.getAlpha(), transmission?.getTransmissionFactor());
  return [...(aliases.length > 0 ? aliases : [name]), ...glass];
}

export function uvLayoutOf(info: TextureInfo | null | undefined): UvLayout {
  const found = info?.getExtension('KHR_texture_transform') as KHRTransform | null | undefined;
  return {
    set: `TEXCOORD_${found?.getTexCoord() ?? info?.getTexCoord() ?? 0}`,
    transform: found
      ? { offset: found.getOffset(), rotation: found.getRotation(), scale: found.getScale() }
      : undefined,
  };
}

/** Whether a primitive is an overlay. */
export const isOverlay = (primitive: Primitive): boolean =>
  isMarked(primitive.getExtras(), primitive.getMaterial()?.getExtras());

/** KHR_texture_transform, as glTF-Transform has it, whose extensions are no dependency. */
interface KHRTransform extends ExtensionProperty {
  getOffset(): number[];
  getRotation(): number;
  getScale(): number[];
  getTexCoord(): number | null;
}

/** KHR_node_visibility, as glTF-Transform has it. */
interface Visibility extends ExtensionProperty {
  getVisible(): boolean;
}

/** EXT_mesh_gpu_instancing, as glTF-Transform has it. */
interface InstancedMesh extends ExtensionProperty {
  getAttribute(semantic: string): Accessor | null;
}

function listParts(document: Document): DocumentPart[] {
  const root = document.getRoot();
  const meshNumbers = new Map(root.listMeshes().map((mesh, m) => [mesh, m]));
  const scene = root.getDefaultScene() ?? root.listScenes()[0];
  const stack = scene ? scene.listChildren() : root.listNodes().filter((node) => node.getParentNode() === null);
  const parts: DocumentPart[] = [];
  stack.reverse();
  for (let node = stack.pop(); node; node = stack.pop()) {
    stack.push(...node.listChildren().reverse());
    const mesh = node.getMesh();
    if (!mesh) continue;
    let matrix: Matrix = node.getWorldMatrix();
    const instances = node.getExtension(instancing) as InstancedMesh | null;
    if (instances)
      matrix = multiply(
        matrix,
        firstInstance(`"${node.getName() || mesh.getName()}"`, (semantic) => instances.getAttribute(semantic)),
      );
    const weights = weightsOf(node, mesh);
    mesh.listPrimitives().forEach((primitive, p) => {
      const place = `meshes[${meshNumbers.get(mesh)}].primitives[${p}]`;
      const position = primitive.getAttribute('POSITION');
      if (position === null || !hasTriangles(primitive.getMode()) || isOverlay(primitive)) return;
      const all = [primitive, ...primitive.listTargets()].flatMap((of) =>
        of.listSemantics().map((semantic) => [semantic, of.getAttribute(semantic)!.getCount()] as const),
      );
      const short = all.find(([, count]) => count < position.getCount());
      if (short) throw new InputError(`${place} has ${short[1]} ${short[0]} for ${position.getCount()} vertices`);
      const targets = primitive.listTargets();
      const deltas = (t: number) => targets[t]?.getAttribute('POSITION');
      const positions = decodePositions(place, position, weights, deltas);
      const piece = nextPiece(parts, {
        node: node.getName(),
        mesh: mesh.getName(),
        material: primitive.getMaterial()?.getName(),
        place,
        primitives: mesh.listPrimitives().length,
        matrix,
        positions,
        indices: decodeTriangles(
          place,
          primitive.getIndices()?.getArray() ?? null,
          primitive.getMode(),
          positions.length / 3,
        ),
      });
      parts.push({ ...piece, node, mesh, primitive });
    });
  }
  const placed = placeMeshes(
    parts.map((part) => ({ ...part, skin: skinOf(part) })),
    { parentOf, worldOf: jointMatrix },
  );
  parts.forEach((part, p) => (part.matrix = placed[p]!));
  return parts;
}

const parentOf = (node: Node): Node | null => node.getParentNode();

/** The matrix of a joint to the scene; the identity if it is below itself, which no node of a scene is. */
export function jointMatrix(joint: Node): Matrix {
  const top = [...upFrom(joint, parentOf)].at(-1)!;
  return parentOf(top) === null ? joint.getWorldMatrix() : identity;
}

/** How its skin holds a part. */
export function skinOf({ node, primitive, localPositions: positions }: DocumentPart): Skin<Node> | undefined {
  const skin = node.getSkin();
  if (!skin) return undefined;
  const inverses = skin.getInverseBindMatrices()?.getArray();
  const arrayOf = (semantic: string) => primitive.getAttribute(semantic)?.getArray() ?? [];
  return {
    joints: skin.listJoints(),
    inverseOf: (j) => inverses?.subarray(16 * j, 16 * j + 16),
    bind: identity,
    held: arrayOf('JOINTS_0'),
    weights: arrayOf('WEIGHTS_0'),
    positions,
    isFloat: arrayOf('POSITION') instanceof Float32Array,
  };
}
