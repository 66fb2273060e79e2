import type {
  Accessor,
  Document,
  Mesh as DocumentMesh,
  ExtensionProperty,
  Material,
  Node,
  Primitive,
  PrimitiveTarget,
  Texture,
  TextureInfo,
  TypedArray,
} from '@gltf-transform/core';
import type { CutTarget, TransferResult } from '../../api/index.js';
import { type AttributeArray, applySplit, ruleOf, splitSkin } from '../../parts/blend.js';
import type { PreparedPart } from '../../parts/prepare.js';
import { emissiveExtension, unlitExtension } from '../../scene/materials.js';
import { overlayMark } from '../../scene/overlay-mark.js';
import type { Piece } from '../../scene/pieces.js';
import { uvLayoutOf } from '../../scene/uv-layout.js';
import {
  cosmeticCorners,
  type Finish,
  freeUvSet,
  isMorphed,
  isOverlaid,
  metalnessOf,
  type Paint,
  uvsMark,
  zoneAttribute,
} from '../overlay.js';
import { preparePiece, type SharedVertices, shareVertices, sparseElements, storedUvs } from '../primitive-group.js';
import { type DocumentPart, infoOf } from './document-source.js';
import { disposeUnused, removeAttributes, removeOverlays } from './earlier-in-document.js';
import type { ExtractedDocument } from './transfer-document.js';

/** A part, and what it becomes. */
interface Member extends PreparedPart {
  part: DocumentPart;
  primitive: Primitive;
  /** What shows the texture on it, if anything does. */
  overlay: OverlayWriter | undefined;
}

/**
 * Adds the result of a transfer to a document, as the command does to a file: every primitive gets a new UV set and `_NCZ` and, with
 * a texture, an overlay primitive of its cosmetic triangles. New vertices at cut borders, and copies of vertices whose triangles
 * need different UVs, are added after the existing ones. It replaces an earlier transfer. If several nodes share a mesh, each gets a copy.
 * @param baked  Parts that show the texture already, and get no overlay.
 */
export function addTransfer(
  document: Document,
  target: Pick<ExtractedDocument, 'source' | 'parts'>,
  result: Pick<TransferResult, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>,
  { paint, cut, baked }: { paint: Paint | undefined; cut: CutTarget | undefined; baked?: ReadonlySet<Piece> },
): void {
  const parts = target.parts.map((part) => target.source.partOf(part));
  const primitiveOf = separatePrimitives(document, parts);
  removeOverlays(
    document,
    parts.map(({ node }) => node),
  );
  removeAttributes(document, primitiveOf);
  const overlay = paint && new OverlayWriter(document, paint);
  const members = parts.map(
    (part, p): Member => ({
      ...preparePiece(part, result, cut),
      part,
      primitive: primitiveOf[p]!,
      overlay: baked?.has(target.parts[p]!) ? undefined : overlay,
    }),
  );
  for (const group of groupsOf(members)) addToGroup(document, group);
}

/** The parts by the attributes that their primitives share. */
function groupsOf(members: readonly Member[]): Member[][] {
  const numbers = new Map<object, number>();
  const numberOf = (property: object) => {
    if (!numbers.has(property)) numbers.set(property, numbers.size);
    return numbers.get(property)!;
  };
  const keyOf = (of: Primitive | PrimitiveTarget) =>
    of.listSemantics().map((semantic) => `${semantic} ${numberOf(of.getAttribute(semantic)!)}`);
  const groups = new Map<string, Member[]>();
  for (const member of members) {
    const { primitive, part } = member;
    const key = JSON.stringify([numberOf(part.node), keyOf(primitive), primitive.listTargets().map(keyOf)]);
    groups.set(key, [...(groups.get(key) ?? []), member]);
  }
  return [...groups.values()];
}

/** Makes an accessor of some values, in the document's first buffer. */
export const createAccessor = (document: Document, array: AttributeArray, type: 'SCALAR' | 'VEC2' | 'VEC3'): Accessor =>
  document
    .createAccessor()
    .setType(type)
    // A copy with a buffer of its own: for a view, the whole shared buffer would be written, once per view.
    .setArray(array.slice() as TypedArray)
    .setBuffer(document.getRoot().listBuffers()[0] ?? document.createBuffer());

/** Adds UVs, zones and overlays to primitives that share their attributes. */
function addToGroup(document: Document, members: readonly Member[]): void {
  const { part, primitive: first } = members[0]!;
  const shared = shareVertices(part.vertexCount, members);
  const indices = (corners: Uint32Array) =>
    createAccessor(document, shared.sources.length < 65536 ? Uint16Array.from(corners) : corners, 'SCALAR');
  if (shared.isNew) {
    const primitives = members.map(({ primitive }) => primitive);
    const before = primitives.flatMap((primitive) => primitive.getIndices() ?? []);
    remakePrimitives(document, primitives, shared);
    members.forEach(({ primitive }, m) => primitive.setIndices(indices(shared.indices[m]!)).setMode(4)); // strips and fans have become lists
    for (const accessor of before) disposeUnused(document, accessor);
  }
  const stored = storedUvs(shared.uvs);
  const uvs = createAccessor(document, stored, 'VEC2')
    .setNormalized(stored instanceof Uint16Array)
    .setExtras({ ...uvsMark });
  const zones = createAccessor(document, shared.zones, 'SCALAR').setSparse(isSparse(shared.zones, 1));
  const uvSet = freeUvSet((semantic) => first.getAttribute(semantic) !== null);
  members.forEach(({ primitive, part: { node }, cosmeticTriangles, overlay }, m) => {
    const corners = cosmeticCorners(shared.indices[m]!, cosmeticTriangles);
    if (overlay && corners.length > 0)
      node.getMesh()!.addPrimitive(overlay.primitive(primitive, indices(corners), uvs));
    primitive.setAttribute(uvSet, uvs).setAttribute(zoneAttribute, zones);
  });
}

/** Whether to store only elements that are not 0: if it saves bytes. glTF-Transform warns where most are not 0. */
function isSparse(values: AttributeArray, size: number): boolean {
  const listed = sparseElements(values, size);
  return listed !== undefined && 2 * listed.length <= values.length / size;
}

/**
 * Adds new vertices, blends and copies, to all attributes and morph targets that primitives share. Accessors that nothing else uses
 * are disposed.
 */
function remakePrimitives(document: Document, primitives: readonly Primitive[], shared: SharedVertices): void {
  const skin = splitSkin((semantic) => primitives[0]!.getAttribute(semantic)?.getArray() ?? undefined, shared);
  const made = new Map<Accessor, Accessor>();
  /** @param semantic  None of a morph target's. */
  const remake = (accessor: Accessor, semantic?: string): Accessor => {
    const known = made.get(accessor);
    if (known) return known;
    const [array, size] = [accessor.getArray()!, accessor.getElementSize()];
    const rule = semantic === undefined ? 'mean' : ruleOf(semantic, array, accessor.getNormalized());
    const pulls = semantic === undefined ? undefined : skin.get(semantic);
    const values = pulls ?? applySplit(array, size, shared, rule);
    const own = accessor.clone().setArray(values);
    if (own.getSparse()) own.setSparse(isSparse(values, size));
    made.set(accessor, own);
    return own;
  };
  for (const primitive of primitives) {
    for (const semantic of primitive.listSemantics())
      primitive.setAttribute(semantic, remake(primitive.getAttribute(semantic)!, semantic));
    for (const target of primitive.listTargets()) {
      const own = target.clone();
      for (const semantic of own.listSemantics()) own.setAttribute(semantic, remake(own.getAttribute(semantic)!));
      primitive.removeTarget(target).addTarget(own);
      disposeUnused(document, target);
    }
  }
  for (const accessor of made.keys()) disposeUnused(document, accessor);
}

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

/** Writes overlays that show a texture. */
class OverlayWriter {
  readonly #document: Document;
  readonly #paint: Paint;
  #texture: Texture | undefined;
  readonly #materials = new Map<string, Material>();

  constructor(document: Document, paint: Paint) {
    this.#document = document;
    this.#paint = paint;
  }

  /** A primitive of some triangles of `base`, with the same vertices, skin and morph targets. */
  primitive(base: Primitive, indices: Accessor, uvs: Accessor): Primitive {
    const overlay = this.#document
      .createPrimitive()
      .setIndices(indices)
      .setExtras({ ...overlayMark })
      .setAttribute('TEXCOORD_0', uvs);
    overlay.setMaterial(this.#material(base, overlay));
    for (const semantic of base.listSemantics())
      if (isOverlaid(semantic)) overlay.setAttribute(semantic, base.getAttribute(semantic));
    for (const morph of base.listTargets()) {
      const target = this.#document.createPrimitiveTarget(morph.getName());
      for (const semantic of morph.listSemantics()) {
        if (isMorphed(semantic, overlay.getAttribute('NORMAL') !== null))
          target.setAttribute(semantic, morph.getAttribute(semantic));
      }
      // An empty morph target is not allowed.
      if (target.listSemantics().length === 0) target.setAttribute('POSITION', this.#still(uvs));
      overlay.addTarget(target);
    }
    return overlay;
  }

  /** Deltas that move nothing. */
  #still(like: Accessor): Accessor {
    return createAccessor(this.#document, new Float32Array(3 * like.getCount()), 'VEC3').setSparse(true);
  }

  /** The texture, which the document only gets if something shows it. */
  #shown(): Texture {
    const { name, mimeType, bytes } = this.#paint;
    this.#texture ??= this.#document
      .createTexture(name)
      .setMimeType(mimeType)
      .setImage(bytes as Uint8Array<ArrayBuffer>);
    return this.#texture;
  }

  /** A material that shows the texture, lit as the base's material is. */
  #material(primitive: Primitive, overlay: Primitive): Material {
    const base = primitive.getMaterial();
    const unlit = base?.getExtension<ExtensionProperty>(unlitExtension) ?? null;
    const finish: Finish = {
      mode: 'BLEND',
      inPlace: false,
      roughness: base?.getRoughnessFactor() ?? 1,
      metalness: metalnessOf(
        base?.getMetallicFactor(),
        base?.listExtensions().map(({ extensionName }) => extensionName) ?? [],
      ),
      doubleSided: base?.getDoubleSided() ?? false,
      alpha: base?.getAlphaMode() === 'BLEND' ? base.getAlpha() : 1,
      unlit: unlit !== null,
    };
    const lit = unlit ? [] : mapsOn(primitive, overlay);
    // Its maps are those of one material.
    const maps = lit.length > 0 && [lit.length, this.#document.getRoot().listMaterials().indexOf(base!)];
    const key = JSON.stringify([finish, maps]);
    const known = this.#materials.get(key);
    if (known) return known;
    const material = this.#document
      .createMaterial('Cagecast overlay')
      .setExtras({ ...overlayMark })
      .setAlphaMode('BLEND')
      .setAlpha(finish.alpha)
      .setDoubleSided(finish.doubleSided)
      .setMetallicFactor(finish.metalness)
      .setRoughnessFactor(finish.roughness)
      .setBaseColorTexture(this.#shown());
    if (unlit) material.setExtension(unlitExtension, unlit);
    for (const setMap of lit) setMap(material);
    this.#materials.set(key, material);
    return material;
  }
}

/** Lays a texture by a UV set, whatever a transform of its own says. */
function putAt(info: TextureInfo, set: number): void {
  info.setTexCoord(set);
  const transform = info.getExtension<ExtensionProperty & { setTexCoord(set: number | null): ExtensionProperty }>(
    'KHR_texture_transform',
  );
  if (transform) info.setExtension('KHR_texture_transform', transform.clone().setTexCoord(null));
}

/** Gives a material the maps that light a base, and the overlay their UVs and tangents. */
function mapsOn(primitive: Primitive, overlay: Primitive): ((material: Material) => void)[] {
  const base = primitive.getMaterial();
  const sets: string[] = [];
  const on = (
    texture: Texture | null | undefined,
    info: TextureInfo | null | undefined,
    set: (material: Material, texture: Texture) => TextureInfo,
  ): ((material: Material) => void)[] => {
    const { set: name } = uvLayoutOf(info ? { index: 0, ...infoOf(info) } : undefined);
    const uvs = texture && info && primitive.getAttribute(name);
    if (!texture || !info || !uvs) return [];
    if (!sets.includes(name)) sets.push(name);
    const at = 1 + sets.indexOf(name);
    overlay.setAttribute(`TEXCOORD_${at}`, uvs);
    return [(material) => putAt(set(material, texture).copy(info), at)];
  };
  const normal = on(
    base?.getNormalTexture(),
    base?.getNormalTextureInfo(),
    (material, texture) =>
      material.setNormalTexture(texture).setNormalScale(base!.getNormalScale()).getNormalTextureInfo()!,
  );
  if (normal.length > 0) overlay.setAttribute('TANGENT', primitive.getAttribute('TANGENT'));
  return [
    ...normal,
    ...on(
      base?.getOcclusionTexture(),
      base?.getOcclusionTextureInfo(),
      (material, texture) =>
        material
          .setOcclusionTexture(texture)
          .setOcclusionStrength(base!.getOcclusionStrength())
          .getOcclusionTextureInfo()!,
    ),
    ...on(
      base?.getMetallicRoughnessTexture(),
      base?.getMetallicRoughnessTextureInfo(),
      (material, texture) => material.setMetallicRoughnessTexture(texture).getMetallicRoughnessTextureInfo()!,
    ),
    ...glowOn(base, on),
  ];
}

/** Gives a material the base's own light: paint does not hide it. */
function glowOn(
  base: Material | null,
  on: (
    texture: Texture | null | undefined,
    info: TextureInfo | null | undefined,
    set: (material: Material, texture: Texture) => TextureInfo,
  ) => ((material: Material) => void)[],
): ((material: Material) => void)[] {
  if (!base?.getEmissiveFactor().some((one) => one > 0)) return [];
  const texture = on(
    base.getEmissiveTexture(),
    base.getEmissiveTextureInfo(),
    (material, texture) => material.setEmissiveTexture(texture).getEmissiveTextureInfo()!,
  );
  if (base.getEmissiveTexture() && texture.length === 0) return [];
  const strength = base.getExtension<ExtensionProperty>(emissiveExtension);
  return [
    ...texture,
    (material) => void material.setEmissiveFactor(base.getEmissiveFactor()).setExtension(emissiveExtension, strength),
  ];
}
