// How the base colour texture of a part lies on it: the UVs of a cage are those in its texture.
import type { BufferGeometry, Texture, Mesh as ThreeMesh } from 'three';
import { transformUvs, type UvTransform } from '../../parts/uv-transform.js';
import { chooseUvSet } from '../../scene/uv-sets.js';
import { type Attribute, valuesOf } from './attributes.js';
import type { LoadedGltf } from './models.js';

export interface UvLayout {
  /** The number of the UVs. */
  channel: number;
  transform?: UvTransform;
}

/** How a texture lies on its UVs: `Texture.matrix` would scale last. */
export const layoutOf = ({ channel, offset, rotation, repeat }: Texture): UvLayout => ({
  channel,
  transform: { offset: [offset.x, offset.y], rotation, scale: [repeat.x, repeat.y] },
});

/**
 * The UVs in its base colour texture, of several the first, or the first UVs without one.
 * @param loaded  What the part is of: where a texture could not be loaded, its file still says how it lies.
 */
export const uvLayoutOf = (part: { mesh: ThreeMesh | undefined }, loaded?: LoadedGltf): UvLayout =>
  toldLayout(part, loaded) ?? { channel: 0 };

/** What a texture says of it. */
function toldLayout({ mesh }: { mesh: ThreeMesh | undefined }, loaded?: LoadedGltf): UvLayout | undefined {
  const materials = [mesh?.material].flat() as ({ map?: Texture | null } | undefined)[];
  const map = materials.find((one) => one?.map)?.map;
  return map ? layoutOf(map) : mesh && loaded && storedLayout(mesh, loaded);
}

/** The UV sets that three.js has. */
const kChannels = [0, 1, 2, 3];

/**
 * The UVs that the texture for a cage is drawn in, and the numbers of the sets that might be meant as well.
 * @param given  The number of the set, if it was chosen.
 * @param fail   The error if there is none of this number.
 */
export function cageLayoutOf(
  part: { mesh: ThreeMesh | undefined; geometry: BufferGeometry },
  loaded: LoadedGltf | undefined,
  given: number | undefined,
  fail: (text: string) => unknown,
): { layout: UvLayout; others: readonly number[] } {
  const told = toldLayout(part, loaded);
  const sets = kChannels.flatMap((channel) => {
    const uv = uvAttribute(part, { channel });
    return uv ? [{ number: channel, values: () => valuesOf(uv) }] : [];
  });
  if (sets.length === 0) return { layout: told ?? { channel: 0 }, others: [] };
  const { number, others } = chooseUvSet(sets, { given, used: told?.channel }, fail);
  return { layout: number === told?.channel ? told : { channel: number }, others };
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
