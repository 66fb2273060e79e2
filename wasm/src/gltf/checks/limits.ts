import type { GLTF } from '@gltf-transform/core';
import { instancing } from '../../scene/instancing.js';
import { isMarked } from '../../scene/overlay-mark.js';
import { hasTriangles } from '../../scene/pieces.js';
import { topNodes } from '../../scene/source.js';
import { bytesOf, dracoOf, meshoptView } from './check-geometry.js';
import { checkExpansion } from './check-images.js';
import { exceeds, type ReadLimits } from './read-limits.js';

/** Geometry of up to this many bytes may be decoded from any file. */
const kFreeBytes = 2 ** 25;

/** Checks how deep JSON is nested, before it is parsed. @throws {InputError} */
export function checkNesting(text: Uint8Array, limits: ReadLimits): void {
  const [quote, backslash, openList, closeList, openObject, closeObject] = [0x22, 0x5c, 0x5b, 0x5d, 0x7b, 0x7d];
  let depth = 0;
  let inString = false;
  for (let at = 0; at < text.length; ++at) {
    const byte = text[at];
    if (inString) {
      if (byte === backslash) ++at;
      else if (byte === quote) inString = false;
    } else if (byte === quote) inString = true;
    else if (byte === openList || byte === openObject) {
      if (++depth > limits.nesting)
        throw exceeds(`its JSON is nested more than ${limits.nesting} deep`, 'nesting', limits);
    } else if (byte === closeList || byte === closeObject) --depth;
  }
}

/**
 * Checks what decoding and showing a glTF costs. Its references must have been checked.
 * @param fileBytes  Of all its files together.
 * @throws {InputError} that names the element, the value and the limit.
 */
export function checkLimits(json: GLTF.IGLTF, fileBytes: number, limits: ReadLimits): void {
  checkNodeDepth(json, limits);
  checkParts(json, limits);
  checkImplied(json, limits);
  const decoded = checkInstances(json, limits) + decodedBytes(json) + sharedBytes(json);
  checkExpansion('decodes', decoded, Math.max(kFreeBytes, limits.expansion * fileBytes), fileBytes, limits);
}

function checkParts({ nodes = [], meshes = [] }: GLTF.IGLTF, limits: ReadLimits): void {
  let parts = 0;
  nodes.forEach(({ mesh }, n) => {
    parts += 1 + (mesh === undefined ? 0 : meshes[mesh]!.primitives.length);
    if (parts > limits.parts)
      throw exceeds(`nodes[${n}] is part ${parts.toLocaleString('en')} of the scene`, 'parts', limits);
  });
}

function checkNodeDepth({ nodes = [] }: GLTF.IGLTF, limits: ReadLimits): void {
  let level = topNodes(nodes);
  for (let depth = 1; level.length > 0; ++depth) {
    if (depth > limits.nesting) throw exceeds(`nodes[${level[0]}] is on level ${depth}`, 'nesting', limits);
    level = level.flatMap((node) => nodes[node]!.children ?? []);
  }
}

/** @returns the bytes of all positions and corners, counted as often as the scene shows them. */
function checkInstances({ accessors = [], meshes = [], nodes = [] }: GLTF.IGLTF, limits: ReadLimits): number {
  const [nodesOf, drawnOf] = [new Map<number, number>(), new Map<number, number>()];
  for (const { mesh, extensions } of nodes) {
    if (mesh === undefined) continue;
    const [places] = Object.values(instancesOf(extensions));
    nodesOf.set(mesh, (nodesOf.get(mesh) ?? 0) + 1);
    drawnOf.set(mesh, (drawnOf.get(mesh) ?? 0) + (places === undefined ? 1 : (accessors[places]?.count ?? 0)));
  }
  // Overlays show the positions of their bases once more, so they are counted by themselves.
  const [uses, overlaid] = [new Map<number, number>(), new Map<number, number>()];
  let bytes = 0;
  for (const [mesh, count] of nodesOf) {
    for (const { attributes, indices, mode = 4, extras } of meshes[mesh]!.primitives) {
      const positions = attributes['POSITION'];
      if (positions === undefined || !hasTriangles(mode)) continue;
      const counts = isMarked(extras) ? overlaid : uses;
      const all = (counts.get(positions) ?? 0) + count;
      if (all > limits.instances)
        throw exceeds(`the positions of meshes[${mesh}] are in ${all} places of the scene`, 'instances', limits);
      counts.set(positions, all);
      const vertices = accessors[positions]!.count;
      bytes +=
        drawnOf.get(mesh)! * (12 * vertices + 4 * (indices === undefined ? vertices : accessors[indices]!.count));
    }
  }
  return bytes;
}

function checkImplied(json: GLTF.IGLTF, limits: ReadLimits): void {
  const { accessors = [], meshes = [] } = json;
  const used = new Map<number, string>();
  meshes.forEach(({ primitives }, m) =>
    primitives.forEach((primitive, p) => {
      if (dracoOf(primitive)) return; // its accessors have no bytes: they are in the compressed data
      const place = `meshes[${m}].primitives[${p}]`;
      const positions = accessors[primitive.attributes['POSITION']!];
      const inFile = positions?.bufferView === undefined ? 0 : positions.count;
      // Beside positions that are in the file, zeros cost in proportion to it; `expansion` counts them.
      for (const [semantic, accessor] of Object.entries(primitive.attributes))
        if (accessors[accessor]!.count > inFile) used.set(accessor, `${place}.attributes.${semantic}`);
      if (primitive.indices !== undefined) used.set(primitive.indices, `${place}.indices`);
    }),
  );
  json.nodes?.forEach(({ extensions }, n) => {
    for (const accessor of Object.values(instancesOf(extensions))) used.set(accessor, `nodes[${n}], ${instancing}`);
  });
  json.animations?.forEach(({ samplers = [] }, a) =>
    samplers.forEach(({ input, output }, i) => {
      for (const accessor of [input, output]) used.set(accessor, `animations[${a}].samplers[${i}]`);
    }),
  );
  let implied = 0;
  for (const [number, place] of used) {
    const { bufferView, count } = accessors[number] ?? { bufferView: 0, count: 0 };
    if (bufferView === undefined) implied += count;
    if (implied > limits.implied)
      throw exceeds(
        `accessors[${number}] (${place}) has ${count.toLocaleString('en')} elements that are not in the file`,
        'implied',
        limits,
      );
  }
}

/** The bytes of all accessors and of all compressed views, decoded. */
function decodedBytes({ accessors = [], bufferViews = [] }: GLTF.IGLTF): number {
  const views = bufferViews.map((view) => meshoptView(view)).map((view) => (view ? view.count * view.byteStride : 0));
  return [...views, ...accessors.map((accessor) => accessor.count * bytesOf(accessor))].reduce((sum, n) => sum + n, 0);
}

/**
 * What a viewer makes of what is used again: an array for each name that an attribute has, and for each morph target; matrices for the
 * joints of each skinned node; and the mesh's name for each part.
 */
function sharedBytes({ accessors = [], meshes = [], nodes = [], skins = [] }: GLTF.IGLTF): number {
  const known = new Set<string>();
  let bytes = 0;
  const add = (accessor: number | undefined) => {
    const found = accessors[accessor ?? -1];
    if (found) bytes += found.count * bytesOf(found);
  };
  for (const { attributes, targets = [] } of meshes.flatMap(({ primitives }) => primitives)) {
    for (const [semantic, accessor] of Object.entries(attributes)) {
      if (!known.has(`${accessor} ${semantic}`)) add(accessor);
      known.add(`${accessor} ${semantic}`);
    }
    for (const accessor of targets.flatMap((target) => Object.values(target))) add(accessor);
  }
  for (const { mesh, skin } of nodes) {
    if (skin !== undefined) bytes += kJointBytes * (skins[skin]?.joints.length ?? 0);
    const { name = '', primitives = [] } = meshes[mesh ?? -1] ?? {};
    bytes += 2 * name.length * primitives.length;
  }
  return bytes;
}

/** A joint's matrix, and that of its bind pose. */
const kJointBytes = 128;

/** The accessors by which a node draws its mesh many times. */
const instancesOf = (extensions: GLTF.INode['extensions']): Record<string, number> =>
  (extensions?.[instancing] as { attributes?: Record<string, number> } | undefined)?.attributes ?? {};
