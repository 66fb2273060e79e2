import type { GLTF } from '@gltf-transform/core';
import type { ToonProperties } from '../../scene/toon.js';

/** What VRM 0 says of each material, in the order of `materials`; none in other files. @param more  Materials that are gone. */
function propertiesIn({ extensions, materials = [] }: GLTF.IGLTF, more = 0): object[] | undefined {
  const list = (extensions?.['VRM'] as { materialProperties?: unknown } | undefined)?.materialProperties;
  return Array.isArray(list) && list.length === materials.length + more ? list : undefined;
}

/** What VRM 0 says of a material that is shown as glTF describes it. */
const gltfShader = (material: GLTF.IMaterial): object => ({
  name: material.name,
  shader: 'VRM_USE_GLTFSHADER',
  renderQueue: material.alphaMode === 'BLEND' ? 3000 : 2000, // as of what is transparent, or not
  floatProperties: {},
  vectorProperties: {},
  textureProperties: {},
  keywordMap: {},
  tagMap: {},
});

/** Adds a material that is shown as glTF describes it, in VRM 0 too. @returns its number. */
export function addMaterial(json: GLTF.IGLTF, material: GLTF.IMaterial): number {
  propertiesIn(json)?.push(gltfShader(material));
  return (json.materials ??= []).push(material) - 1;
}

/** Says of the last material what VRM 0 says of another one, with a change; if that has none, that it is as glTF describes it. */
export function copyProperties(
  json: GLTF.IGLTF,
  number: number | undefined,
  change: (properties: ToonProperties) => void,
): void {
  const list = propertiesIn(json, -1);
  if (!list) return;
  const copy = structuredClone(list[number ?? -1] ?? gltfShader(json.materials!.at(-1)!));
  change(copy as ToonProperties);
  list.push(copy);
}

/** Whether a material draws an outline, by the triangles of what has it: MToon of VRM 0 and VRM 1. */
export function isOutlined(json: GLTF.IGLTF, material = -1): boolean {
  const toon = json.materials?.[material]?.extensions?.['VRMC_materials_mtoon'] as { outlineWidthMode?: string };
  const old = propertiesIn(json)?.[material] as { floatProperties?: { _OutlineWidthMode?: number } } | undefined;
  return (toon?.outlineWidthMode ?? 'none') !== 'none' || (old?.floatProperties?._OutlineWidthMode ?? 0) !== 0;
}

/** Drops what VRM 0 says of the last materials, which were dropped. */
export function dropProperties(json: GLTF.IGLTF, dropped: number): void {
  const list = propertiesIn(json, dropped);
  list?.splice(list.length - dropped, dropped);
}
