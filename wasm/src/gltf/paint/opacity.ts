import { freeOf, type IsFree, mayBeClear } from '../../bake/alpha.js';
import type { Image } from '../../bake/image.js';
import type { Paint } from '../overlay.js';

/**
 * Finds where a paint is opaque: by its header alone if it has no transparency.
 * @param decode  Default: an image that could have transparency counts as transparent.
 */
export async function opacityOf(
  { bytes, mimeType, area }: Paint,
  decode: ((bytes: Uint8Array, mimeType: string) => Promise<Image> | Image) | undefined,
): Promise<IsFree | undefined> {
  if (!mayBeClear(bytes, mimeType)) return () => true;
  try {
    const image = mimeType === 'image/ktx2' ? undefined : await decode?.(bytes, mimeType);
    return image && freeOf(image, (alpha) => alpha < 255, area === 'bounded');
  } catch {
    return undefined; // Not every image can be decoded everywhere.
  }
}
