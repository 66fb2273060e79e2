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
  visibilityExtension,
} from '../parts/drawn.js';
import type { VrmExtensions } from '../parts/joints.js';
import { vrmExpressions } from '../parts/morph-names.js';
import { kSceneOrigin, type Origin } from '../parts/origin.js';
import { type MorphedPart, type MorphTarget, posesOf } from '../parts/poses.js';
import { placeMeshes, type Skin } from '../parts/skin.js';
import { type AccessorData, decodeFloats } from './accessors.js';
import { topNodes } from './checks/check-geometry.js';
import { InputError, naming } from './input-error.js';
import { firstInstance, instancing } from './instancing.js';
import { localMatrix } from './matrix.js';
import type { GltfFile } from './open-gltf.js';
import { isOverlay } from './overlay.js';
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
import { type UvLayout, uvLayoutOf } from './uv-layout.js';

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
  /** With one group per part; with UVs if every primitive has the set of its base colour texture, or the first without one. */
  mesh: Mesh & { indices: Uint32Array };
  /** In the order of their vertices. */
  parts: Part[];
  leftOut: LeftOut[];
  /** What was subtracted from their places in the scene. */
  origin: Vector;
}

/** Says which parts of a file count. */
export type WhichCount = 'cage' | Parts | ((parts: readonly Part[], file: GltfFile) => IsMeant);

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
  file: GltfFile,
  origin: Origin = kSceneOrigin,
  whichCount?: WhichCount,
  advice = '',
): Extracted {
  return naming(file.path, () => {
    const all = listParts(file);
    const fail = (text: string) => new InputError(`${text}${advice}`);
    const chosen = typeof whichCount === 'function' ? whichCount(all, file) : whichCount;
    const { parts, leftOut: others, ...numbers } = chooseParts(all, looksOf(file), chosen, fail);
    renumber(parts);
    const leftOut = others.map(({ name, why }) => ({ name, why }));
    const near = moveTo(parts, origin);
    const mesh = joinPieces(parts);
    const uvs = readUvs(file, parts, mesh.positions.length / 3);
    const poses = whichCount === 'cage' ? undefined : posesOf(morphedParts(file, parts, mesh.positions));
    return {
      mesh: { ...mesh, ...(uvs && { uvs }), ...(poses && { poses }) },
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
export function extractDrawn(file: GltfFile, whichCount?: Exclude<WhichCount, 'cage'>): Drawn {
  return naming(file.path, () => {
    const all = listParts(file, true);
    const isOver = (part: Part) => isOverlay(primitiveOf(file, part), file.json);
    const [overlays, own] = [all.filter(isOver), all.filter((part) => !isOver(part))];
    const fail = (text: string) => new InputError(text);
    const chosen = new Set(
      chooseParts(own, looksOf(file), typeof whichCount === 'function' ? whichCount(own, file) : whichCount, fail)
        .parts,
    );
    const nodes = new Set([...chosen].map(({ node }) => node));
    const shown = new Set(overlays.filter(({ node }) => nodes.has(node)));
    const parts = all.filter((part) => chosen.has(part) || shown.has(part));
    renumber(parts);
    return { parts, overlays: shown, origin: moveTo(parts, 'own') };
  });
}

/** Returns what finds the names of the nodes above a node. */
function aboveIn({ nodes = [] }: GLTF.IGLTF): (node: number) => string[] {
  const parents = new Map(nodes.flatMap(({ children = [] }, n) => children.map((child) => [child, n])));
  return (node) => {
    const names: string[] = [];
    for (let n = parents.get(node); n !== undefined; n = parents.get(n)) names.push(nodes[n]!.name ?? '');
    return names;
  };
}

/** What patterns find parts by. */
export function namedParts({ json }: Pick<GltfFile, 'json'>, parts: readonly Part[]): NamedPart[] {
  const namesAbove = aboveIn(json);
  return parts.map(({ aliases, node }) => ({ names: aliases, above: namesAbove(node) }));
}

/** Returns what tells whether a part is drawn. */
function looksOf({ json }: GltfFile): (part: Part) => Look {
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
    const material = materials[meshes[mesh]!.primitives[primitive]!.material ?? -1];
    const alpha = material?.pbrMetallicRoughness?.baseColorFactor?.[3];
    return {
      names: aliases,
      above: namesAbove(node),
      isHidden: hidden.has(node),
      isClear: isClear(material?.alphaMode, alpha, material?.alphaCutoff),
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
export function morphedParts(file: GltfFile, parts: readonly Part[], positions: Float32Array): MorphedPart[] {
  const { json, accessors } = file;
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

function listParts(file: GltfFile, withOverlays = false): Part[] {
  const { meshes = [], nodes = [], materials = [] } = file.json;
  const parts: Part[] = [];
  // An explicit stack: a chain of nodes may be longer than JavaScript's call stack.
  const matrices = worldMatrices(file.json);
  const stack = [...roots(file.json)].reverse();
  for (let node = stack.pop(); node !== undefined; node = stack.pop()) {
    const nodeDef = nodes[node]!;
    let matrix = matrices[node]!;
    for (const child of [...(nodeDef.children ?? [])].reverse()) stack.push(child);
    if (nodeDef.mesh === undefined) continue;
    const instances = nodeDef.extensions?.[instancing] as { attributes?: Record<string, unknown> } | undefined;
    if (instances !== undefined) matrix = multiply(matrix, instanceOf(file, `nodes[${node}]`, instances.attributes));
    const meshDef = meshes[nodeDef.mesh]!;
    meshDef.primitives.forEach((primitive, p) => {
      if (!withOverlays && isOverlay(primitive, file.json)) return;
      const ref = { mesh: nodeDef.mesh!, primitive: p };
      const accessor = accessorOf(file, ref, 'POSITION');
      if (accessor === undefined) return;
      const deltas = (t: number) => file.accessors[primitive.targets?.[t]?.['POSITION'] ?? -1];
      const positions = decodePositions(primitivePath(ref), accessor, nodeDef.weights ?? meshDef.weights ?? [], deltas);
      const indices = readTriangles(file, ref, positions.length / 3);
      if (indices === undefined) return;
      const piece = nextPiece(parts, {
        node: nodeDef.name,
        mesh: meshDef.name,
        material: materials[primitive.material ?? -1]?.name,
        place: `nodes[${node}]`,
        primitives: meshDef.primitives.length,
        matrix,
        positions,
        indices,
      });
      parts.push({ ...piece, node, ...ref });
    });
  }
  const parents = parentsOf(nodes);
  const placed = placeMeshes(
    parts.map((part) => ({ ...part, skin: skinOf(file, part) })),
    { parentOf: (node) => parents.get(node), worldOf: (node) => matrices[node]! },
  );
  parts.forEach((part, p) => (part.matrix = placed[p]!));
  return parts;
}

/** The node above each node that is below one. */
export const parentsOf = (nodes: readonly GLTF.INode[]): Map<number, number> =>
  new Map(nodes.flatMap((node, n) => (node.children ?? []).map((child) => [child, n])));

/** The matrix of the first instance of a node. */
function instanceOf(file: GltfFile, path: string, attributes: Record<string, unknown> = {}): Matrix {
  const { accessors } = file;
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
export function skinOf(file: GltfFile, part: Part): Skin<number> | undefined {
  const { skin } = file.json.nodes![part.node]!;
  if (skin === undefined) return undefined;
  const { joints = [], inverseBindMatrices } = file.json.skins![skin]!;
  const inverses = file.accessors[inverseBindMatrices ?? -1]?.getArray();
  const arrayOf = (semantic: string) => accessorOf(file, part, semantic)?.getArray() ?? [];
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

/** The matrix of each node to the scene, including nodes that are in no scene. */
export function worldMatrices({ nodes = [] }: GLTF.IGLTF): Matrix[] {
  const matrices = nodes.map(() => identity);
  // Nodes in a cycle have no root and are never reached.
  const stack = topNodes(nodes).map((node) => ({ node, parent: identity }));
  for (let next = stack.pop(); next; next = stack.pop()) {
    const matrix = multiply(next.parent, localMatrix(nodes[next.node]!));
    matrices[next.node] = matrix;
    for (const node of nodes[next.node]!.children ?? []) stack.push({ node, parent: matrix });
  }
  return matrices;
}

function roots({ scene, scenes = [], nodes = [] }: GLTF.IGLTF): number[] {
  const chosen = scenes[scene ?? 0];
  // A file without scenes is a library of nodes; all of them are used.
  return chosen ? (chosen.nodes ?? []) : topNodes(nodes);
}

const primitiveOf = ({ json }: GltfFile, { mesh, primitive }: PrimitiveRef): GLTF.IMeshPrimitive =>
  json.meshes![mesh]!.primitives[primitive]!;

/** The accessor of a primitive, decoded, and checked to have as many elements as the file says. */
function accessorOf(file: GltfFile, ref: PrimitiveRef, semantic: string): AccessorData | undefined {
  const { attributes } = primitiveOf(file, ref);
  if (attributes[semantic] === undefined) return undefined;
  const accessor = file.accessors[attributes[semantic]];
  const expected = file.json.accessors![attributes[semantic]]!.count;
  if (accessor?.getArray() === null || accessor?.getCount() !== expected) {
    throw new InputError(
      `${primitivePath(ref)}.attributes.${semantic} has ${accessor?.getCount() ?? 0} elements, not the ${expected} of its accessor`,
    );
  }
  return accessor;
}

/** The triangles of a primitive, strips and fans expanded; `undefined` if it is of points or lines. */
function readTriangles(file: GltfFile, ref: PrimitiveRef, vertexCount: number): Uint32Array | undefined {
  const { indices, mode = 4 } = primitiveOf(file, ref);
  if (!hasTriangles(mode)) return undefined;
  const array = file.accessors[indices ?? -1]?.getArray() ?? null;
  if (indices !== undefined && array === null) throw new InputError(`${primitivePath(ref)}.indices has no data`);
  return decodeTriangles(primitivePath(ref), array, mode, vertexCount);
}

function readUvs(file: GltfFile, parts: Part[], vertexCount: number): Float32Array | undefined {
  const uvs = new Float32Array(2 * vertexCount);
  for (const part of parts) {
    const layout = uvLayout(file.json, part);
    const accessor = accessorOf(file, part, layout.set);
    if (accessor === undefined) return undefined;
    uvs.set(decodeUvs(primitivePath(part), layout, accessor, part.vertexCount), 2 * part.firstVertex);
  }
  return parts.length > 0 ? uvs : undefined;
}

/** How the base colour texture of a part is laid on it. */
export function uvLayout({ meshes, materials = [] }: GLTF.IGLTF, { mesh, primitive }: Part): UvLayout {
  const material = materials[meshes![mesh]!.primitives[primitive]!.material ?? -1];
  return uvLayoutOf(material?.pbrMetallicRoughness?.baseColorTexture);
}
