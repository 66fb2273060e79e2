import type { GLTF } from '@gltf-transform/core';
import type { Mesh } from '../api/mesh.js';
import type { NamedPart, Parts } from '../api/parts.js';
import { show } from '../core/error.js';
import type { Vector } from '../inspect/geometry.js';
import { identity, type Matrix, multiply } from '../parts/affine.js';
import {
  type Chosen,
  chooseParts,
  type IsMeant,
  isClear,
  type LeftOut,
  type Look,
  largestAlpha,
  visibilityExtension,
} from '../parts/drawn.js';
import type { VrmExtensions } from '../parts/joints.js';
import { vrmExpressions } from '../parts/morph-names.js';
import { kSceneOrigin, type Origin } from '../parts/origin.js';
import { type MorphedPart, type MorphTarget, posesOf } from '../parts/poses.js';
import { placeMeshes, type Skin } from '../parts/skin.js';
import { type AccessorData, decodeFloats } from './accessor.js';
import { InputError, naming } from './input-error.js';
import { firstInstance, instancing } from './instancing.js';
import { isOverlay, overlaysInPlaceOf } from './overlay-mark.js';
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
} from './pieces.js';
import { aboveIn, parentsOf, roots, type SceneSource, worldMatrices } from './source.js';
import { type UvLayout, uvLayoutOf } from './uv-layout.js';
import { chooseUvSet, rankOf, type UvSet, uvSetNames } from './uv-sets.js';

/** A primitive, by the numbers of its mesh and itself in the file's JSON. */
interface PrimitiveRef {
  mesh: number;
  primitive: number;
}

/** A piece, and where it is in the file's JSON. */
export interface Part extends Piece, PrimitiveRef {
  node: number;
}

/** The triangles of a glTF's scene as arrays, and the parts that they come from. */
export interface Extracted extends Pick<Chosen<Part>, 'accessories' | 'kept' | 'excluded'> {
  /** With one group per part; with UVs if every primitive has the set of its base colour texture; without one, the first, or of a cage the one that `chooseUvSet` finds. */
  mesh: Mesh & { indices: Uint32Array };
  /** In the order of their vertices. */
  parts: Part[];
  leftOut: LeftOut[];
  /** What was subtracted from their places in the scene. */
  origin: Vector;
}

/** Says which parts of a file count. */
export type WhichCount = 'cage' | Parts | ((parts: readonly Part[], source: SceneSource) => IsMeant);

/**
 * Collects the triangles of a glTF's default scene (else its first), depth first, in the scene's space.
 *
 * Vertices keep their order and number; each primitive of each node is a group of its own. Transforms are applied in
 * double precision and rounded once; the winding of mirrored parts is reversed. Skinned meshes are placed by their skeleton, in the
 * bind pose; as the format demands, the transform of their node is ignored. Points, lines and overlays that were added before are
 * left out. Morph targets shape a mesh by the weights of its node, or else of itself.
 * @param origin      What is subtracted from positions. Target and cage need the same one.
 * @param whichCount  Default: the parts that are drawn; of a `cage`, its outer cages, or all if there are none
 * @param advice      The end of the error's message if no part counts.
 * @throws {InputError} that names the file, the primitive and the element.
 */
export function extract(
  source: SceneSource,
  origin: Origin = kSceneOrigin,
  whichCount?: WhichCount,
  advice = '',
): Extracted {
  return naming(source.path, () => {
    const all = listParts(source);
    const fail = (text: string) => new InputError(`${text}${advice}`);
    const chosen = typeof whichCount === 'function' ? whichCount(all, source) : whichCount;
    const { parts, leftOut: others, ...numbers } = chooseParts(all, looksOf(source), chosen, fail);
    renumber(parts);
    const leftOut = others.map(({ name, why }) => ({ name, why }));
    const near = moveTo(parts, origin);
    const mesh = joinPieces(parts);
    const uvs = readUvs(source, parts, mesh.positions.length / 3, whichCount === 'cage');
    const poses = whichCount === 'cage' ? undefined : posesOf(morphedParts(source, parts, mesh.positions));
    return {
      mesh: { ...mesh, ...uvs, ...(poses && { poses }) },
      parts,
      leftOut,
      ...numbers,
      origin: near,
    };
  });
}

/** What a viewer draws of a scene: parts as `extract` places them, overlays among them, and what was subtracted from their places. */
export interface Drawn extends Pick<Extracted, 'origin'> {
  /** In the order of the file, so that overlays come after what they lie on. */
  parts: Part[];
  /** Those of the parts that are overlays. */
  overlays: ReadonlySet<Part>;
}

/**
 * Collects what is drawn of a glTF's default scene: the parts that `extract` takes, and their overlays.
 * @param whichCount  As of `extract`.
 * @throws {InputError} as `extract`
 */
export function extractDrawn(source: SceneSource, whichCount?: Exclude<WhichCount, 'cage'>): Drawn {
  return naming(source.path, () => {
    const all = listParts(source, true);
    const isOver = (part: Part) => isOverlay(primitiveOf(source, part), source.json.meshes![part.mesh]!, source.json);
    const [overlays, own] = [all.filter(isOver), all.filter((part) => !isOver(part))];
    const fail = (text: string) => new InputError(text);
    // What an overlay leaves of a part may look like the inside of a shell: the choice is among whole parts.
    const whole = overlays.length > 0 ? listParts(source) : own;
    const which = typeof whichCount === 'function' ? whichCount(whole, source) : whichCount;
    const counting = chooseParts(whole, looksOf(source), which, fail).parts;
    const chosen = new Set(counting.map((part) => own[whole.indexOf(part)]!));
    const nodes = new Set([...chosen].map(({ node }) => node));
    const shown = new Set(overlays.filter(({ node }) => nodes.has(node)));
    const parts = all.filter((part) => chosen.has(part) || shown.has(part));
    renumber(parts);
    return { parts, overlays: shown, origin: moveTo(parts, 'own') };
  });
}

/** What patterns find parts by. */
export function namedParts({ json }: Pick<SceneSource, 'json'>, parts: readonly Part[]): NamedPart[] {
  const namesAbove = aboveIn(json);
  return parts.map(({ aliases, node }) => ({ names: aliases, above: namesAbove(node) }));
}

/** Returns what tells whether a part is drawn. */
function looksOf({ json, accessors, clear }: SceneSource): (part: Part) => Look {
  const { meshes = [], nodes = [], materials = [] } = json;
  const hidden = new Set<number>();
  const isOff = ({ extensions }: GLTF.INode) =>
    (extensions?.[visibilityExtension] as { visible?: boolean } | undefined)?.visible === false;
  const stack = nodes.flatMap((node, n) => (isOff(node) ? [n] : []));
  for (let node = stack.pop(); node !== undefined; node = stack.pop()) {
    if (!hidden.has(node)) stack.push(...(nodes[node]!.children ?? []));
    hidden.add(node);
  }
  const namesAbove = aboveIn(json);
  return ({ node, mesh, primitive, aliases, matrix, localPositions, localIndices }) => {
    const def = meshes[mesh]!.primitives[primitive]!;
    const { material: number = -1, attributes } = def;
    const material = materials[number];
    const colors = accessors[attributes['COLOR_0'] ?? -1];
    const alpha =
      (material?.pbrMetallicRoughness?.baseColorFactor?.[3] ?? 1) *
      largestAlpha(
        material?.alphaMode !== undefined && colors?.getElementSize() === 4 ? decodeFloats(colors) : undefined,
      );
    return {
      names: aliases,
      above: namesAbove(node),
      isHidden: hidden.has(node),
      isClear: clear?.has(def) || isClear(material?.alphaMode, alpha, material?.alphaCutoff),
      sides: material?.doubleSided ? 'both' : 'front',
      positions: localPositions,
      indices: localIndices,
      matrix,
    };
  };
}

/** The path of a primitive in the file's JSON: "meshes[0].primitives[1]". */
export function primitivePath({ mesh, primitive }: PrimitiveRef): string {
  return `meshes[${mesh}].primitives[${primitive}]`;
}

/** The part that a vertex belongs to. */
export function partOf(parts: readonly Part[], vertex: number): Part | undefined {
  return parts.find((part) => vertex >= part.firstVertex && vertex < part.firstVertex + part.vertexCount);
}

/** Parts, and what moves them. @param positions  Of all of them, in the space of the model. */
export function morphedParts(source: SceneSource, parts: readonly Part[], positions: Float32Array): MorphedPart[] {
  const { json, accessors } = source;
  const expressions = vrmExpressions(json.extensions as VrmExtensions | undefined);
  return parts.map(({ node, mesh, primitive, aliases, matrix, firstVertex, vertexCount }) => {
    const { extras, primitives, weights: ofMesh } = json.meshes![mesh]!;
    const names = (extras as { targetNames?: unknown[] } | undefined)?.targetNames ?? [];
    const weights = json.nodes![node]!.weights ?? ofMesh;
    const targets = (primitives[primitive]!.targets ?? []).map((target, t): MorphTarget => {
      const deltas = accessors[target['POSITION'] ?? -1];
      return {
        names: [names[t], ...expressions(node, mesh, t)],
        deltas: () => deltas && decodeFloats(deltas),
        shown: weights?.[t],
      };
    });
    return { names: aliases, matrix, positions: ofPart(positions, firstVertex, vertexCount), targets };
  });
}

/** The positions of a part. */
const ofPart = (positions: Float32Array, firstVertex: number, vertexCount: number) =>
  positions.subarray(3 * firstVertex, 3 * (firstVertex + vertexCount));

function listParts(source: SceneSource, withOverlays = false): Part[] {
  const { json, accessors, isUnnumbered } = source;
  const { meshes = [], nodes = [], materials = [] } = json;
  const parts: Part[] = [];
  // An explicit stack: a chain of nodes may be longer than JavaScript's call stack.
  const matrices = worldMatrices(json);
  const stack = [...roots(json)].reverse();
  for (let node = stack.pop(); node !== undefined; node = stack.pop()) {
    const nodeDef = nodes[node]!;
    let matrix = matrices[node]!;
    for (const child of [...(nodeDef.children ?? [])].reverse()) stack.push(child);
    if (nodeDef.mesh === undefined) continue;
    const meshDef = meshes[nodeDef.mesh]!;
    const instances = nodeDef.extensions?.[instancing] as { attributes?: Record<string, unknown> } | undefined;
    const place = isUnnumbered ? `"${nodeDef.name || meshDef.name}"` : `nodes[${node}]`;
    if (instances !== undefined) matrix = multiply(matrix, instanceOf(source, place, instances.attributes));
    meshDef.primitives.forEach((primitive, p) => {
      if ((!withOverlays && isOverlay(primitive, meshDef, json)) || !hasTriangles(primitive.mode ?? 4)) return;
      const ref = { mesh: nodeDef.mesh!, primitive: p };
      const accessor = accessorOf(source, ref, 'POSITION');
      if (accessor === undefined) return;
      requireWhole(source, ref);
      const deltas = (t: number) => accessors[primitive.targets?.[t]?.['POSITION'] ?? -1];
      const positions = decodePositions(primitivePath(ref), accessor, nodeDef.weights ?? meshDef.weights ?? [], deltas);
      const piece = nextPiece(parts, {
        node: nodeDef.name,
        mesh: meshDef.name,
        material: materials[primitive.material ?? -1]?.name,
        place: isUnnumbered ? primitivePath(ref) : place,
        primitives: meshDef.primitives.length,
        matrix,
        positions,
        indices: readTriangles(source, ref, positions.length / 3, withOverlays),
      });
      parts.push({ ...piece, node, ...ref });
    });
  }
  const parents = parentsOf(nodes);
  const placed = placeMeshes(
    parts.map((part) => ({ ...part, skin: skinOf(source, part) })),
    { parentOf: (node) => parents.get(node), worldOf: (node) => matrices[node]! },
  );
  parts.forEach((part, p) => (part.matrix = placed[p]!));
  return parts;
}

/** The matrix of the first instance of a node. */
function instanceOf(source: SceneSource, path: string, attributes: Record<string, unknown> = {}): Matrix {
  const { accessors } = source;
  return firstInstance(path, (semantic) => {
    const number = attributes[semantic];
    if (number === undefined) return undefined;
    const accessor = Number.isInteger(number) ? accessors[number as number] : undefined;
    if (accessor) return accessor;
    throw new InputError(
      `${path}: ${semantic} of ${instancing} is ${show(number)}, not one of ${accessors.length} accessors`,
    );
  });
}

/** How its skin holds a part. */
export function skinOf(source: SceneSource, part: Part): Skin<number> | undefined {
  const { skin } = source.json.nodes![part.node]!;
  if (skin === undefined) return undefined;
  const { joints = [], inverseBindMatrices } = source.json.skins![skin]!;
  const inverses = source.accessors[inverseBindMatrices ?? -1]?.getArray();
  const arrayOf = (semantic: string) => accessorOf(source, part, semantic)?.getArray() ?? [];
  return {
    joints,
    inverseOf: (j) => inverses?.subarray(16 * j, 16 * j + 16),
    bind: identity,
    held: arrayOf('JOINTS_0'),
    weights: arrayOf('WEIGHTS_0'),
    positions: part.localPositions,
    isFloat: arrayOf('POSITION') instanceof Float32Array,
  };
}

const primitiveOf = ({ json }: SceneSource, { mesh, primitive }: PrimitiveRef): GLTF.IMeshPrimitive =>
  json.meshes![mesh]!.primitives[primitive]!;

/** The accessor of a primitive, decoded, and checked to have as many elements as the file says. */
function accessorOf(source: SceneSource, ref: PrimitiveRef, semantic: string): AccessorData | undefined {
  const { attributes } = primitiveOf(source, ref);
  if (attributes[semantic] === undefined) return undefined;
  const accessor = source.accessors[attributes[semantic]];
  const expected = source.json.accessors![attributes[semantic]]!.count;
  if (accessor?.getArray() === null || accessor?.getCount() !== expected) {
    throw new InputError(
      `${primitivePath(ref)}.attributes.${semantic} has ${accessor?.getCount() ?? 0} elements, not the ${expected} of its accessor`,
    );
  }
  return accessor;
}

/** Checks that no attribute has less elements than there are vertices. @throws {InputError} */
function requireWhole({ json: { accessors = [], meshes } }: SceneSource, ref: PrimitiveRef): void {
  const { attributes, targets = [] } = meshes![ref.mesh]!.primitives[ref.primitive]!;
  const vertices = accessors[attributes['POSITION']!]!.count;
  for (const [semantic, number] of [attributes, ...targets].flatMap((of) => Object.entries(of))) {
    const { count } = accessors[number]!;
    if (count < vertices)
      throw new InputError(`${primitivePath(ref)} has ${count} ${semantic} for ${vertices} vertices`);
  }
}

/** The triangles of a primitive, strips and fans expanded, and those that overlays have in their place. */
function readTriangles(source: SceneSource, ref: PrimitiveRef, vertexCount: number, isBare: boolean): Uint32Array {
  const own = readOwnTriangles(source, ref, vertexCount);
  const mesh = source.json.meshes![ref.mesh]!;
  const overlays = isBare ? [] : overlaysInPlaceOf(primitiveOf(source, ref), mesh);
  if (overlays.length === 0) return own;
  const all = overlays.map((overlay) =>
    readOwnTriangles(source, { mesh: ref.mesh, primitive: mesh.primitives.indexOf(overlay) }, vertexCount),
  );
  return Uint32Array.from([own, ...all].flatMap((some) => [...some]));
}

function readOwnTriangles(source: SceneSource, ref: PrimitiveRef, vertexCount: number): Uint32Array {
  const { indices, mode = 4 } = primitiveOf(source, ref);
  const array = source.accessors[indices ?? -1]?.getArray() ?? null;
  if (indices !== undefined && array === null) throw new InputError(`${primitivePath(ref)}.indices has no data`);
  return decodeTriangles(primitivePath(ref), array, mode, vertexCount);
}

/** The UVs of all parts, if all have some. */
function readUvs(
  source: SceneSource,
  parts: readonly Part[],
  vertexCount: number,
  isCage: boolean,
): Pick<Mesh, 'uvs' | 'otherUvSets'> | undefined {
  const laid = parts.map((part) => {
    const { layout, others } = isCage ? cageLayout(source, part) : { layout: uvLayout(source.json, part), others: [] };
    return { part, layout, others, accessor: accessorOf(source, part, layout.set) };
  });
  if (parts.length === 0 || laid.some(({ accessor }) => accessor === undefined)) return undefined;
  const uvs = new Float32Array(2 * vertexCount);
  for (const { part, layout, accessor } of laid)
    uvs.set(decodeUvs(placeOf(source, part), layout, accessor!, part.vertexCount), 2 * part.firstVertex);
  const otherUvSets = [...new Set(laid.flatMap(({ others }) => others))].sort((a, b) => a - b);
  return { uvs, ...(otherUvSets.length > 0 && { otherUvSets }) };
}

const placeOf = ({ isUnnumbered }: SceneSource, part: Part): string =>
  isUnnumbered ? `"${part.name}"` : primitivePath(part);

/** How the texture that is drawn for a cage is laid on a part of it, and the numbers of the sets that might be meant as well. */
function cageLayout(source: SceneSource, part: Part): { layout: UvLayout; others: number[] } {
  const texture = baseColorTexture(source.json, part);
  const layout = uvLayoutOf(texture);
  const numberOf = (semantic: string) => Number(/^TEXCOORD_(\d+)$/.exec(semantic)?.[1]);
  const names = source.json.meshes![part.mesh]!.extras?.[uvSetNames] as (string | undefined)[] | undefined;
  const sets = Object.keys(primitiveOf(source, part).attributes)
    .filter((semantic) => numberOf(semantic) >= 0)
    .map((semantic): UvSet => {
      const number = numberOf(semantic);
      const name = Array.isArray(names) ? names[number] : undefined;
      const values = () => decodeFloats(accessorOf(source, part, semantic)!);
      return { number, name, rank: rankOf(name ?? ''), values };
    })
    .sort((a, b) => a.number - b.number);
  if (sets.length === 0) return { layout, others: [] };
  const told = { given: source.cageUvs, used: texture && numberOf(layout.set) };
  const fail = (text: string) => new InputError(`${placeOf(source, part)} ${text}`);
  const { number, others } = chooseUvSet(sets, told, fail);
  const set = `TEXCOORD_${number}`;
  return { layout: set === layout.set ? layout : { set, transform: undefined }, others };
}

/** How the base colour texture of a part is laid on it. */
export const uvLayout = (json: GLTF.IGLTF, part: Part): UvLayout => uvLayoutOf(baseColorTexture(json, part));

function baseColorTexture({ meshes, materials = [] }: GLTF.IGLTF, { mesh, primitive }: Part) {
  const material = materials[meshes![mesh]!.primitives[primitive]!.material ?? -1];
  return material?.pbrMetallicRoughness?.baseColorTexture;
}
