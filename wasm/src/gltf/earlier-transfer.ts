import type { GLTF } from '@gltf-transform/core';
import { type GlbWriter, imageExtensions } from './glb-writer.js';
import { isOfTransfer, isOverlay } from './overlay.js';

/** Takes the UVs and zones of an earlier transfer from primitives. */
export function takeAttributes({ json }: GlbWriter, primitives: readonly GLTF.IMeshPrimitive[]): void {
  for (const { attributes } of primitives)
    for (const [semantic, accessor] of Object.entries(attributes))
      if (isOfTransfer(semantic, json.accessors![accessor]!.extras)) delete attributes[semantic];
}

/**
 * Takes the overlays of earlier transfers out of meshes, with the materials and images that only they used. Of those, only the last
 * ones of their lists go, as extensions may know the others by their numbers.
 * @returns how many overlays.
 */
export function takeOverlays(writer: GlbWriter, meshes: Iterable<GLTF.IMesh>): number {
  const { json } = writer;
  const taken = [...new Set(meshes)].flatMap(({ primitives }) => {
    const overlays = primitives.filter((primitive) => isOverlay(primitive, json));
    if (overlays.length > 0) primitives.splice(0, Infinity, ...primitives.filter((one) => !overlays.includes(one)));
    return overlays;
  });
  const materials = dropLast(
    json,
    'materials',
    taken.map(({ material }) => material),
    (number) => names(json.meshes, /^material$/, number) || names(json.extensions, /^material$/, number),
  );
  const textures = dropLast(
    json,
    'textures',
    materials.map(({ pbrMetallicRoughness: pbr }) => pbr?.baseColorTexture?.index),
    (number) => names(json.materials, /^index$/, number) || names(json.extensions, /^(texture|_\w+)$/, number),
  );
  dropLast(
    json,
    'images',
    textures.flatMap(({ source, extensions = {} }) => [
      source,
      ...Object.values(extensions as Record<string, GLTF.ITexture>).map((extension) => extension.source),
    ]),
    (number) => names(json.textures, /^source$/, number) || names(json.extensions, /^thumbnailImage$/, number),
  );
  for (const extension of Object.values(imageExtensions))
    if (
      textures.some(({ extensions }) => extensions?.[extension]) &&
      !json.textures?.some(({ extensions }) => extensions?.[extension])
    )
      writer.needs(extension, false);
  return taken.length;
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

/** Whether a number stands anywhere in a value under one of some keys. */
function names(value: unknown, keys: RegExp, number: number): boolean {
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
