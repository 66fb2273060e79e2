import type { GLTF } from '@gltf-transform/core';
import { show } from '../../core/error.js';
import { InputError } from '../../scene/input-error.js';

const componentBytes: Record<number, number> = { 5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4 };
const typeComponents: Record<string, number> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT2: 4, MAT3: 9, MAT4: 16 };
/** The maximum count of an accessor: larger ones do not fit into an array. */
const kMaxCount = 2 ** 28;

/** The bytes of one element of an accessor; NaN if its type is unknown. */
export const bytesOf = ({ componentType, type }: GLTF.IAccessor): number =>
  (componentBytes[componentType] ?? NaN) * (typeComponents[type] ?? NaN);

/** The JSON of extensions that compress a buffer view; both have the same shape. */
export const meshoptExtensions = ['EXT_meshopt_compression', 'KHR_meshopt_compression'];

/** Where a compressed buffer view has its bytes. */
export interface MeshoptView {
  buffer: number;
  byteOffset?: number;
  byteLength: number;
  byteStride: number;
  count: number;
  mode: string;
  filter?: string;
}

/** The compressed form of a buffer view, if it has one. */
export function meshoptView(view: GLTF.IBufferView): MeshoptView | undefined {
  const extensions = view.extensions as Record<string, MeshoptView> | undefined;
  return meshoptExtensions.map((name) => extensions?.[name]).find((found) => found !== undefined);
}

export const isObject = (item: unknown): boolean => typeof item === 'object' && item !== null;

/**
 * Checks that all arrays of a glTF are arrays, so that they can be iterated.
 * @throws {InputError}
 */
export function checkLists(json: GLTF.IGLTF): void {
  for (const name of [
    'buffers',
    'bufferViews',
    'accessors',
    'meshes',
    'nodes',
    'scenes',
    'skins',
    'materials',
    'textures',
    'images',
  ] as const) {
    requireList(name, json[name], isObject, 'objects');
  }
  const isText = (item: unknown) => typeof item === 'string';
  requireList('extensionsUsed', json.extensionsUsed, isText, 'names');
  requireList('extensionsRequired', json.extensionsRequired, isText, 'names');
  for (const name of ['buffers', 'images'] as const) {
    json[name]?.forEach(({ uri }: { uri?: unknown }, i) => {
      if (uri !== undefined && !isText(uri)) throw new InputError(`${name}[${i}].uri is not a string`);
    });
  }
  json.meshes?.forEach((mesh, m) => {
    requireList(`meshes[${m}].primitives`, mesh.primitives ?? null, isObject, 'objects');
    requireList(`meshes[${m}].weights`, mesh.weights, Number.isFinite, 'finite numbers');
    mesh.primitives.forEach(({ targets }, p) =>
      requireList(`meshes[${m}].primitives[${p}].targets`, targets, isObject, 'objects'),
    );
  });
  json.nodes?.forEach((node, n) => {
    requireList(`nodes[${n}].children`, node.children, Number.isInteger, 'numbers');
    requireList(`nodes[${n}].weights`, node.weights, Number.isFinite, 'finite numbers');
  });
  json.skins?.forEach((skin, s) => requireList(`skins[${s}].joints`, skin.joints ?? null, Number.isInteger, 'numbers'));
  json.scenes?.forEach((scene, s) => requireList(`scenes[${s}].nodes`, scene.nodes, Number.isInteger, 'numbers'));
}

/** @throws {InputError} if a value is there, but no array of what fits. */
export function requireList(name: string, value: unknown, fits: (item: unknown) => boolean, what: string): void {
  if (value !== undefined && !(Array.isArray(value) && value.every(fits)))
    throw new InputError(`${name} is not an array of ${what}`);
}

/**
 * Checks that every reference and every range of bytes that the geometry of a glTF needs exists, so that a damaged file causes a
 * clear message and not an error inside a decoder.
 * @param bytes  The size of each buffer, `undefined` for one without bytes (a fallback for compressed views).
 * @throws {InputError}
 */
export function checkGeometry(json: GLTF.IGLTF, bytes: (number | undefined)[]): void {
  checkViews(json, bytes);
  checkAccessors(json);
  checkMeshes(json);
  checkNodes(json);
}

function checkViews({ bufferViews = [] }: GLTF.IGLTF, bytes: (number | undefined)[]): void {
  bufferViews.forEach((view, v) => {
    const name = `bufferViews[${v}]`;
    const compressed = meshoptView(view);
    range(
      name,
      index(`${name}.buffer`, view.buffer, bytes.length, 'buffers'),
      view.byteOffset ?? 0,
      view.byteLength,
      compressed !== undefined,
    );
    if (compressed) {
      range(
        `${name} (compressed)`,
        index(`${name}.buffer`, compressed.buffer, bytes.length, 'buffers'),
        compressed.byteOffset ?? 0,
        compressed.byteLength,
        false,
      );
      const decoded = whole(`${name}.count`, compressed.count) * whole(`${name}.byteStride`, compressed.byteStride);
      if (decoded !== view.byteLength)
        throw new InputError(`${name} (compressed) holds ${decoded} bytes, not the ${view.byteLength} of its view`);
    }
  });

  function range(name: string, buffer: number, offset: number, length: number, mayLack: boolean): void {
    whole(`${name}.byteOffset`, offset);
    whole(`${name}.byteLength`, length);
    const size = bytes[buffer];
    if (!mayLack && offset + length > (size ?? -1)) {
      throw new InputError(`${name} ends at byte ${offset + length} of buffers[${buffer}], which has ${size ?? 0}`);
    }
  }
}

function checkAccessors({ bufferViews = [], accessors = [] }: GLTF.IGLTF): void {
  accessors.forEach((accessor, a) => {
    const name = `accessors[${a}]`;
    const component = componentBytes[accessor.componentType];
    const components = typeComponents[accessor.type];
    if (component === undefined)
      throw new InputError(`${name}.componentType = ${show(accessor.componentType)} is unknown`);
    if (components === undefined) throw new InputError(`${name}.type = ${show(accessor.type)} is unknown`);
    if (whole(`${name}.count`, accessor.count) > kMaxCount)
      throw new InputError(`${name}.count = ${accessor.count} is more than ${kMaxCount}`);
    if (accessor.bufferView !== undefined)
      within(name, accessor.bufferView, accessor.byteOffset ?? 0, component * components, accessor.count);
    if (accessor.sparse) {
      const { count, indices, values } = accessor.sparse;
      if (whole(`${name}.sparse.count`, count) > accessor.count)
        throw new InputError(`${name}.sparse.count = ${count} is more than its count ${accessor.count}`);
      within(
        `${name}.sparse.indices`,
        indices?.bufferView,
        indices?.byteOffset ?? 0,
        componentBytes[indices?.componentType] ?? 4,
        count,
      );
      within(`${name}.sparse.values`, values?.bufferView, values?.byteOffset ?? 0, component * components, count);
    }
  });

  function within(name: string, at: unknown, offset: number, elementBytes: number, count: number): void {
    const view = bufferViews[index(`${name}.bufferView`, at, bufferViews.length, 'bufferViews')]!;
    whole(`${name}.byteOffset`, offset);
    const stride = view.byteStride ?? elementBytes;
    const end = count === 0 ? 0 : offset + stride * (count - 1) + elementBytes;
    if (end > view.byteLength)
      throw new InputError(`${name} ends at byte ${end} of bufferViews[${at}], which has ${view.byteLength}`);
  }
}

function checkMeshes({ bufferViews = [], accessors = [], meshes = [], materials = [] }: GLTF.IGLTF): void {
  meshes.forEach((mesh, m) => {
    if (mesh.primitives.length === 0) throw new InputError(`meshes[${m}] has no primitives`);
    mesh.primitives.forEach((primitive, p) => {
      const name = `meshes[${m}].primitives[${p}]`;
      if (typeof primitive.attributes !== 'object' || primitive.attributes === null)
        throw new InputError(`${name} has no attributes`);
      const vertexCount = accessors[primitive.attributes['POSITION']!]?.count ?? 0;
      const attribute = (place: string, accessor: unknown) => {
        const { count } = accessors[index(place, accessor, accessors.length, 'accessors')]!;
        if (count < vertexCount) throw new InputError(`${place} has ${count} elements for ${vertexCount} vertices`);
      };
      for (const [semantic, accessor] of Object.entries(primitive.attributes))
        attribute(`${name}.attributes.${semantic}`, accessor);
      if (primitive.indices !== undefined) index(`${name}.indices`, primitive.indices, accessors.length, 'accessors');
      primitive.targets?.forEach((deltas, t) => {
        for (const [semantic, accessor] of Object.entries(deltas))
          attribute(`${name}.targets[${t}].${semantic}`, accessor);
      });
      if (primitive.material !== undefined)
        index(`${name}.material`, primitive.material, materials.length, 'materials');
      const draco = dracoOf(primitive);
      if (draco === undefined) return;
      if (typeof draco?.attributes !== 'object' || draco.attributes === null)
        throw new InputError(`${name} (compressed) has no attributes`);
      index(`${name} (compressed).bufferView`, draco.bufferView, bufferViews.length, 'bufferViews');
    });
  });
}

function checkNodes(json: GLTF.IGLTF): void {
  const { accessors = [], meshes = [], nodes = [], scenes = [], skins = [] } = json;
  const parents = new Array<number | undefined>(nodes.length);
  nodes.forEach((node, n) => {
    if (node.mesh !== undefined) index(`nodes[${n}].mesh`, node.mesh, meshes.length, 'meshes');
    if (node.skin !== undefined) index(`nodes[${n}].skin`, node.skin, skins.length, 'skins');
    for (const [name, length] of [
      ['matrix', 16],
      ['translation', 3],
      ['rotation', 4],
      ['scale', 3],
    ] as const) {
      const value: unknown = node[name];
      if (value !== undefined && !(Array.isArray(value) && value.length === length && value.every(Number.isFinite))) {
        throw new InputError(`nodes[${n}].${name} is not ${length} finite numbers`);
      }
    }
    for (const child of node.children ?? []) {
      index(`nodes[${n}].children`, child, nodes.length, 'nodes');
      if (parents[child] !== undefined)
        throw new InputError(`nodes[${child}] has two parents, nodes[${parents[child]}] and nodes[${n}]`);
      parents[child] = n;
    }
  });
  skins.forEach(({ joints = [], inverseBindMatrices }, s) => {
    for (const joint of joints) index(`skins[${s}].joints`, joint, nodes.length, 'nodes');
    if (inverseBindMatrices !== undefined)
      index(`skins[${s}].inverseBindMatrices`, inverseBindMatrices, accessors.length, 'accessors');
  });
  if (json.scene !== undefined) index('scene', json.scene, scenes.length, 'scenes');
  scenes.forEach((scene, s) => {
    const roots = new Set<number>();
    for (const node of scene.nodes ?? []) {
      index(`scenes[${s}].nodes`, node, nodes.length, 'nodes');
      if (roots.has(node)) throw new InputError(`nodes[${node}] is twice a root of scenes[${s}]`);
      roots.add(node);
      // With one parent at most for every node, a root cannot be in a cycle.
      if (parents[node] !== undefined)
        throw new InputError(`nodes[${node}] is a root of scenes[${s}] and a child of nodes[${parents[node]}]`);
    }
  });
}

/** The Draco form of a primitive, if it has one. */
export function dracoOf(
  primitive: GLTF.IMeshPrimitive,
): { bufferView: number; attributes: Record<string, number> } | undefined {
  return primitive.extensions?.['KHR_draco_mesh_compression'] as ReturnType<typeof dracoOf>;
}

function index(name: string, value: unknown, count: number, list: string): number {
  if (!Number.isInteger(value) || (value as number) < 0 || (value as number) >= count) {
    throw new InputError(`${name} = ${show(value)} is out of range (${count} ${list})`);
  }
  return value as number;
}

function whole(name: string, value: unknown): number {
  if (!Number.isSafeInteger(value) || (value as number) < 0)
    throw new InputError(`${name} = ${show(value)} is not a whole number`);
  return value as number;
}
