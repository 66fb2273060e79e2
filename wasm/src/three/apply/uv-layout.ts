// How the base colour texture of a part lies on it: the UVs of a cage are those in its texture.
import type { BufferGeometry, Texture, Mesh as ThreeMesh } from 'three';
import { transformUvs, type UvTransform } from '../../parts/uv-transform.js';
import type { Attribute } from './attributes.js';
import type { LoadedGltf } from './models.js';

interface UvLayout {
  /** The number of the UVs. */
  channel: number;
  transform?: UvTransform;
}

/** How a texture lies on its UVs: `Texture.matrix` would scale last. */
const layoutOf = ({ channel, offset, rotation, repeat }: Texture): UvLayout => ({
  channel,
  transform: { offset: [offset.x, offset.y], rotation, scale: [repeat.x, repeat.y] },
});

/**
 * The UVs in its base colour texture, of several the first, or the first UVs without one.
 * @param loaded  What the part is of: where a texture could not be loaded, its file still says how it lies.
 */
export function uvLayoutOf({ mesh }: { mesh: ThreeMesh | undefined }, loaded?: LoadedGltf): UvLayout {
  const materials = [mesh?.material].flat() as ({ map?: Texture | null } | undefined)[];
  const map = materials.find((one) => one?.map)?.map;
  return map ? layoutOf(map) : (mesh && loaded && storedLayout(mesh, loaded)) || { channel: 0 };
}

function storedLayout(mesh: ThreeMesh, { parser }: LoadedGltf): UvLayout | undefined {
  const { meshes, primitives } = parser?.associations?.get(mesh) ?? {};
  const { material } = parser?.json?.meshes?.[meshes!]?.primitives[primitives!] ?? {};
  const info = parser?.json?.materials?.[material!]?.pbrMetallicRoughness?.baseColorTexture;
  if (!info) return undefined;
  const { texCoord, offset = [0, 0], rotation = 0, scale = [1, 1] } = info.extensions?.KHR_texture_transform ?? {};
  return { channel: texCoord ?? info.texCoord ?? 0, transform: { offset, rotation, scale } };
}

/** The attribute of UVs of a layout. */
export const uvAttribute = ({ geometry }: { geometry: BufferGeometry }, { channel }: UvLayout): Attribute | undefined =>
  geometry.getAttribute(`uv${channel || ''}`) as Attribute | undefined;

/** Where UVs are in a texture. */
export const inTexture = (uvs: Float32Array, { transform }: UvLayout): Float32Array => {
  if (!transform) return uvs;
  const { offset, rotation, scale } = transform;
  const isPlain = rotation === 0 && !offset[0] && !offset[1] && scale[0] === 1 && scale[1] === 1;
  return isPlain ? uvs : transformUvs(uvs, transform);
};
