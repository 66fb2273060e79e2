import type { GLTF } from '@gltf-transform/core';
import { InputError } from './input-error.js';

/** The members of KHR_texture_transform. */
interface UvTransform {
  offset: number[];
  /** Radians, counter-clockwise. */
  rotation: number;
  scale: number[];
  texCoord: number;
}

/** How a texture is laid on a primitive. */
export interface UvLayout {
  /** The UV set: "TEXCOORD_0". */
  set: string;
  transform: Partial<UvTransform> | undefined;
}

export function uvLayoutOf(info: GLTF.ITextureInfo | undefined): UvLayout {
  const transform = info?.extensions?.['KHR_texture_transform'] as Partial<UvTransform> | undefined;
  return { set: `TEXCOORD_${transform?.texCoord ?? info?.texCoord ?? 0}`, transform };
}

/**
 * Where UVs are in the texture: scaled, rotated, then moved, as KHR_texture_transform says; without it, where they are.
 * @throws {InputError} if a member is not of finite numbers.
 */
export function transformUvs(uvs: Float32Array, transform: UvLayout['transform']): Float32Array {
  if (!transform) return uvs;
  const { offset = [0, 0], rotation = 0, scale = [1, 1] } = transform;
  for (const [name, value] of Object.entries({ offset, rotation: [rotation, 0], scale }))
    if (!(Array.isArray(value) && value.length === 2 && value.every(Number.isFinite)))
      throw new InputError(`${name} of KHR_texture_transform is not of finite numbers`);
  const [cos, sin] = [Math.cos(rotation), Math.sin(rotation)];
  const out = new Float32Array(uvs.length);
  for (let i = 0; i < uvs.length; i += 2) {
    const [u, v] = [scale[0]! * uvs[i]!, scale[1]! * uvs[i + 1]!];
    out[i] = offset[0]! + cos * u + sin * v;
    out[i + 1] = offset[1]! - sin * u + cos * v;
  }
  return out;
}
