import {
  BackSide,
  type BufferGeometry,
  FrontSide,
  type Material,
  Matrix4,
  type Object3D,
  type SkinnedMesh,
  type Mesh as ThreeMesh,
} from 'three';
import type { CagecastError, Mesh } from '../../api/index.js';
import type { Parts } from '../../api/parts.js';
import { show } from '../../core/error.js';
import type { Vector } from '../../inspect/geometry.js';
import {
  chooseParts,
  groupsNamed,
  isClear,
  type LeftOut,
  type Look,
  largestAlpha,
  visibilityExtension,
} from '../../parts/drawn.js';
import { fromOrigin, kSceneOrigin, type Origin, originOf } from '../../parts/origin.js';
import { morphed, movePoints } from '../../parts/points.js';
import { type MorphedPart, posesOf } from '../../parts/poses.js';
import { bareNames } from '../../parts/template-extras.js';
import { endOf } from '../../scene/pieces.js';
import { wrong } from '../errors.js';
import { type Attribute, targetDeltas, valuesOf } from './attributes.js';
import { isClearByMap } from './clear-map.js';
import { giveBackTriangles, isLost, isMarked } from './earlier-overlays.js';
import { isGeometry, isInstanced, isMesh, isObject, isOfInstances } from './flags.js';
import { isCage, isLoadedGltf, type LoadedCage, type LoadedGltf, objectOf } from './models.js';
import { groupNames, materialsOf, namesOf } from './names.js';
import { placesOf } from './places.js';
import { cageLayoutOf, inTexture, type UvLayout, uvAttribute, uvLayoutOf } from './uv-layout.js';
import { asBefore, type Channel, stateOf } from './writes.js';

/** One mesh of a scene, or a single geometry, and the ranges of its elements in the joined arrays. */
export interface Part {
  /** The name of the mesh, or of its parent if it has none. */
  name: string;
  /** All that it is called: with the names in its file, of its geometry and its materials. */
  aliases: readonly string[];
  /** The mesh; `undefined` if a geometry was given. */
  mesh: ThreeMesh | undefined;
  geometry: BufferGeometry;
  /** From the geometry's space to that of the arrays. */
  matrix: Matrix4;
  firstVertex: number;
  vertexCount: number;
  firstTriangle: number;
  triangleCount: number;
}

/** All triangles of a scene as arrays, and the parts that they come from. */
export interface Extracted {
  /** With UVs if every part has those of its base colour texture, where they are in it; without one, the attribute `uv`, or of a cage the set that `chooseUvSet` finds. */
  mesh: Mesh & { indices: Uint32Array; groups: Uint32Array };
  /** In the order of their vertices. */
  parts: Part[];
  /** The meshes that are left out, and why. */
  leftOut: (LeftOut & { mesh: ThreeMesh })[];
  /** The numbers in `groups` of what a figure wears or carries, by its name. `applyTransfer` leaves it bare. */
  accessories: number[];
  /** The names of each group: of its mesh, the object that holds the meshes of one glTF mesh, its geometry and its material. */
  names: string[][];
  /** The numbers in `groups` of what `parts` keeps, and of what it excludes. */
  kept: number[];
  excluded: number[];
  /** Of a cage, the names of the parts that it leaves bare. */
  bare: string[];
}

const identity = new Matrix4();

/**
 * Collects the triangles of a geometry, or of all meshes of a scene, depth first, as arrays for `transfer`.
 *
 * Vertices keep their order and number. Positions are in the scene's space: world matrices are applied in double precision and
 * rounded once, and the winding of mirrored meshes is reversed. Skinned meshes are placed by their skeleton, in the bind pose;
 * morph targets shape them as they do now (`morphTargetInfluences`). An instanced mesh is taken once, where its first instance is. Each mesh, or each of its material
 * groups, is a group.
 * @param argument  The name of the argument, for messages.
 * @param parts     What counts. Default: what is drawn; of a `cage` or `template`, its outer cages, or all if there are none
 * @throws {CagecastError} that names the part and the element.
 */
export const extract = (model: LoadedCage, argument = 'target', parts?: Parts): Extracted =>
  extractNear(model, argument, kSceneOrigin, { parts });

interface ExtractOptions {
  parts?: Parts | undefined;
  /** That a transfer will write. */
  channel?: Channel | undefined;
  /** The UV set of a cage, if it was chosen. */
  cageUvs?: number | undefined;
}

/** What a transfer needs of a target. */
export interface ExtractedNear extends Extracted {
  origin: Vector;
  /** What the geometry of each part was before the transfers whose place another one takes. */
  states: BufferGeometry[];
}

/** The same with positions around an origin, which target and cage need in common; and that origin. */
export function extractNear(
  model: LoadedCage,
  argument: string,
  origin: Origin,
  { parts, channel, cageUvs }: ExtractOptions = {},
): ExtractedNear {
  const object = objectOf(model, argument);
  return asItWas(object, channel, () => extractNow(model, argument, origin, { parts, cageUvs }));
}

/** Calls a function while an object is as before its transfers: before all, or those that one into a channel replaces. */
export function asItWas<T>(object: Object3D | BufferGeometry, channel: Channel | undefined, call: () => T): T {
  const geometries = new Set<BufferGeometry>();
  if (isGeometry(object)) geometries.add(object);
  else if (isObject(object)) object.traverse((child) => void (isMesh(child) && geometries.add(child.geometry)));
  return asBefore(geometries, channel, call);
}

function extractNow(
  model: LoadedCage,
  argument: string,
  origin: Origin,
  { parts: patterns, cageUvs }: ExtractOptions,
): ExtractedNear {
  const object = objectOf(model, argument);
  const { parts, leftOut, accessories, kept, excluded } = listParts(object, argument, patterns);
  const placed = ({ geometry, matrix }: Part) => ({
    points: valuesOf(geometry.getAttribute('position') as Attribute),
    matrix: matrix.elements,
  });
  const near = origin === 'own' ? originOf(parts.map(placed)) : origin;
  for (const part of parts) part.matrix = new Matrix4().fromArray(fromOrigin(part.matrix.elements, near));
  const [vertices, triangles] = endOf(parts);
  const positions = new Float32Array(3 * vertices);
  const indices = new Uint32Array(3 * triangles);
  const groups = new Uint32Array(vertices);
  let group = 0;
  for (const part of parts) {
    placePositions(part, positions);
    placeIndices(part, indices, argument);
    group = placeGroups(part, groups, group);
  }
  const uvs = readUvs(
    parts,
    argument,
    layoutsOf(parts, { argument, cageUvs }, isLoadedGltf(model) ? model : undefined),
  );
  const groupsOf = (numbers: readonly number[]) =>
    numbers.flatMap((p) => {
      const { firstVertex, vertexCount } = parts[p]!;
      return [...new Set(groups.subarray(firstVertex, firstVertex + vertexCount))];
    });
  const poses = isCage(argument) ? undefined : posesOf(morphedParts(parts, positions));
  const names = groupNames(parts, object);
  const mesh = { positions, indices, groups, names, ...uvs, ...(poses && { poses }) };
  return {
    mesh,
    parts,
    leftOut,
    accessories: groupsOf(accessories),
    kept: groupsOf(kept),
    excluded: groupsOf(excluded),
    names,
    bare: bareNames(parts.flatMap(extrasOf)),
    origin: near,
    states: parts.map(({ geometry }) => stateOf(geometry)),
  };
}

/** What GLTFLoader keeps of the extras of a part: the parent of the meshes of one glTF mesh has those of its node. */
export const extrasOf = ({ mesh, geometry }: Pick<Part, 'mesh' | 'geometry'>): unknown[] => [
  geometry.userData,
  mesh?.parent?.userData,
  mesh?.userData,
];

/**
 * The numbers in `groups` of parts that a transfer excludes by default: things worn or carried, and parts that the cage was made without, by
 * its names. For `parts.exclude` of those who call `transfer`.
 * @param cage    What `extract` returned for a cage.
 * @param target  What it returned for a target.
 */
export const bareGroups = (
  { bare }: { bare: readonly string[] },
  { accessories, names }: { accessories: readonly number[]; names: readonly (readonly string[])[] },
): number[] => [...new Set([...accessories, ...groupsNamed(bare, names)])];

function listParts(
  object: Object3D | BufferGeometry,
  argument: string,
  patterns: Parts | undefined,
): Pick<Extracted, 'parts' | 'leftOut' | 'accessories' | 'kept' | 'excluded'> {
  const parts: Part[] = [];
  const add = (
    aliases: readonly string[],
    name: string,
    mesh: ThreeMesh | undefined,
    geometry: BufferGeometry,
    matrix: Matrix4,
  ) => {
    if ((mesh && 'isBatchedMesh' in mesh) || 'isInstancedBufferGeometry' in geometry)
      throw wrongPart(argument, name, 'is a batch or an instanced geometry; make each instance a mesh of its own');
    const position = geometry.getAttribute('position') as Attribute | undefined;
    const vertexCount = position?.count ?? 0;
    const corners = geometry.index?.count ?? vertexCount;
    if (!vertexCount || !corners) return;
    if (position!.itemSize !== 3)
      throw wrongPart(argument, name, `has positions of ${position!.itemSize} numbers, not 3`);
    if (corners % 3 !== 0) throw wrongPart(argument, name, `has ${corners} corners, not 3 per triangle`);
    const morphs = Object.entries(geometry.morphAttributes).flatMap(([of, attributes]) =>
      attributes!.map((attribute): [string, { count: number }] => [`deltas of ${of}`, attribute]),
    );
    const attributes = Object.entries(geometry.attributes).filter(([, attribute]) => !isOfInstances(attribute));
    for (const [of, { count }] of [...attributes, ...morphs]) {
      if (count < vertexCount) throw wrongPart(argument, name, `has ${count} ${of} for ${vertexCount} vertices`);
    }
    const [firstVertex, firstTriangle] = endOf(parts);
    parts.push({
      name,
      aliases,
      mesh,
      geometry,
      matrix,
      firstVertex,
      vertexCount,
      firstTriangle,
      triangleCount: corners / 3,
    });
  };
  if (isGeometry(object)) {
    add([], object.name || 'geometry', undefined, object, identity);
    return { parts, leftOut: [], accessories: [], kept: [], excluded: [] };
  }
  giveBackTriangles(object);
  object.updateWorldMatrix(true, true);
  const meshes: ThreeMesh[] = [];
  object.traverse((child) => {
    // Its bones may be elsewhere in the scene.
    for (const bone of (child as SkinnedMesh).skeleton?.bones ?? []) bone.updateWorldMatrix(true, false);
    if (!isMesh(child) || ([child, child.geometry, child.material].flat().some(isMarked) && !isLost(child))) return;
    if (isAid(child, object)) return;
    if (!isInstanced(child) || child.count > 0) meshes.push(child);
  });
  const found = placesOf(meshes).map((matrix, m) => {
    const mesh = meshes[m]!;
    return { mesh, matrix, name: mesh.name || mesh.parent?.name || `mesh ${m}` };
  });
  const chosen = chooseParts(
    found,
    ({ mesh, matrix }) => lookOf(mesh, matrix, object),
    patterns ?? (isCage(argument) ? 'cage' : undefined),
    (text) => wrong(`${argument}: ${text}`, undefined, undefined, { argument }),
  );
  for (const { name, mesh, matrix } of chosen.parts) add(namesOf(mesh, object), name, mesh, mesh.geometry, matrix);
  const numbersOf = (some: readonly number[]) => {
    const meshes = new Set(some.map((p) => chosen.parts[p]!.mesh));
    return [...parts.keys()].filter((p) => meshes.has(parts[p]!.mesh!));
  };
  return {
    parts,
    leftOut: chosen.leftOut.map(({ part, name, why }) => ({ name, why, mesh: part.mesh })),
    accessories: numbersOf(chosen.accessories),
    kept: numbersOf(chosen.kept),
    excluded: numbersOf(chosen.excluded),
  };
}

/** An object and all above it, below a root: whoever gives a root means it, even while it is hidden. */
function below(root: Object3D, object: Object3D): Object3D[] {
  const path: Object3D[] = [];
  for (let one: Object3D | null = object; one && one !== root; one = one.parent) path.push(one);
  return path;
}

/** Whether a mesh only shows something else: a thick line, or a part of a helper. */
const isAid = (mesh: ThreeMesh, root: Object3D): boolean =>
  'isLineSegments2' in mesh || below(root, mesh).some(({ type }) => type.endsWith('Helper'));

function lookOf(mesh: ThreeMesh, matrix: Matrix4, root: Object3D): Look {
  const { geometry } = mesh;
  const position = geometry.getAttribute('position') as Attribute | undefined;
  const colors = geometry.getAttribute('color') as Attribute | undefined;
  const alpha = largestAlpha(colors?.itemSize === 4 ? valuesOf(colors) : undefined);
  const materials = materialsOf(mesh);
  const all = (fits: (material: Material) => boolean) => materials.length > 0 && materials.every(fits);
  const isOff = ({ visible, userData: { gltfExtensions } }: Object3D) =>
    !visible || gltfExtensions?.[visibilityExtension]?.visible === false;
  return {
    names: namesOf(mesh, root),
    above: below(root, mesh)
      .slice(1)
      .map(({ name }) => name),
    isHidden: below(root, mesh).some(isOff) || all(({ visible }) => !visible),
    isClear: all((material) => {
      const { transparent, alphaTest, opacity, vertexColors } = material;
      const least = opacity * (vertexColors ? alpha : 1);
      return (
        isClear(transparent ? 'BLEND' : alphaTest > 0 ? 'MASK' : 'OPAQUE', least, alphaTest) ||
        isClearByMap(geometry, material, least)
      );
    }),
    sides: all(({ side }) => side === FrontSide) ? 'front' : all(({ side }) => side === BackSide) ? 'back' : 'both',
    positions: position ? valuesOf(position) : [],
    indices: geometry.index?.array,
    matrix: matrix.elements,
  };
}

const wrongPart = (argument: string, name: string, text: string, at?: number): CagecastError =>
  wrong(`${argument}: ${show(name)} ${text}`, undefined, undefined, { argument, at });

/** Whether a matrix mirrors, so that the winding of triangles must be reversed. */
export const isMirrored = (matrix: Matrix4): boolean => matrix.determinant() < 0;

/** Writes the positions of a part in the scene's space; without a mesh, as morph targets do not shape it. */
export function placePositions(
  {
    mesh,
    geometry,
    matrix,
    firstVertex,
    vertexCount,
  }: Omit<Part, 'name' | 'aliases' | 'firstTriangle' | 'triangleCount'>,
  out: Float32Array,
): void {
  // A quantised position is a float before the matrix is applied, as every other reader of the file stores it.
  const stored = valuesOf(geometry.getAttribute('position') as Attribute).subarray(0, 3 * vertexCount);
  const values = morphed(
    stored,
    (mesh?.morphTargetInfluences ?? []).flatMap((weight, t) => {
      const deltas = weight === 0 ? undefined : targetDeltas(geometry, t);
      return deltas ? [{ weight, deltas }] : [];
    }),
  );
  if (matrix.equals(identity)) out.set(values, 3 * firstVertex);
  else movePoints(matrix.elements, values, out, 3 * firstVertex);
}

/**
 * Parts, and what moves them.
 * @param positions    Of all parts, in the space of the model.
 * @param expressions  The names of the expressions that use a morph target. Default: none.
 */
export function morphedParts(
  parts: readonly Part[],
  positions: Float32Array,
  expressions: (mesh: Part['mesh'], target: number) => string[] = () => [],
): MorphedPart[] {
  return parts.map(({ mesh, geometry, aliases, matrix, firstVertex, vertexCount }) => {
    const names: string[] = [];
    for (const [name, t] of Object.entries(mesh?.morphTargetDictionary ?? {})) names[t] = name;
    const targets = (geometry.morphAttributes.position ?? []).map((_, t) => ({
      names: [names[t], ...expressions(mesh, t)],
      deltas: () => targetDeltas(geometry, t),
      shown: mesh?.morphTargetInfluences?.[t],
    }));
    const own = positions.subarray(3 * firstVertex, 3 * (firstVertex + vertexCount));
    return { names: aliases, matrix: matrix.elements, positions: own, targets };
  });
}

function placeIndices(
  { name, geometry, matrix, firstVertex, vertexCount, firstTriangle, triangleCount }: Part,
  out: Uint32Array,
  argument: string,
): void {
  const { index } = geometry;
  const mirrored = isMirrored(matrix);
  for (let i = 0; i < 3 * triangleCount; ++i) {
    // Checked part by part: in the joined arrays an index too large would point into the next part.
    const vertex = index?.getX(i) ?? i;
    if (vertex >= vertexCount)
      throw wrongPart(
        argument,
        name,
        `has indices[${i}] = ${vertex}, which is out of range (${vertexCount} vertices)`,
        i,
      );
    const corner = i % 3;
    out[3 * firstTriangle + i - corner + (mirrored && corner > 0 ? 3 - corner : corner)] = firstVertex + vertex;
  }
}

/** Numbers the part's material groups, from `first` on. @returns the next number. */
function placeGroups(
  { mesh, geometry, firstVertex, vertexCount, triangleCount }: Part,
  out: Uint32Array,
  first: number,
): number {
  out.fill(first, firstVertex, firstVertex + vertexCount);
  if (!Array.isArray(mesh?.material)) return first + 1;
  let next = first;
  const numbers = new Map<number, number>();
  const taken = new Uint8Array(vertexCount);
  for (const { start, count, materialIndex = 0 } of geometry.groups) {
    if (!numbers.has(materialIndex)) numbers.set(materialIndex, next++);
    const group = numbers.get(materialIndex)!;
    for (let i = start; i < Math.min(start + count, 3 * triangleCount); ++i) {
      const vertex = geometry.index?.getX(i) ?? i;
      if (vertex >= vertexCount || taken[vertex] === 1) continue; // a vertex of two materials belongs to the first
      taken[vertex] = 1;
      out[firstVertex + vertex] = group;
    }
  }
  return Math.max(next, first + 1);
}

/** How the texture of each part is laid on it; of a cage, the one that is drawn for it. */
function layoutsOf(
  parts: readonly Part[],
  { argument, cageUvs }: { argument: string; cageUvs: number | undefined },
  loaded: LoadedGltf | undefined,
): { layout: UvLayout; others: readonly number[] }[] {
  return parts.map((part) => {
    if (!isCage(argument)) return { layout: uvLayoutOf(part, loaded), others: [] };
    return cageLayoutOf(part, loaded, cageUvs, (text) => wrongPart(argument, part.name, text));
  });
}

function readUvs(
  parts: readonly Part[],
  argument: string,
  layouts: ReturnType<typeof layoutsOf>,
): Pick<Mesh, 'uvs' | 'otherUvSets'> | undefined {
  const laid = parts.map((part, p) => ({ ...part, ...layouts[p]!, uv: uvAttribute(part, layouts[p]!.layout) }));
  if (!laid.every(({ uv }) => uv)) return undefined;
  const [vertices] = endOf(parts);
  const uvs = new Float32Array(2 * vertices);
  for (const { name, firstVertex, vertexCount, layout, uv } of laid) {
    if (uv!.count !== vertexCount || uv!.itemSize !== 2)
      throw wrongPart(argument, name, `has ${uv!.count} UVs of ${uv!.itemSize} numbers, not ${vertexCount} of 2`);
    uvs.set(inTexture(valuesOf(uv!), layout), 2 * firstVertex);
  }
  const otherUvSets = [...new Set(laid.flatMap(({ others }) => others))].sort((a, b) => a - b);
  return { uvs, ...(otherUvSets.length > 0 && { otherUvSets }) };
}
