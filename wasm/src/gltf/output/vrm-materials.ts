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
    renderQueue: 3000, // as of what is transparent
    floatProperties: {},
    vectorProperties: {},
    textureProperties: {},
    keywordMap: {},
    tagMap: {},
  });
  return (json.materials ??= []).push(material) - 1;
}

/** Drops what VRM 0 says of the last materials, which were dropped. */
export function dropProperties(json: GLTF.IGLTF, dropped: number): void {
  const list = propertiesIn(json, dropped);
  list?.splice(list.length - dropped, dropped);
}
