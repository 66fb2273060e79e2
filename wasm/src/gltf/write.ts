import type { GLTF } from '@gltf-transform/core';
import type { CutTarget } from '../api/cut-borders.js';
import type { TransferResult } from '../api/result.js';
import { type Blends, blend, blendSkin, noBlends, ruleOf } from '../parts/blend.js';
import { cutPart } from '../parts/cut-part.js';
import { gather, type SplitPart, splitPart } from '../parts/split-part.js';
import { dracoOf } from './check.js';
import type { Extracted, Part } from './extract.js';
import { GlbWriter } from './glb-writer.js';
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
import { cutPiece, decodeFloats, type Piece } from './pieces.js';
import type { GltfFile } from './read.js';

/** What was added to a primitive. */
export interface Added {
  /** The name of the new UV set: the first one that was free. */
  uvSet: string;
  /** Triangles of the overlay; 0 if there is none. */
  overlayTriangles: number;
  /** Number of vertices added because corners at the same vertex have different UVs. */
  splitVertices: number;
  /** Number of triangles added by cutting. */
  cutTriangles: number;
}

/**
 * Writes the target with the result of a transfer: every primitive gets a new UV set and `_NCZ` and, with a texture, an overlay
 * primitive of its cosmetic triangles. All other contents of the file stay unchanged, including compression. If triangles at the
 * same vertex have different UVs, copies of the vertex with all its attributes are added after the existing vertices, and the
 * primitive is no longer compressed by Draco. New vertices of a cut target are added in the same way, as blends of their sources.
 * If several nodes share a mesh, each gets a copy.
 * @param cut  The cut target that `cutBorders` made from `result`, if any.
 * @returns the bytes of a GLB, and what was added to each part.
 * @throws {InputError} if an image beside the target cannot be read.
 */
export async function writeTransfer(
  file: GltfFile,
  { mesh, parts }: Extracted,
  result: Pick<TransferResult, 'uvs' | 'cornerUvs' | 'zones' | 'cosmeticTriangles'>,
  paint?: Paint,
  cut?: CutTarget,
): Promise<{ glb: Uint8Array; added: Added[] }> {
  const writer = await GlbWriter.from(file);
  const { json } = writer;
  const meshOfNode = separateMeshes(json, parts);
  const painter = paint && new Painter(writer, file, paint, overlayOffset * diagonal(mesh.positions));

  const added = parts.map((part) => {
    const primitives = json.meshes![meshOfNode.get(part.node)!]!.primitives;
    const primitive = primitives[part.primitive]!;
    const whole = { ...part, turned: isTurned(part.matrix) };
    const {
      geometry,
      result: own,
      blends,
    } = cut ? cutPart(whole, cut, mesh.positions.length / 3) : { geometry: whole, result, blends: noBlends };
    const split = splitPart(geometry, own);
    if (split.copies > 0 || blends.sources.length > 0) rewritePrimitive(writer, file, primitive, split, blends);
    const zones = own.zones.subarray(geometry.firstVertex, geometry.firstVertex + geometry.vertexCount);
    const uvSet = freeUvSet((semantic) => primitive.attributes[semantic] !== undefined);
    const uvAccessor = writer.addAttribute(split.uvs, 2);
    primitive.attributes[uvSet] = uvAccessor;
    primitive.attributes[zoneAttribute] = writer.addAttribute(
      Float32Array.from(split.sources, (v) => zones[v]!),
      1,
    );
    const cosmetic = own.cosmeticTriangles.subarray(
      geometry.firstTriangle,
      geometry.firstTriangle + geometry.triangleCount,
    );
    const overlay = painter?.overlay(
      cut ? cutPiece(part, geometry, blend(part.localPositions, 3, blends)) : part,
      split,
      primitive,
      cosmetic,
      uvAccessor,
    );
    if (overlay) primitives.push(overlay);
    return {
      uvSet,
      overlayTriangles: overlay ? cosmetic.reduce((sum, one) => sum + one, 0) : 0,
      splitVertices: split.copies,
      cutTriangles: geometry.triangleCount - part.triangleCount,
    };
  });
  dropDraco(json);
  return { glb: writer.finish(), added };
}

/** Adds new vertices, blends and copies, to all attributes and morph targets of a primitive, uncompressed. */
function rewritePrimitive(
  writer: GlbWriter,
  file: GltfFile,
  primitive: GLTF.IMeshPrimitive,
  { sources, indices }: SplitPart,
  blends: Blends,
): void {
  const decodedOf = (accessor: number) => file.geometry.getRoot().listAccessors()[accessor]!;
  const skin = blendSkin(
    (semantic) =>
      primitive.attributes[semantic] === undefined ? undefined : decodedOf(primitive.attributes[semantic]).getArray()!,
    blends,
  );
  const made = new Map<string, number>();
  const rewrite = (accessor: number, semantic: string, isDelta: boolean): number => {
    const decoded = decodedOf(accessor);
    const { normalized, min, name, extras } = file.json.accessors![accessor]!;
    const size = decoded.getElementSize();
    const array = decoded.getArray()!;
    const rule = isDelta ? 'mean' : ruleOf(semantic, array, normalized ?? false);
    const pulls = isDelta ? undefined : skin.get(semantic);
    const key = `${accessor} ${pulls ? semantic : rule}`;
    const known = made.get(key);
    if (known !== undefined) return known;
    const values = gather(pulls ?? blend(array, size, blends, rule), size, sources);
    // Draco has rounded the values, so the bounds in the file may be wrong.
    const more = {
      type: decoded.getType(),
      ...(normalized && { normalized }),
      ...(min && boundsOf(values, size)),
      ...(name !== undefined && { name }),
      ...(extras && { extras }),
    };
    const number = writer.addAttribute(values, size, more);
    made.set(key, number);
    return number;
  };
  const rewriteAll = (attributes: Record<string, number>, isDelta: boolean) => {
    for (const [semantic, accessor] of Object.entries(attributes))
      attributes[semantic] = rewrite(accessor, semantic, isDelta);
  };
  rewriteAll(primitive.attributes, false);
  primitive.targets?.forEach((deltas) => rewriteAll(deltas, true));
  primitive.indices = writer.addIndices(indices, sources.length);
  delete primitive.mode; // strips and fans have become lists
  delete primitive.extensions?.[draco];
  if (primitive.extensions && Object.keys(primitive.extensions).length === 0) delete primitive.extensions;
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

const draco = 'KHR_draco_mesh_compression';

/** Removes the Draco extension from the file's lists if no primitive uses it any more. */
function dropDraco(json: GLTF.IGLTF): void {
  if (json.meshes?.some(({ primitives }) => primitives.some(dracoOf))) return;
  for (const list of ['extensionsUsed', 'extensionsRequired'] as const) {
    const left = json[list]?.filter((name) => name !== draco);
    if (left?.length === 0) delete json[list];
    else if (left) json[list] = left;
  }
}

/**
 * Gives every node of the transfer a mesh of its own. Other nodes, such as those of other scenes, share an unchanged copy. The first
 * node with a mesh keeps the original. Animations of a mesh are repeated for its copies.
 * @returns the mesh of each node.
 */
function separateMeshes(json: GLTF.IGLTF, parts: Part[]): Map<number, number> {
  const copy = (mesh: number): number => {
    const number = json.meshes!.push(structuredClone(json.meshes![mesh]!)) - 1;
    for (const { channels } of json.animations ?? []) {
      for (const channel of [...(channels ?? [])]) {
        const pointerOf = ({ target }: GLTF.IAnimationChannel) =>
          target?.extensions?.['KHR_animation_pointer'] as { pointer?: unknown } | undefined;
        const pointer = pointerOf(channel)?.pointer;
        const place = `/meshes/${mesh}/`;
        if (typeof pointer !== 'string' || !pointer.startsWith(place)) continue;
        const twin = structuredClone(channel);
        pointerOf(twin)!.pointer = `/meshes/${number}/${pointer.slice(place.length)}`;
        channels.push(twin);
      }
    }
    return number;
  };
  const meshOfNode = new Map<number, number>();
  const taken = new Set<number>();
  for (const { node, mesh } of parts) {
    if (meshOfNode.has(node)) continue;
    meshOfNode.set(node, taken.has(mesh) ? copy(mesh) : mesh);
    taken.add(mesh);
  }
  const untouched = new Map<number, number>();
  json.nodes?.forEach((node, n) => {
    const own = meshOfNode.get(n);
    if (own !== undefined) node.mesh = own;
    else if (node.mesh !== undefined && taken.has(node.mesh)) {
      if (!untouched.has(node.mesh)) untouched.set(node.mesh, copy(node.mesh));
      node.mesh = untouched.get(node.mesh)!;
    }
  });
  return meshOfNode;
}

/** Makes the overlays that show a texture. */
class Painter {
  readonly #writer: GlbWriter;
  readonly #file: GltfFile;
  readonly #texture: number;
  readonly #offset: number;
  readonly #materials = new Map<string, number>();

  /** @param offset  The distance of overlays from the surface, in units of the scene. */
  constructor(writer: GlbWriter, file: GltfFile, paint: Paint, offset: number) {
    this.#writer = writer;
    this.#file = file;
    this.#texture = writer.addTexture(paint.bytes, paint.mimeType, paint.name);
    this.#offset = offset;
  }

  /** A primitive of the cosmetic triangles of `base`, with the same skin and morph targets; `undefined` if there are none. */
  overlay(
    piece: Piece,
    { sources, indices }: SplitPart,
    base: GLTF.IMeshPrimitive,
    cosmetic: Uint8Array,
    uvAccessor: number,
  ): GLTF.IMeshPrimitive | undefined {
    const corners = cosmeticCorners(indices, cosmetic);
    if (corners.length === 0) return undefined;
    const attributes: Record<string, number> = { POSITION: this.#positions(piece, sources), TEXCOORD_0: uvAccessor };
    for (const [semantic, accessor] of Object.entries(base.attributes)) {
      if (isOverlaid(semantic)) attributes[semantic] = this.#shared(base, semantic, accessor);
    }
    return {
      attributes,
      indices: this.#writer.addIndices(corners, sources.length),
      material: this.#material(base),
      ...(base.targets && {
        targets: base.targets.map((deltas) => this.#morph(deltas, 'NORMAL' in attributes, sources.length)),
      }),
      extras: overlayMark,
    };
  }

  /** What a morph target of the base is to the overlay. One without anything in it is not allowed: it moves nothing then. */
  #morph(deltas: Record<string, number>, hasNormals: boolean, count: number): Record<string, number> {
    const own = Object.entries(deltas).filter(([semantic]) => isMorphed(semantic, hasNormals));
    return own.length > 0
      ? Object.fromEntries(own)
      : { POSITION: this.#writer.addAttribute(new Float32Array(3 * count), 3, { min: [0, 0, 0], max: [0, 0, 0] }) };
  }

  /** The base's own accessor, or, where it has no bytes because they are in a Draco stream, a decoded copy. */
  #shared(base: GLTF.IMeshPrimitive, semantic: string, accessor: number): number {
    if (dracoOf(base)?.attributes[semantic] === undefined) return accessor;
    const decoded = this.#file.geometry.getRoot().listAccessors()[accessor]!;
    const size = decoded.getElementSize() as 1 | 2 | 3 | 4;
    const array = decoded.getArray();
    return semantic.startsWith('JOINTS') && (array instanceof Uint8Array || array instanceof Uint16Array)
      ? this.#writer.addAttribute(array, size)
      : this.#writer.addAttribute(decodeFloats(decoded), size);
  }

  /** The piece's positions, moved a little off the surface along their normals. */
  #positions(piece: Piece, sources: Uint32Array): number {
    const positions = gather(overlayPositions(piece, this.#offset), 3, sources);
    return this.#writer.addAttribute(positions, 3, boundsOf(positions, 3));
  }

  /** A material that shows the texture, with the roughness and sidedness of the base's material. */
  #material(base: GLTF.IMeshPrimitive): number {
    const { json } = this.#writer;
    const source = base.material === undefined ? undefined : json.materials?.[base.material];
    const roughnessFactor = source?.pbrMetallicRoughness?.roughnessFactor ?? 1;
    const doubleSided = source?.doubleSided ?? false;
    const key = `${roughnessFactor} ${doubleSided}`;
    let number = this.#materials.get(key);
    if (number === undefined) {
      number =
        (json.materials ??= []).push({
          name: 'Cagecast overlay',
          alphaMode: 'BLEND',
          doubleSided,
          pbrMetallicRoughness: { baseColorTexture: { index: this.#texture }, metallicFactor: 0, roughnessFactor },
        }) - 1;
      this.#materials.set(key, number);
    }
    return number;
  }
}
