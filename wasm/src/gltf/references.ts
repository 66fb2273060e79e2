import type { GLTF } from '@gltf-transform/core';
import { instancing } from '../scene/instancing.js';
import { isOverlay } from '../scene/overlay-mark.js';
import { dracoOf } from './checks/check-geometry.js';
import { isOfTransfer } from './overlay.js';

/** Where the number of an accessor or of a view stands: a key of an object. */
export type Visit = (owner: Record<string, number>, key: string) => void;

/** Visits all references to accessors that this package knows. */
export function eachAccessor({ meshes, skins, animations, nodes }: GLTF.IGLTF, visit: Visit): void {
  const all = (owner: unknown) => {
    const map = (owner ?? {}) as Record<string, number>;
    for (const key of Object.keys(map)) visit(map, key);
  };
  const one = (owner: unknown, key: string) => {
    const map = owner as Record<string, number>;
    if (map[key] !== undefined) visit(map, key);
  };
  for (const { primitives } of meshes ?? []) {
    for (const primitive of primitives) {
      all(primitive.attributes);
      one(primitive, 'indices');
      primitive.targets?.forEach(all);
    }
  }
  skins?.forEach((skin) => one(skin, 'inverseBindMatrices'));
  for (const { samplers } of animations ?? []) {
    for (const sampler of samplers ?? []) {
      one(sampler, 'input');
      one(sampler, 'output');
    }
  }
  for (const { extensions } of nodes ?? [])
    all((extensions?.[instancing] as { attributes?: unknown } | undefined)?.attributes);
}

/** Visits all references to views, those of unknown extensions included: all keys that are called so, except in extras. */
export function eachView(json: GLTF.IGLTF, visit: Visit): void {
  const stack: unknown[] = [json];
  for (let value = stack.pop(); value !== undefined; value = stack.pop()) {
    if (typeof value !== 'object' || value === null) continue;
    for (const [key, child] of Object.entries(value)) {
      if (key === 'bufferView' && typeof child === 'number') visit(value as Record<string, number>, key);
      else if (key !== 'extras' && typeof child === 'object' && child !== null) stack.push(child);
    }
  }
}

/** Extensions that refer to accessors and views as above, or not at all. */
const kKnown = /^(KHR_|VRM|EXT_(texture_|materials_|lights_|meshopt_compression|mesh_gpu_instancing))/;

/** Whether extensions may refer to accessors and views by keys that nobody knows here. */
export const hasUnknownReferences = ({ extensionsUsed = [] }: GLTF.IGLTF): boolean =>
  extensionsUsed.some((name) => !kKnown.test(name));

/**
 * A glTF of what an earlier transfer added, attributes and the indices of overlays, and of what no unknown extension refers to: images,
 * and geometry that Draco compressed, of which only the stream has the bytes.
 */
export function addedByTransfer(json: GLTF.IGLTF): GLTF.IGLTF {
  const { meshes = [], accessors = [], images = [] } = json;
  const isAdded = ([semantic, accessor]: [string, number]) => isOfTransfer(semantic, accessors[accessor]!.extras);
  const primitives = meshes.flatMap((mesh) =>
    mesh.primitives.map((primitive): GLTF.IMeshPrimitive => {
      const { attributes, indices, extensions } = primitive;
      const isDraco = dracoOf(primitive) !== undefined;
      const isInStream = (accessor: number) => {
        const { bufferView, sparse } = accessors[accessor]!;
        return isDraco && bufferView === undefined && sparse === undefined;
      };
      return {
        attributes: Object.fromEntries(Object.entries(attributes).filter((one) => isAdded(one) || isInStream(one[1]))),
        ...(indices !== undefined && (isOverlay(primitive, mesh, json) || isInStream(indices)) && { indices }),
        ...(extensions && { extensions }),
      };
    }),
  );
  const added = { asset: { version: '2.0' }, meshes: [{ primitives }], images };
  return { ...added, accessors: [...numbersOf(eachAccessor, added)].map((accessor) => accessors[accessor]!) };
}

/** The numbers that are visited. */
export function numbersOf(each: (json: GLTF.IGLTF, visit: Visit) => void, json: GLTF.IGLTF): Set<number> {
  const found = new Set<number>();
  each(json, (owner, key) => found.add(owner[key]!));
  return found;
}

/**
 * Drops elements of a list: the last ones move to where they were, so that as few numbers as possible change.
 * @param isDropped  By the element's number.
 * @param fixed  How many elements keep their numbers; if nothing can take the place of one of them, it stays.
 */
export function drop<Element>(
  list: Element[],
  isDropped: (element: number) => boolean,
  each: (visit: Visit) => void,
  fixed: number,
): void {
  const places = list.map((_, element) => element);
  const kept = places.filter((element) => !isDropped(element));
  if (kept.length === list.length) return;
  const before = [...list];
  for (let to = 0; to < kept.length; ++to) {
    if (kept[to] === to) continue;
    kept.splice(to, 0, kept.at(-1)! < fixed ? to : kept.pop()!);
  }
  list.splice(0, list.length, ...kept.map((element) => before[element]!));
  kept.forEach((element, to) => (places[element] = to));
  each((owner, key) => (owner[key] = places[owner[key]!]!));
}

/** Visits all references from the materials of a glTF and their extensions to textures. */
export function eachTexture({ materials }: GLTF.IGLTF, visit: Visit): void {
  const stack: unknown[] = [...(materials ?? [])];
  for (let value = stack.pop(); value !== undefined; value = stack.pop()) {
    if (typeof value !== 'object' || value === null) continue;
    if (Number.isInteger((value as { index?: unknown }).index)) visit(value as Record<string, number>, 'index');
    for (const [key, child] of Object.entries(value)) if (key !== 'extras') stack.push(child ?? 0);
  }
}

/** Visits all references to images: of textures and their extensions, and the thumbnail of VRM 1. */
export function eachImage({ textures, extensions }: GLTF.IGLTF, visit: Visit): void {
  const meta = (extensions?.['VRMC_vrm'] as { meta?: Record<string, number> } | undefined)?.meta;
  if (Number.isInteger(meta?.['thumbnailImage'])) visit(meta!, 'thumbnailImage');
  for (const texture of textures ?? [])
    for (const owner of [texture, ...Object.values(texture.extensions ?? {})] as Record<string, number>[])
      if (Number.isInteger(owner['source'])) visit(owner, 'source');
}

/** Visits all references to materials: of primitives, and of the expressions of VRM 1. */
export function eachMaterial(json: GLTF.IGLTF, visit: Visit): void {
  for (const primitive of (json.meshes ?? []).flatMap(({ primitives }) => primitives))
    if (primitive.material !== undefined) visit(primitive as unknown as Record<string, number>, 'material');
  for (const bind of materialBinds(json)) visit(bind, 'material');
}

/** What the expressions of VRM 1 do to materials. */
export function materialBinds({ extensions }: GLTF.IGLTF): Record<string, number>[] {
  type Expression = Record<'materialColorBinds' | 'textureTransformBinds', Record<string, number>[] | undefined>;
  const { expressions } = (extensions?.['VRMC_vrm'] ?? {}) as {
    expressions?: Record<'preset' | 'custom', Record<string, Expression> | undefined>;
  };
  return [expressions?.preset, expressions?.custom]
    .flatMap((list) => Object.values(list ?? {}))
    .flatMap((one) => [...(one.materialColorBinds ?? []), ...(one.textureTransformBinds ?? [])]);
}
