import type { GLTF } from '@gltf-transform/core';
import { freeOf, type IsFree, leastSeen, mayBeClear } from '../bake/alpha.js';
import { decodeFloats } from './accessor.js';
import { remembered } from './base-colors.js';
import type { ImageCodec } from './materials.js';
import { decodeTriangles, hasTriangles } from './pieces.js';
import type { SceneSource } from './source.js';
import { layUvs, uvLayoutOf } from './uv-layout.js';

/**
 * The primitives whose base colour texture is transparent wherever they lie: a viewer draws nothing of them. Of images that may have
 * transparency each is decoded once; one that cannot be counts as opaque.
 */
export async function clearPrimitives(
  source: SceneSource,
  decode: ImageCodec['decode'] | undefined,
): Promise<ReadonlySet<GLTF.IMeshPrimitive>> {
  const { meshes = [], materials = [], textures = [] } = source.json;
  const found = new Set<GLTF.IMeshPrimitive>();
  if (!decode) return found;
  const imageOf = remembered(async (texture: number) => {
    const file = await source.imageOf(texture);
    return file && mayBeClear(file.bytes, file.mimeType) ? decode(file.bytes, file.mimeType) : undefined;
  });
  const grids = new Map<string, IsFree | undefined>();
  for (const primitive of meshes.flatMap((mesh) => mesh.primitives)) {
    const material = materials[primitive.material ?? -1];
    const {
      alphaMode: mode = 'OPAQUE',
      alphaCutoff = 0.5,
      pbrMetallicRoughness: { baseColorTexture: info, baseColorFactor } = {},
    } = material ?? {};
    if (mode === 'OPAQUE' || !info || !textures[info.index] || !hasTriangles(primitive.mode ?? 4)) continue;
    try {
      const least = leastSeen(mode === 'MASK' ? alphaCutoff : undefined, baseColorFactor?.[3] ?? 1);
      const key = `${info.index} ${least}`;
      const image = grids.has(key) ? undefined : await imageOf(info.index);
      if (!grids.has(key)) grids.set(key, image && freeOf(image, (alpha) => alpha >= least, false));
      const isFree = grids.get(key);
      if (isFree && isFreeOf(source, primitive, info, isFree)) found.add(primitive);
    } catch {
      // What is wrong with it is said where it is read for itself.
    }
  }
  return found;
}

/** Whether all triangles of a primitive are free. Elsewhere than at 0 … 1, a texture that does not repeat may show its border. */
function isFreeOf(
  { json: { textures = [], samplers = [] }, accessors }: SceneSource,
  { attributes, indices, mode = 4 }: GLTF.IMeshPrimitive,
  info: GLTF.ITextureInfo,
  isFree: IsFree,
): boolean {
  const { set, transform } = uvLayoutOf(info);
  const stored = accessors[attributes[set] ?? -1];
  if (stored?.getElementSize() !== 2) return false;
  const uvs = layUvs(decodeFloats(stored), transform);
  const { wrapS = kRepeat, wrapT = kRepeat } = samplers[textures[info.index]!.sampler ?? -1] ?? {};
  const doesRepeat = wrapS === kRepeat && wrapT === kRepeat;
  if (!uvs.every((x) => Number.isFinite(x) && (doesRepeat || (x >= 0 && x <= 1)))) return false;
  const corners = decodeTriangles('', accessors[indices ?? -1]?.getArray() ?? null, mode, uvs.length / 2);
  for (let i = 0; i < corners.length; i += 3)
    if (!isFree(uvs, corners[i]!, corners[i + 1]!, corners[i + 2]!)) return false;
  return corners.length > 0;
}

/** How glTF says that a texture repeats. */
const kRepeat = 10497;
