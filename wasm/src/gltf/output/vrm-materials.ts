import type { GLTF } from '@gltf-transform/core';

/** What VRM 0 says of each material, in the order of `materials`; none in other files. @param more  Materials that are gone. */
function propertiesIn({ extensions, materials = [] }: GLTF.IGLTF, more = 0): object[] | undefined {
  const list = (extensions?.['VRM'] as { materialProperties?: unknown } | undefined)?.materialProperties;
  return Array.isArray(list) && list.length === materials.length + more ? list : undefined;
}

/** Adds a material that is shown as glTF describes it, in VRM 0 too. @returns its number. */
export function addMaterial(json: GLTF.IGLTF, material: GLTF.IMaterial): number {
  propertiesIn(json)?.push({
    name: material.name,
    shader: 'VRM_USE_GLTFSHADER',
    renderQueue: material.alphaMode === 'BLEND' ? 3000 : 2000, // as of what is transparent, or not
    floatProperties: {},
    vectorProperties: {},
    textureProperties: {},
    keywordMap: {},
    tagMap: {},
  });
  return (json.materials ??= []).push(material) - 1;
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
