import type { GLTF } from '@gltf-transform/core';

/** The extension of VRM 1 for toon materials. */
export const toonExtension = 'VRMC_materials_mtoon';

/** What VRM 0 says of a material. */
export interface ToonProperties {
  shader?: string;
  floatProperties?: Record<string, number>;
  vectorProperties?: Record<string, number[]>;
  textureProperties?: Record<string, number>;
  keywordMap?: Record<string, boolean>;
}

/** What VRM 0 says of a material; undefined in other files. */
export const toonProperties = ({ extensions }: GLTF.IGLTF, material: number): ToonProperties | undefined =>
  (extensions?.['VRM'] as { materialProperties?: ToonProperties[] } | undefined)?.materialProperties?.[material];

/** The exponent of the colours of VRM 0, which are those of a display. */
export const toonGamma = 2.2;

/** Tints a toon material of VRM 0. */
export function tintToon({ vectorProperties: colors = {} }: ToonProperties, tint: readonly number[]): void {
  for (const [name, color] of Object.entries(colors))
    if (/^_(Shade)?Color$/.test(name))
      colors[name] = color.map((share, k) => share * (tint[k] ?? 1) ** (1 / toonGamma));
}

/** By what a toon material multiplies its texture in the shade. */
export function shadeFactorOf(json: GLTF.IGLTF, number: number): number[] {
  const toon = json.materials![number]!.extensions?.[toonExtension] as { shadeColorFactor?: number[] } | undefined;
  if (toon) return toon.shadeColorFactor ?? [0, 0, 0];
  const { _ShadeColor: color = [0.97, 0.81, 0.86] } = toonProperties(json, number)?.vectorProperties ?? {};
  return color.map((share) => share ** toonGamma);
}

/** The texture of a toon material in the shade. */
export function shadeInfoOf(json: GLTF.IGLTF, number: number): GLTF.ITextureInfo | undefined {
  const material = json.materials![number]!;
  const toon = material.extensions?.[toonExtension] as { shadeMultiplyTexture?: GLTF.ITextureInfo } | undefined;
  if (toon) return toon.shadeMultiplyTexture;
  const index = toonProperties(json, number)?.textureProperties?.['_ShadeTexture'];
  return index === undefined ? undefined : { ...material.pbrMetallicRoughness?.baseColorTexture, index };
}
