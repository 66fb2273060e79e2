import type {
  Accessor,
  Document,
  Mesh as DocumentMesh,
  Material,
  Node,
  Primitive,
  Property,
  Skin,
  Texture,
  TypedArray,
} from '@gltf-transform/core';
import type { CutTarget, Mesh, TransferResult } from '../index.js';
import { type Blends, blend, blendSkin, ruleOf } from '../parts/blend.js';
import { cutPart } from '../parts/cut-part.js';
import { skinMatrix, usedJoints } from '../parts/skin.js';
import { gather, type SplitPart, splitPart } from '../parts/split-part.js';
import { InputError } from './input-error.js';
import { instancing, isInstanced } from './instancing.js';
import { identity, isTurned, localMatrix, type Matrix, multiply } from './matrix.js';
import {
  cosmeticCorners,
  diagonal,
  freeUvSet,
  isMorphed,
  isOverlaid,
  isOverlay,
  overlayMark,
  overlayOffset,
  overlayPositions,
  type Paint,
  zoneAttribute,
} from './overlay.js';
import {
  aliasesOf,
  cutPiece,
  decodeFloats,
  decodePositions,
  decodeTriangles,
  hasTriangles,
  joinPieces,
  type Piece,
} from './pieces.js';

/** A piece, and its place in the document. */
export interface DocumentPart extends Piece {
  node: Node;
  mesh: DocumentMesh;
  primitive: Primitive;
}

/** All triangles of a document's scene as arrays, and the parts that they come from. */
export interface ExtractedDocument {
  /** With one group per part; with UVs if every primitive has a first set. */
  mesh: Mesh & { indices: Uint32Array };
  /** In the order of their vertices. */
  parts: DocumentPart[];
}

/**
 * Collects the triangles of a document's default scene (else its first), depth first, in the scene's space, by the same
 * rules as the command: vertices keep their order, every primitive of every node is a group of its own, and skinned meshes are placed
 * by their skeletons, in the bind pose.
 * @throws {InputError} that names the primitive and the element.
 */
export function extractDocument(document: Document): ExtractedDocument {
  const parts = listParts(document);
  const mesh = joinPieces(parts);
  const sets = parts.map(({ primitive }) => primitive.getAttribute('TEXCOORD_0'));
  if (parts.length === 0 || sets.some((set) => set === null)) return { mesh, parts };
  const uvs = new Float32Array((mesh.positions.length / 3) * 2);
  parts.forEach((part, p) => {
    const set = sets[p]!;
    if (set.getElementSize() !== 2)
      throw new InputError(`"${part.name}" has a TEXCOORD_0 of type ${set.getType()}, not VEC2`);
    if (set.getCount() !== part.vertexCount)
      throw new InputError(`"${part.name}" has ${set.getCount()} TEXCOORD_0 for ${part.vertexCount} vertices`);
    uvs.set(decodeFloats(set), 2 * part.firstVertex);
  });
  return { mesh: { ...mesh, uvs }, parts };
}

function listParts(document: Document): DocumentPart[] {
  const root = document.getRoot();
  const meshNumbers = new Map(root.listMeshes().map((mesh, m) => [mesh, m]));
  const scene = root.getDefaultScene() ?? root.listScenes()[0];
  const roots = scene ? scene.listChildren() : root.listNodes().filter((node) => node.getParentNode() === null);
  const parts: DocumentPart[] = [];
  const stack = roots.map((node) => ({ node, parent: identity })).reverse();
  for (let next = stack.pop(); next; next = stack.pop()) {
    const { node, parent } = next;
    const matrix = multiply(
      parent,
      localMatrix({ translation: node.getTranslation(), rotation: node.getRotation(), scale: node.getScale() }),
    );
    for (const child of node.listChildren().reverse()) stack.push({ node: child, parent: matrix });
    const [mesh, skin] = [node.getMesh(), node.getSkin()];
    if (mesh && node.getExtension(instancing))
      throw new InputError(`"${node.getName() || mesh.getName()}" ${isInstanced}`);
    mesh?.listPrimitives().forEach((primitive, p) => {
      const place = `meshes[${meshNumbers.get(mesh)}].primitives[${p}]`;
      const position = primitive.getAttribute('POSITION');
      if (position === null || !hasTriangles(primitive.getMode()) || isOverlay(primitive.getExtras())) return;
      const all = [primitive, ...primitive.listTargets()].flatMap((of) =>
        of.listSemantics().map((semantic) => [semantic, of.getAttribute(semantic)!.getCount()] as const),
      );
      const short = all.find(([, count]) => count < position.getCount());
      if (short) throw new InputError(`${place} has ${short[1]} ${short[0]} for ${position.getCount()} vertices`);
      const localPositions = decodePositions(place, position);
      const localIndices = decodeTriangles(
        place,
        primitive.getIndices()?.getArray() ?? null,
        primitive.getMode(),
        localPositions.length / 3,
      );
      const name = node.getName() || mesh.getName() || place;
      const material = primitive.getMaterial()?.getName() ?? '';
      const fullName =
        material !== '' && material !== name && mesh.listPrimitives().length > 1 ? `${name}/${material}` : name;
      const last = parts.at(-1);
      parts.push({
        name: fullName,
        aliases: aliasesOf(node.getName(), mesh.getName(), material, fullName),
        node,
        mesh,
        primitive,
        matrix: skin === null ? matrix : matrixOfSkin(skin, primitive, localPositions),
        firstVertex: last ? last.firstVertex + last.vertexCount : 0,
        vertexCount: localPositions.length / 3,
        firstTriangle: last ? last.firstTriangle + last.triangleCount : 0,
        triangleCount: localIndices.length / 3,
        localPositions,
        localIndices,
      });
    });
  }
  return parts;
}

/** Where a skin holds a primitive. */
function matrixOfSkin(skin: Skin, primitive: Primitive, positions: Float32Array): Matrix {
  const [held, weights] = [
    primitive.getAttribute('JOINTS_0')?.getArray(),
    primitive.getAttribute('WEIGHTS_0')?.getArray(),
  ];
  const joints = skin.listJoints();
  const inverses = skin.getInverseBindMatrices()?.getArray();
  if (!held || !weights || inverses === null || (inverses && inverses.length < 16 * joints.length)) return identity;
  const products: Matrix[] = joints.map((joint, j) =>
    inverses
      ? multiply(joint.getWorldMatrix(), Array.from(inverses.subarray(16 * j, 16 * j + 16)))
      : joint.getWorldMatrix(),
  );
  const isFloat = primitive.getAttribute('POSITION')!.getArray() instanceof Float32Array;
  return skinMatrix(products, usedJoints(held, weights), positions, isFloat, identity);
}

/**
 * Adds the result of a transfer to a document, as the command does to a file: every primitive gets a new UV set and `_NCZ` and, with
 * a texture, an overlay primitive of its cosmetic triangles. New vertices at cut borders, and copies of vertices whose triangles
 * need different UVs, are added after the existing ones. If several nodes share a mesh, each gets a copy.
 */
export function addTransfer(
  document: Document,
  { mesh, parts }: ExtractedDocument,
  result: Pick<TransferResult, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>,
  paint?: Paint,
  cut?: CutTarget,
): void {
  const buffer = document.getRoot().listBuffers()[0] ?? document.createBuffer();
  const attribute = (array: Float32Array, type: 'SCALAR' | 'VEC2' | 'VEC3') =>
    // A copy with a buffer of its own: for a view, the whole shared buffer would be written, once per view.
    document.createAccessor().setType(type).setArray(new Float32Array(array)).setBuffer(buffer);
  const texture =
    paint &&
    document
      .createTexture(paint.name)
      .setMimeType(paint.mimeType)
      .setImage(paint.bytes as Uint8Array<ArrayBuffer>);
  const materials = new Map<string, Material>();
  const offset = overlayOffset * diagonal(mesh.positions);
  const primitiveOf = separatePrimitives(document, parts);

  parts.forEach((part, p) => {
    const primitive = primitiveOf[p]!;
    const whole = { ...part, turned: isTurned(part.matrix) };
    const cutOne = cut && cutPart(whole, cut, mesh.positions.length / 3);
    const { geometry, result: own } = cutOne ?? { geometry: whole, result };
    const { firstVertex, vertexCount, firstTriangle, triangleCount } = geometry;
    const blends = cutOne && cutOne.blends.sources.length > 0 ? cutOne.blends : undefined;
    const split = splitPart(geometry, own);
    const indices = (corners: Uint32Array) =>
      document
        .createAccessor()
        .setType('SCALAR')
        .setArray(split.sources.length < 65536 ? Uint16Array.from(corners) : Uint32Array.from(corners))
        .setBuffer(buffer);
    if (split.copies > 0 || blends)
      remakePrimitive(primitive, split, indices(split.indices), blends && blender(primitive, blends));
    const uvs = attribute(split.uvs, 'VEC2');
    const zones = own.zones.subarray(firstVertex, firstVertex + vertexCount);
    primitive.setAttribute(
      freeUvSet((semantic) => primitive.getAttribute(semantic) !== null),
      uvs,
    );
    primitive.setAttribute(
      zoneAttribute,
      attribute(
        Float32Array.from(split.sources, (v) => zones[v]!),
        'SCALAR',
      ),
    );
    const corners = cosmeticCorners(
      split.indices,
      own.cosmeticTriangles.subarray(firstTriangle, firstTriangle + triangleCount),
    );
    if (!texture || corners.length === 0) return;

    const piece = cutOne ? cutPiece(part, geometry, blend(part.localPositions, 3, cutOne.blends)) : part;
    const overlay = document
      .createPrimitive()
      .setAttribute('POSITION', attribute(gather(overlayPositions(piece, offset), 3, split.sources), 'VEC3'))
      .setAttribute('TEXCOORD_0', uvs)
      .setIndices(indices(corners))
      .setMaterial(materialOn(document, texture, primitive.getMaterial(), materials))
      .setExtras({ ...overlayMark });
    for (const semantic of primitive.listSemantics())
      if (isOverlaid(semantic)) overlay.setAttribute(semantic, primitive.getAttribute(semantic));
    for (const morph of primitive.listTargets()) {
      const own = document.createPrimitiveTarget(morph.getName());
      for (const semantic of morph.listSemantics()) {
        if (isMorphed(semantic, overlay.getAttribute('NORMAL') !== null))
          own.setAttribute(semantic, morph.getAttribute(semantic));
      }
      // An empty morph target is not allowed.
      if (own.listSemantics().length === 0)
        own.setAttribute('POSITION', attribute(new Float32Array(3 * split.sources.length), 'VEC3'));
      overlay.addTarget(own);
    }
    part.node.getMesh()!.addPrimitive(overlay);
  });
}

/** The values of an accessor, with those of new vertices after them. @param semantic  None of a morph target's. */
type Extend = (accessor: Accessor, semantic?: string) => TypedArray;

/** Blends the attributes of a primitive. */
function blender(primitive: Primitive, blends: Blends): Extend {
  const skin = blendSkin((semantic) => primitive.getAttribute(semantic)?.getArray() ?? undefined, blends);
  return (accessor, semantic) => {
    const array = accessor.getArray()!;
    const pulls = semantic === undefined ? undefined : skin.get(semantic);
    return (
      pulls ??
      blend(
        array,
        accessor.getElementSize(),
        blends,
        semantic === undefined ? 'mean' : ruleOf(semantic, array, accessor.getNormalized()),
      )
    );
  };
}

/**
 * Adds new vertices, those that `extend` makes and copies, to all attributes and morph targets of a primitive. Accessors that
 * nothing else uses are disposed.
 */
function remakePrimitive(
  primitive: Primitive,
  { sources }: SplitPart,
  indices: Accessor,
  extend: Extend = (accessor) => accessor.getArray()!,
): void {
  const made = new Map<Accessor, Accessor>();
  const remake = (accessor: Accessor, semantic?: string): Accessor => {
    const known = made.get(accessor);
    if (known) return known;
    const own = accessor
      .clone()
      .setSparse(false)
      .setArray(gather(extend(accessor, semantic), accessor.getElementSize(), sources));
    made.set(accessor, own);
    return own;
  };
  const before = primitive.getIndices();
  primitive.setIndices(indices).setMode(4); // strips and fans have become lists
  for (const semantic of primitive.listSemantics())
    primitive.setAttribute(semantic, remake(primitive.getAttribute(semantic)!, semantic));
  for (const target of primitive.listTargets()) {
    const own = target.clone();
    for (const semantic of own.listSemantics()) own.setAttribute(semantic, remake(own.getAttribute(semantic)!));
    primitive.removeTarget(target).addTarget(own);
    if (isUnused(target)) target.dispose();
  }
  for (const accessor of [...made.keys(), ...(before ? [before] : [])]) if (isUnused(accessor)) accessor.dispose();
}

const isUnused = (property: Property): boolean =>
  property.listParents().every((parent) => parent.propertyType === 'Root');

/**
 * Gives every node of the transfer a mesh and primitives of its own. Other nodes, such as those of other scenes, share an unchanged
 * copy. The first node with a mesh keeps the original.
 * @returns the primitive of each part.
 */
function separatePrimitives(document: Document, parts: readonly DocumentPart[]): Primitive[] {
  const nodes = new Set(parts.map(({ node }) => node));
  const [meshes, primitives] = [new Set<DocumentMesh>(), new Set<Primitive>()];
  const ownOf = new Map<Node, Map<Primitive, Primitive>>();
  for (const node of nodes) {
    const mesh = node.getMesh()!;
    const own = meshes.has(mesh) ? mesh.clone() : mesh;
    const before = mesh.listPrimitives();
    const after = before.map((primitive) => (primitives.has(primitive) ? primitive.clone() : primitive));
    before.forEach((primitive) => own.removePrimitive(primitive));
    after.forEach((primitive) => own.addPrimitive(primitive));
    node.setMesh(own);
    meshes.add(own);
    after.forEach((primitive) => primitives.add(primitive));
    ownOf.set(node, new Map(before.map((primitive, p) => [primitive, after[p]!])));
  }
  for (const mesh of document.getRoot().listMeshes()) {
    const others = mesh
      .listParents()
      .filter((parent) => parent.propertyType === 'Node' && !nodes.has(parent as Node)) as Node[];
    if (others.length === 0 || !mesh.listPrimitives().some((primitive) => primitives.has(primitive))) continue;
    const own = mesh.clone();
    for (const primitive of mesh.listPrimitives()) own.removePrimitive(primitive).addPrimitive(primitive.clone());
    for (const node of others) node.setMesh(own);
  }
  return parts.map(({ node, primitive }) => ownOf.get(node)!.get(primitive)!);
}

/** A material that shows the texture, with the roughness and sidedness of the base's material. */
function materialOn(
  document: Document,
  texture: Texture,
  base: Material | null,
  made: Map<string, Material>,
): Material {
  const roughness = base?.getRoughnessFactor() ?? 1;
  const doubleSided = base?.getDoubleSided() ?? false;
  const key = `${roughness} ${doubleSided}`;
  let material = made.get(key);
  if (!material) {
    material = document
      .createMaterial('Cagecast overlay')
      .setAlphaMode('BLEND')
      .setDoubleSided(doubleSided)
      .setMetallicFactor(0)
      .setRoughnessFactor(roughness)
      .setBaseColorTexture(texture);
    made.set(key, material);
  }
  return material;
}
