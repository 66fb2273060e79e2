import type { GLTF } from '@gltf-transform/core';
import { applySplit, ruleOf, splitSkin } from '../parts/blend.js';
import type { PreparedPart } from '../parts/prepare.js';
import type { Extracted, Part } from '../scene/extract.js';
import { unlitExtension } from '../scene/materials.js';
import { type InPlace, overlayMark } from '../scene/overlay-mark.js';
import { dracoOf } from './checks/check-geometry.js';
import { removeAttributes, removeOverlays } from './earlier-in-file.js';
import { type Form, GlbWriter } from './glb-writer.js';
import type { GltfFile } from './open-gltf.js';
import { dracoExtension, markForDraco, unmarkDraco } from './output/draco-marks.js';
import type { NamedFile } from './output/pack-gltf.js';
import { separateMeshes } from './output/separate-meshes.js';
import { addMaterial, isOutlined } from './output/vrm-materials.js';
import {
  type BaseMaps,
  baseMaps,
  type Finish,
  freeUvSet,
  isMorphed,
  isOverlaid,
  isShown,
  metalnessOf,
  type OverlaidLook,
  type Paint,
  uvsMark,
  zoneAttribute,
} from './overlay.js';
import { type SharedVertices, shareVertices, storedUvs } from './primitive-group.js';

/** What was added to a primitive. */
export interface Added {
  /** The name of the new UV set: the first one that was free. */
  uvSet: string;
  /** Triangles of the overlay; 0 if there is none. */
  overlayTriangles: number;
  /** Whether the overlay also covers what the material beneath it cuts out by the alpha of its texture. */
  fillsCutOuts: boolean;
  /** Number of vertices added because corners at the same vertex have different UVs. */
  splitVertices: number;
  /** Number of triangles added by cutting. */
  cutTriangles: number;
}

/** How a target is written. */
interface Writing {
  /** Textures, each on its own triangles. Default: none */
  paints?: readonly Paint[];
  /** The form of the geometry. Default: that of the file */
  form?: Form;
  /** Compresses by Draco what is marked for it. Needed if the file, or the form, is of Draco */
  packDraco?: (writer: GlbWriter, file: GltfFile) => Promise<void>;
  /** The name of the attribute with the zones. Default: `_NCZ` */
  zones?: string;
  /** Whether primitives get the UVs and zones as attributes; else only overlays have UVs. Default: yes */
  hasAttributes?: boolean;
  /** Whether it adds to what another cage painted of the same target, instead of replacing it. Default: no */
  isFurther?: boolean;
  /** Writes a glTF of text, whose file is named so, with files beside it. Default: a GLB */
  stem?: string | undefined;
}

/**
 * Writes the target with what a transfer made of its parts: every primitive gets a new UV set and `_NCZ` and, with a texture, an
 * overlay primitive of its cosmetic triangles. All other contents of the file stay unchanged, including compression. If triangles at the
 * same vertex have different UVs, copies of the vertex with all its attributes are added after the existing vertices. New vertices
 * of a cut target are added in the same way, as blends of their sources. An earlier transfer is replaced. What is replaced is dropped
 * from the file, and its replacement has the same form: sparse, quantised, or compressed by meshopt or Draco. If several nodes share
 * a mesh, each gets a copy.
 * @returns the bytes of the file, what belongs beside it, what was added to each part, and how many overlays were replaced.
 * @throws {InputError} if an image beside the target cannot be read.
 */
export async function writeTransfer(
  file: GltfFile,
  { parts }: Extracted,
  prepared: readonly PreparedPart[],
  { paints = [], form = 'keep', packDraco, isFurther = false, stem, ...rest }: Writing = {},
): Promise<{ data: Uint8Array; beside: NamedFile[]; added: Added[]; replaced: number }> {
  const writer = await GlbWriter.from(file, form);
  const { json } = writer;
  const meshOfNode = separateMeshes(json, parts);
  const meshes = parts.map(({ node }) => json.meshes![meshOfNode.get(node)!]!);
  const primitives = parts.map(({ primitive }, p) => meshes[p]!.primitives[primitive]!);
  const replaced = isFurther ? 0 : removeOverlays(writer, file, meshes);
  if (!isFurther) removeAttributes(writer, primitives);
  const overlays = paints.map((paint) => new OverlayWriter(writer, paint));

  const members = parts.map((part, p): Member => {
    const member = prepared[p]!;
    const cutTriangles = member.cosmeticTriangles.length - part.triangleCount;
    const added = { uvSet: '', overlayTriangles: 0, fillsCutOuts: false, splitVertices: 0, cutTriangles };
    return { ...member, primitives: meshes[p]!.primitives, primitive: primitives[p]!, part, added };
  });
  if (form === 'draco') markForDraco(primitives);
  const { zones = zoneAttribute, hasAttributes = true } = rest;
  for (const group of groupsOf(members)) addToGroup(writer, file, group, { overlays, form, zones, hasAttributes });
  if ((json.meshes ?? []).some((mesh) => mesh.primitives.some(dracoOf))) writer.requireExtension(dracoExtension);
  else writer.unlistExtension(dracoExtension);
  await packDraco?.(writer, file);
  const added = members.map((member) => member.added);
  if (stem === undefined) return { data: writer.finish(), beside: [], added, replaced };
  const { text, beside } = writer.finishText(stem);
  return { data: text, beside, added, replaced };
}

/** A part, and what it becomes. */
interface Member extends PreparedPart {
  /** Those of its mesh. */
  primitives: GLTF.IMeshPrimitive[];
  primitive: GLTF.IMeshPrimitive;
  part: Part;
  added: Added;
}

/** The parts by the attributes that their primitives share. */
function groupsOf(members: readonly Member[]): Member[][] {
  const groups = new Map<GLTF.IMeshPrimitive[], Map<string, Member[]>>();
  for (const member of members) {
    const { attributes, targets } = member.primitive;
    const ofMesh = groups.get(member.primitives) ?? new Map<string, Member[]>();
    groups.set(member.primitives, ofMesh);
    const key = dracoOf(member.primitive) ? String(ofMesh.size) : JSON.stringify([attributes, targets]);
    ofMesh.set(key, [...(ofMesh.get(key) ?? []), member]);
  }
  return [...groups.values()].flatMap((ofMesh) => [...ofMesh.values()]);
}

/** Adds UVs, zones and overlays to primitives that share their attributes. */
function addToGroup(
  writer: GlbWriter,
  file: GltfFile,
  members: readonly Member[],
  {
    overlays,
    form,
    zones,
    hasAttributes,
  }: { overlays: readonly OverlayWriter[]; form: Form; zones: string; hasAttributes: boolean },
): void {
  if (!hasAttributes && form === 'keep' && members.every(({ cosmeticTriangles }) => !cosmeticTriangles.includes(1)))
    return;
  const { primitive: first, part } = members[0]!;
  const shared = shareVertices(part.vertexCount, members);
  const isNew = shared.isNew || form !== 'keep';
  const own = members.map(({ primitive }) => primitive);
  if (isNew) rewriteAttributes(writer, file, own, shared);
  if (form === 'none' || form === 'meshopt') unmarkDraco(own);
  const uvSet = freeUvSet((semantic) => first.attributes[semantic] !== undefined);
  const uvs = storedUvs(shared.uvs);
  const attributes = {
    [uvSet]: writer.addAttribute(uvs, 2, {
      ...(uvs instanceof Uint16Array && { normalized: true }),
      extras: uvsMark,
    }),
    [zones]: writer.addAttribute(shared.zones, 1, {}, true),
  };
  let { copies } = shared;
  members.forEach((member, m) => {
    const { primitive, primitives, cosmeticTriangles, added } = member;
    if (hasAttributes) Object.assign(primitive.attributes, attributes);
    const isReplaceable = mayReplace(writer.json, primitive);
    const indices = shared.indices[m]!;
    const cornersAt = (t: number) => [indices[3 * t]!, indices[3 * t + 1]!, indices[3 * t + 2]!] as const;
    const isTaken = new Uint8Array(cosmeticTriangles.length);
    let left = isTaken.length;
    const base = primitives.indexOf(primitive);
    for (const overlay of overlays) {
      const { area, hides } = overlay.paint;
      const triangles = Uint32Array.from(cosmeticTriangles.keys()).filter(
        (t) => cosmeticTriangles[t] && isShown(area, shared.uvs, ...cornersAt(t)),
      );
      if (triangles.length === 0) continue;
      const hidden = triangles.filter((t) => {
        // A primitive has at least one triangle.
        if (left === 1 || isTaken[t] || !isReplaceable || !hides?.(shared.uvs, ...cornersAt(t))) return false;
        isTaken[t] = 1;
        --left;
        return true;
      });
      let rest = triangles.filter((t) => !isTaken[t]);
      if (overlay.paint.look && !dracoOf(primitive) && !primitive.extensions?.['KHR_materials_variants']) {
        const some = rest.slice(0, Math.min(rest.length, left - 1));
        for (const t of some) isTaken[t] = 1;
        left -= some.length;
        if (some.length > 0) {
          const made = overlay.surface(primitive, cornersOf(indices, some), attributes[uvSet]!, base);
          primitives.push(made.primitive);
          if (made.hasColors) rest = rest.slice(some.length);
        }
      }
      for (const [some, inPlaceOf] of [[hidden, base], [rest]] as const)
        if (some.length > 0)
          primitives.push(overlay.primitive(primitive, cornersOf(indices, some), attributes[uvSet]!, inPlaceOf));
      added.overlayTriangles += triangles.length;
      added.fillsCutOuts = cutsOut(writer.json.materials?.[primitive.material ?? -1]);
    }
    added.uvSet = uvSet;
    added.splitVertices = copies;
    copies = 0; // counted once
    // Draco's streams are of indexed triangles.
    const isWhole = left === isTaken.length;
    if (!isNew && isWhole && (primitive.indices !== undefined || !dracoOf(primitive))) return;
    primitive.indices = writer.addIndices(
      shared.indices[m]!.filter((_, i) => !isTaken[Math.floor(i / 3)]),
      shared.sources.length,
    );
    delete primitive.mode; // strips and fans have become lists
  });
}

/** Whether the alpha of its texture may leave parts of a material out, which core glTF cannot say of an overlay. */
const cutsOut = ({ alphaMode, pbrMetallicRoughness }: GLTF.IMaterial = {}): boolean =>
  alphaMode === 'MASK' || (alphaMode === 'BLEND' && pbrMetallicRoughness?.baseColorTexture !== undefined);

/**
 * Whether overlays can be drawn in place of triangles of a primitive. Not where its texture may be transparent, where its outline is drawn
 * by its triangles, and where these are in a stream of Draco.
 */
function mayReplace(json: GLTF.IGLTF, primitive: GLTF.IMeshPrimitive): boolean {
  const { mappings = [] } = (primitive.extensions?.['KHR_materials_variants'] ?? {}) as {
    mappings?: { material: number }[];
  };
  const all = [primitive.material, ...mappings.map(({ material }) => material)];
  return (
    dracoOf(primitive) === undefined &&
    !all.some((one) => cutsOut(json.materials?.[one ?? -1]) || isOutlined(json, one))
  );
}

/** The corners of triangles. @param indices  Of all triangles. */
const cornersOf = (indices: Uint32Array, triangles: Uint32Array): Uint32Array =>
  new Uint32Array(3 * triangles.length).map((_, i) => indices[3 * triangles[Math.floor(i / 3)]! + (i % 3)]!);

/** Adds new vertices, blends and copies, to all attributes and morph targets that primitives share. */
function rewriteAttributes(
  writer: GlbWriter,
  file: GltfFile,
  primitives: readonly GLTF.IMeshPrimitive[],
  shared: SharedVertices,
): void {
  const { attributes, targets } = primitives[0]!;
  const skin = splitSkin(
    (semantic) => (attributes[semantic] === undefined ? undefined : file.accessors[attributes[semantic]]!.getArray()!),
    shared,
  );
  // With other forms, primitives are marked that were not compressed.
  const fromDraco = primitives.some((primitive) => (dracoOf(primitive)?.bufferView ?? -1) >= 0);
  const made = new Map<string, number>();
  const rewrite = (accessor: number, semantic: string, isDelta: boolean): number => {
    const decoded = file.accessors[accessor]!;
    const { normalized, min, name, extras, sparse, bufferView } = file.json.accessors![accessor]!;
    const size = decoded.getElementSize();
    const array = decoded.getArray()!;
    const rule = isDelta ? 'mean' : ruleOf(semantic, array, normalized ?? false);
    const pulls = isDelta ? undefined : skin.get(semantic);
    const key = `${accessor} ${pulls ? semantic : rule}`;
    const known = made.get(key);
    if (known !== undefined) return known;
    const values = pulls ?? applySplit(array, size, shared, rule);
    // Draco has rounded the values, so the bounds in the file may be wrong.
    const more = {
      type: decoded.getType(),
      ...(normalized && { normalized }),
      ...(min && boundsOf(values, size)),
      ...(name !== undefined && { name }),
      ...(extras && { extras }),
    };
    const wasSparse = sparse !== undefined || (bufferView === undefined && !fromDraco);
    const number = writer.addAttribute(values, size, more, wasSparse);
    made.set(key, number);
    return number;
  };
  const rewriteAll = (of: Record<string, number>, isDelta: boolean) =>
    Object.fromEntries(
      Object.entries(of).map(([semantic, accessor]) => [semantic, rewrite(accessor, semantic, isDelta)]),
    );
  const ownAttributes = rewriteAll(attributes, false);
  const ownTargets = targets?.map((deltas) => rewriteAll(deltas, true));
  for (const primitive of primitives) {
    primitive.attributes = { ...ownAttributes };
    if (ownTargets) primitive.targets = ownTargets.map((deltas) => ({ ...deltas }));
  }
}

/** The least and the greatest value of each component. */
function boundsOf(values: ArrayLike<number>, size: number): { min: number[]; max: number[] } {
  const min = new Array<number>(size).fill(Infinity);
  const max = new Array<number>(size).fill(-Infinity);
  for (let i = 0; i < values.length; ++i) {
    min[i % size] = Math.min(min[i % size]!, values[i]!);
    max[i % size] = Math.max(max[i % size]!, values[i]!);
  }
  return { min, max };
}

/** Writes overlays that show a texture. */
class OverlayWriter {
  readonly #writer: GlbWriter;
  readonly paint: Paint;
  #texture: number | undefined;
  readonly #materials = new Map<string, number>();
  /** Copies of materials, by the numbers of these and the UVs. */
  readonly #surfaces = new Map<string, ReturnType<OverlaidLook['addSurface']>>();

  constructor(writer: GlbWriter, paint: Paint) {
    this.#writer = writer;
    this.paint = paint;
  }

  /**
   * A primitive of some triangles of `base`, with the same vertices, skin and morph targets.
   * @param uvs        Its UVs' accessor.
   * @param inPlaceOf  The number of `base`, if this does not have them any more.
   */
  primitive(base: GLTF.IMeshPrimitive, corners: Uint32Array, uvs: number, inPlaceOf?: number): GLTF.IMeshPrimitive {
    const attributes: Record<string, number> = { TEXCOORD_0: uvs };
    for (const [semantic, accessor] of Object.entries(base.attributes))
      if (isOverlaid(semantic)) attributes[semantic] = accessor;
    const lit = baseMaps(this.#materialOf(base), (semantic) => base.attributes[semantic] !== undefined);
    lit.sets.forEach((set, i) => (attributes[`TEXCOORD_${1 + i}`] = base.attributes[set]!));
    const tangents = base.attributes['TANGENT'];
    if (lit.maps.normalTexture && tangents !== undefined) attributes['TANGENT'] = tangents;
    const { count } = this.#writer.json.accessors![uvs]!;
    return {
      attributes,
      indices: this.#writer.addIndices(corners, count),
      material: this.#material(base, lit, inPlaceOf !== undefined),
      ...(base.targets && {
        targets: base.targets.map((deltas) =>
          this.#morph(deltas, count, (one) => isMorphed(one, 'NORMAL' in attributes)),
        ),
      }),
      ...(dracoOf(base) && { extensions: { [dracoExtension]: dracoOf(base) } }),
      extras: { ...overlayMark, ...(inPlaceOf !== undefined && ({ cagecastInPlaceOf: inPlaceOf } satisfies InPlace)) },
    };
  }

  /**
   * Adds a primitive with triangles of `base` in its place: its surface, as a look has it beneath the colours.
   * @returns it, and whether it shows the colours, too.
   */
  surface(
    base: GLTF.IMeshPrimitive,
    corners: Uint32Array,
    uvs: number,
    inPlaceOf: number,
  ): { primitive: GLTF.IMeshPrimitive; hasColors: boolean } {
    const { material, attributes } = base;
    const set = freeUvSet((semantic) => attributes[semantic] !== undefined);
    const key = JSON.stringify([material, set]);
    const copy =
      this.#surfaces.get(key) ??
      this.paint.look!.addSurface(this.#writer, material, Number(set.slice('TEXCOORD_'.length)));
    this.#surfaces.set(key, copy);
    // Tangents are those of other UVs.
    const { TANGENT: _, ...others } = attributes;
    const { count } = this.#writer.json.accessors![uvs]!;
    const own = structuredClone(base);
    const targets =
      copy.hasRelief && own.targets?.map((deltas) => this.#morph(deltas, count, (one) => one !== 'TANGENT'));
    const primitive = {
      ...own,
      ...(targets && { targets }),
      attributes: { ...(copy.hasRelief ? others : attributes), [set]: uvs },
      indices: this.#writer.addIndices(corners, count),
      material: copy.number,
      extras: { ...overlayMark, cagecastInPlaceOf: inPlaceOf } satisfies InPlace,
    };
    return { primitive, hasColors: copy.hasColors };
  }

  /** What is left of a morph target. One without anything in it is not allowed: it moves nothing then. */
  #morph(deltas: Record<string, number>, count: number, keeps: (semantic: string) => boolean): Record<string, number> {
    const own = Object.entries(deltas).filter(([semantic]) => keeps(semantic));
    if (own.length > 0) return Object.fromEntries(own);
    const still = { min: [0, 0, 0], max: [0, 0, 0] };
    return { POSITION: this.#writer.addAttribute(new Float32Array(3 * count), 3, still, true) };
  }

  /** The texture, which is only written if something shows it. */
  #shown(): number {
    this.#texture ??= this.#writer.addTexture(this.paint, this.paint.area === 'bounded');
    return this.#texture;
  }

  /** A material that shows the texture, lit as the base's material is. */
  #material(base: GLTF.IMeshPrimitive, { maps, rough }: BaseMaps, inPlace: boolean): number {
    const { json } = this.#writer;
    const source = this.#materialOf(base);
    const { roughnessFactor = 1, metallicFactor, baseColorFactor } = source?.pbrMetallicRoughness ?? {};
    const isClear = source?.alphaMode === 'BLEND';
    const finish: Finish = {
      mode: inPlace && !isClear ? 'OPAQUE' : 'BLEND',
      inPlace,
      roughness: roughnessFactor,
      metalness: metalnessOf(metallicFactor, Object.keys(source?.extensions ?? {})),
      doubleSided: source?.doubleSided ?? false,
      alpha: isClear ? (baseColorFactor?.[3] ?? 1) : 1,
      unlit: source?.extensions?.[unlitExtension] !== undefined,
    };
    const { look } = this.paint;
    const key = JSON.stringify([finish, maps, rough, look && base.material]);
    const made = () => {
      const material = { ...this.#made(finish, rough), ...maps };
      look?.lay(this.#writer, material, base.material);
      return material;
    };
    const number = this.#materials.get(key) ?? addMaterial(json, made());
    this.#materials.set(key, number);
    return number;
  }

  #materialOf = ({ material = -1 }: GLTF.IMeshPrimitive) => this.#writer.json.materials?.[material];

  #made(
    { mode, inPlace, roughness, metalness, doubleSided, alpha, unlit }: Finish,
    rough: BaseMaps['rough'],
  ): GLTF.IMaterial {
    return {
      name: 'Cagecast overlay',
      extras: { ...overlayMark, ...(inPlace && { cagecastInPlace: true }) },
      ...(mode !== 'OPAQUE' && { alphaMode: mode }),
      doubleSided,
      pbrMetallicRoughness: {
        baseColorTexture: { index: this.#shown() },
        ...(alpha < 1 && { baseColorFactor: [1, 1, 1, alpha] }),
        roughnessFactor: roughness,
        metallicFactor: metalness,
        ...rough,
      },
      // The base has it, so the file names it already.
      ...(unlit && { extensions: { [unlitExtension]: {} } }),
    };
  }
}
