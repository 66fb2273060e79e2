import type { GLTF } from '@gltf-transform/core';
import { transformUvs, type UvTransform } from '../parts/uv-transform.js';
import { InputError } from './input-error.js';

/** The members of KHR_texture_transform that a file has. */
type StoredTransform = { [Name in keyof UvTransform]?: unknown } & { texCoord?: number };

/** How a texture is laid on a primitive. */
export interface UvLayout {
  /** The UV set: "TEXCOORD_0". */
  set: string;
  transform: StoredTransform | undefined;
}

export function uvLayoutOf(info: GLTF.ITextureInfo | undefined): UvLayout {
  const transform = info?.extensions?.['KHR_texture_transform'] as StoredTransform | undefined;
  return { set: `TEXCOORD_${transform?.texCoord ?? info?.texCoord ?? 0}`, transform };
}

/** Where UVs are in a texture that is laid so. @throws {InputError} if a member is not of finite numbers. */
export function layUvs(uvs: Float32Array, transform: StoredTransform | undefined): Float32Array {
  if (!transform) return uvs;
  const { offset = [0, 0], rotation = 0, scale = [1, 1] } = transform;
  for (const [name, value] of Object.entries({ offset, rotation: [rotation, 0], scale }))
    if (!(Array.isArray(value) && value.length === 2 && value.every(Number.isFinite)))
      throw new InputError(`${name} of KHR_texture_transform is not of finite numbers`);
  return transformUvs(uvs, { offset, rotation, scale } as UvTransform);
}
