import { imageSize } from '../image-file.js';
import { exceeds, type ReadLimits } from './read-limits.js';

/** Images of up to this many bytes may be decoded from any file. */
const kFreeImageBytes = 2 ** 28;

export function checkExpansion(
  what: string,
  bytes: number,
  most: number,
  fileBytes: number,
  limits: Pick<ReadLimits, 'expansion'>,
): void {
  if (bytes > most)
    throw exceeds(
      `${what} to ${bytes.toLocaleString('en')} bytes, ${Math.round(bytes / fileBytes).toLocaleString('en')} times its size`,
      'expansion',
      limits,
    );
}

/**
 * Checks what decoding images costs, by the sizes that they say to have.
 * @param images  Their bytes, or the first of them, by what messages call them.
 * @param fileBytes  Of the images, and of the file that they are in.
 * @throws {InputError}
 */
export function checkImages(
  images: Iterable<[name: string, bytes: Uint8Array]>,
  fileBytes: number,
  limits: Pick<ReadLimits, 'expansion'>,
): void {
  const most = Math.max(kFreeImageBytes, limits.expansion * fileBytes);
  let decoded = 0;
  for (const [name, bytes] of images) {
    const { width, height } = imageSize(bytes) ?? { width: 0, height: 0 };
    decoded += 4 * width * height;
    const size = `${name} has ${width.toLocaleString('en')} × ${height.toLocaleString('en')} pixels`;
    checkExpansion(`${size}; up to it, images decode`, decoded, most, fileBytes, limits);
  }
}
