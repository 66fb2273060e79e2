import type { GLTF } from '@gltf-transform/core';
import { isOverlay, overlaysInPlaceOf } from '../scene/overlay-mark.js';
import { extensionsByType, type GlbWriter } from './glb-writer.js';
import type { GltfFile } from './open-gltf.js';
import { dropProperties } from './output/vrm-materials.js';
import { isOfTransfer } from './overlay.js';
import { eachTexture, numbersOf } from './references.js';

/** Removes the UVs and zones of an earlier transfer from primitives. */
export function removeAttributes({ json }: GlbWriter, primitives: readonly GLTF.IMeshPrimitive[]): void {
  for (const { attributes } of primitives)
    for (const [semantic, accessor] of Object.entries(attributes))
      if (isOfTransfer(semantic, json.accessors![accessor]!.extras)) delete attributes[semantic];
}

/** Gives primitives the triangles back that overlays have in their place. */
function giveBack(writer: GlbWriter, { accessors }: GltfFile, mesh: GLTF.IMesh): void {
  for (const primitive of mesh.primitives) {
    const overlays = overlaysInPlaceOf(primitive, mesh);
    if (overlays.length === 0) continue;
    const all = [primitive, ...overlays].flatMap(({ indices }) => [...accessors[indices!]!.getArray()!]);
    const { count } = writer.json.accessors![primitive.attributes['POSITION']!]!;
    primitive.indices = writer.addIndices(Uint32Array.from(all), count);
  }
}

/**
 * Removes the overlays of earlier transfers from meshes, with the materials and images that only they used. Of those, only the last
 * ones of their lists go, as extensions may know the others by their numbers.
 * @returns how many overlays.
 */
export function removeOverlays(writer: GlbWriter, file: GltfFile, meshes: Iterable<GLTF.IMesh>): number {
  const { json } = writer;
  const removed = [...new Set(meshes)].flatMap((mesh) => {
    const { primitives } = mesh;
    giveBack(writer, file, mesh);
    const overlays = primitives.filter((primitive) => isOverlay(primitive, mesh, json));
    if (overlays.length > 0) primitives.splice(0, Infinity, ...primitives.filter((one) => !overlays.includes(one)));
    return overlays;
  });
  const materials = dropLast(
    json,
    'materials',
    removed.map(({ material }) => material),
    (number) => hasReference(json.meshes, /^material$/, number) || hasReference(json.extensions, /^material$/, number),
  );
  dropProperties(json, materials.length);
  const textures = dropLast(
    json,
    'textures',
    [...numbersOf(eachTexture, { materials } as GLTF.IGLTF)],
    (number) =>
      hasReference(json.materials, /^index$/, number) || hasReference(json.extensions, /^(texture|_\w+)$/, number),
  );
  dropLast(
    json,
    'images',
    textures.flatMap(({ source, extensions = {} }) => [
      source,
      ...Object.values(extensions as Record<string, GLTF.ITexture>).map((extension) => extension.source),
    ]),
    (number) =>
      hasReference(json.textures, /^source$/, number) || hasReference(json.extensions, /^thumbnailImage$/, number),
  );
  for (const extension of Object.values(extensionsByType))
    if (
      textures.some(({ extensions }) => extensions?.[extension]) &&
      !json.textures?.some(({ extensions }) => extensions?.[extension])
    )
      writer.unlistExtension(extension);
  return removed.length;
}

/** Drops elements from the end of a list, as long as they are among some that are not used any more. @returns them. */
function dropLast<Name extends 'materials' | 'textures' | 'images'>(
  json: GLTF.IGLTF,
  name: Name,
  numbers: readonly (number | undefined)[],
  isUsed: (number: number) => boolean,
): NonNullable<GLTF.IGLTF[Name]>[number][] {
  const list: NonNullable<GLTF.IGLTF[Name]>[number][] = json[name] ?? [];
  const dropped = [];
  for (let last = list.length - 1; numbers.includes(last) && !isUsed(last); --last) dropped.push(list.pop()!);
  if (list.length === 0) delete json[name];
  return dropped;
}

/** Whether anything in a value refers to a number by one of some keys. */
function hasReference(value: unknown, keys: RegExp, number: number): boolean {
  const stack = [value];
  for (let next = stack.pop(); next !== undefined; next = stack.pop()) {
    if (typeof next !== 'object' || next === null) continue;
    for (const [key, child] of Object.entries(next)) {
      if (child === number && keys.test(key)) return true;
      if (typeof child === 'object') stack.push(child);
    }
  }
  return false;
}
