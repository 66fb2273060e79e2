import type {
  Accessor,
  Document,
  Mesh as DocumentMesh,
  Material,
  Node,
  Primitive,
  Property,
  Texture,
  TypedArray,
} from '@gltf-transform/core';
import type { CutTarget, TransferResult } from '../index.js';
import { type Blends, blend, blendSkin, ruleOf } from '../parts/blend.js';
import { cutPart } from '../parts/cut-part.js';
import { gather, type SplitPart, splitPart } from '../parts/split-part.js';
import type { DocumentPart, ExtractedDocument } from './document.js';
import { isTurned } from './matrix.js';
import {
  cosmeticCorners,
  diagonal,
  freeUvSet,
  isMorphed,
  isOverlaid,
  overlayMark,
  overlayOffset,
  overlayPositions,
  type Paint,
  zoneAttribute,
} from './overlay.js';
import { cutPiece } from './pieces.js';

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
