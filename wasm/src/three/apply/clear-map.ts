import type { BufferGeometry, Material, Texture } from 'three';
import { RepeatWrapping } from 'three';
import { freeOf, type IsFree, leastSeen } from '../../bake/alpha.js';
import { type PixelSource, pixelsOf } from '../pixels.js';
import { valuesOf } from './attributes.js';
import { inTexture, layoutOf, uvAttribute } from './uv-layout.js';

/** What was found out about each source of a texture: in which version, and for which alphas. */
const known = new WeakMap<object, { key: string; isFree: IsFree | undefined }>();

/**
 * Whether the texture of a material is transparent wherever a geometry lies. Cost: that of reading the texture, once.
 * @param alpha  By which the alpha of the texture is multiplied.
 */
export function isClearByMap(geometry: BufferGeometry, material: Material, alpha: number): boolean {
  const { transparent, alphaTest, map } = material as Material & { map?: Texture | null };
  if (!map || !(transparent || alphaTest > 0)) return false;
  const uv = uvAttribute({ geometry }, layoutOf(map));
  if (uv?.itemSize !== 2) return false;
  const isFree = freeIn(map, transparent ? undefined : alphaTest, alpha);
  const uvs = inTexture(valuesOf(uv), layoutOf(map));
  const doesRepeat = map.wrapS === RepeatWrapping && map.wrapT === RepeatWrapping;
  if (!isFree || !uvs.every((x) => Number.isFinite(x) && (doesRepeat || (x >= 0 && x <= 1)))) return false;
  const corners = geometry.index?.count ?? uv.count;
  const at = (corner: number) => geometry.index?.getX(corner) ?? corner;
  for (let i = 0; i + 2 < corners; i += 3) if (!isFree(uvs, at(i), at(i + 1), at(i + 2))) return false;
  return corners > 0;
}

function freeIn({ source, flipY }: Texture, cutoff: number | undefined, alpha: number): IsFree | undefined {
  const key = [source.version, flipY, cutoff, alpha].join();
  const before = known.get(source);
  if (before?.key === key) return before.isFree;
  const picture = source.data as PixelSource | undefined;
  const image = pixelsOf(picture, flipY);
  // In a picture that became small, thin lines are faint.
  const least = leastSeen(image?.width === picture?.width ? cutoff : undefined, alpha);
  const isFree = image && freeOf(image, (one) => one >= least, false);
  known.set(source, { key, isFree });
  return isFree;
}
