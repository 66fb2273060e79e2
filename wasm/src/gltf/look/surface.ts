import type { GLTF } from '@gltf-transform/core';
import { glow } from '../../scene/materials.js';
import { overlayMark } from '../../scene/overlay-mark.js';
import { tintToon, toonExtension } from '../../scene/toon.js';
import { copyProperties } from '../output/vrm-materials.js';
import type { OverlaidLook, TextureWriter } from '../overlay.js';

/** Images in the cage's UVs with the values of a material where no layer covers them, which lacks such textures. */
export interface Channels {
  /** Colours are there for a surface of one colour: mixed with it. */
  images: Partial<Record<'color' | 'normal' | 'orm' | 'emissive', Uint8Array>>;
  /** By what the colours of the glow have to be multiplied. */
  strength: number;
}

/** A look on materials. @param tint  By what their colours are multiplied, in linear light. @param channels  By their numbers. */
export function overlaidBy(
  tint: readonly number[] | undefined,
  channels: ReadonlyMap<number | undefined, Channels>,
): OverlaidLook {
  const known = new Map<Uint8Array, number>();
  return {
    addSurface(writer, number, texCoord) {
      const made = addTinted(writer, number, tint);
      const own = channels.get(number);
      if (own) layChannels(writer, made.material, own, { texCoord, known });
      const { color, normal } = own?.images ?? {};
      return { number: made.number, hasColors: color !== undefined, hasRelief: normal !== undefined };
    },
    lay(writer, overlay, number) {
      const { images = {}, strength = 1 } = channels.get(number) ?? {};
      const { color: _, ...others } = images;
      layChannels(writer, overlay, { images: others, strength }, { texCoord: 0, known });
    },
  };
}

/** Gives a material the channels of a look, by a set of UVs, instead of what it says of them. */
function layChannels(
  writer: TextureWriter,
  material: GLTF.IMaterial,
  { images: { color, normal, orm, emissive }, strength }: Channels,
  { texCoord, known }: { texCoord: number; known: Map<Uint8Array, number> },
): void {
  const on = (bytes: Uint8Array): GLTF.ITextureInfo => {
    const index = known.get(bytes) ?? writer.addTexture({ bytes, mimeType: 'image/png', name: 'look' });
    known.set(bytes, index);
    return { index, ...(texCoord > 0 && { texCoord }) };
  };
  if (color) {
    const { baseColorFactor: [, , , alpha = 1] = [], ...pbr } = material.pbrMetallicRoughness ?? {};
    const factor = alpha < 1 && { baseColorFactor: [1, 1, 1, alpha] };
    material.pbrMetallicRoughness = { ...pbr, ...factor, baseColorTexture: on(color) };
  }
  if (normal) material.normalTexture = on(normal);
  if (orm) {
    const { roughnessFactor: _, metallicFactor: __, ...pbr } = material.pbrMetallicRoughness ?? {};
    material.pbrMetallicRoughness = { ...pbr, metallicRoughnessTexture: on(orm) };
  }
  if (!emissive) return;
  material.emissiveTexture = on(emissive);
  glow(writer.json, material, strength);
}

/** Adds a copy of a material, tinted, for triangles of its surface. @returns its number. */
function addTinted(
  { json }: TextureWriter,
  number: number | undefined,
  tint: readonly number[] = [1, 1, 1],
): { number: number; material: GLTF.IMaterial } {
  const source = json.materials?.[number ?? -1];
  const material: GLTF.IMaterial = structuredClone(source ?? {});
  const [r = 1, g = 1, b = 1, alpha = 1] = material.pbrMetallicRoughness?.baseColorFactor ?? [];
  const factor = [r * tint[0]!, g * tint[1]!, b * tint[2]!, alpha];
  material.pbrMetallicRoughness = { ...material.pbrMetallicRoughness, baseColorFactor: factor };
  material.extras = { ...(material.extras as object | undefined), ...overlayMark, cagecastInPlace: true };
  const toon = material.extensions?.[toonExtension] as { shadeColorFactor?: number[] } | undefined;
  if (toon?.shadeColorFactor) toon.shadeColorFactor = toon.shadeColorFactor.map((share, k) => share * tint[k]!);
  (json.materials ??= []).push(material);
  copyProperties(json, number, (properties) => tintToon(properties, tint));
  return { number: json.materials.length - 1, material };
}
