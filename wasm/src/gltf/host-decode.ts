import { checkImage, type Image } from '../bake/image.js';
import type { ImageCodec } from '../scene/materials.js';

/**
 * A caller's decoder that gives images and nothing else. Errors of its own stay as they are.
 * @param name  As in "options.decode", for messages.
 * @throws {CagecastError} `badArgument` once it gives no image.
 */
export const checkedDecode =
  (fn: string, name: string, decode: ImageCodec['decode']): ImageCodec['decode'] =>
  async (bytes, mimeType) =>
    checkImage(fn, `${name}(…)`, await decode(bytes, mimeType));

/** Decodes an image by what a browser has for it; undefined where that is missing, as in Node. */
export const hostDecode = (): ((bytes: Uint8Array, mimeType: string) => Promise<Image>) | undefined =>
  typeof createImageBitmap === 'function' && typeof OffscreenCanvas === 'function' ? decodeOnCanvas : undefined;

async function decodeOnCanvas(bytes: Uint8Array, mimeType: string): Promise<Image> {
  const blob = new Blob([bytes as Uint8Array<ArrayBuffer>], { type: mimeType });
  // As the bytes are: no conversion by what the file says of colours.
  const bitmap = await createImageBitmap(blob, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
  const { width, height } = bitmap;
  const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true })!;
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  return { width, height, data: context.getImageData(0, 0, width, height).data };
}
