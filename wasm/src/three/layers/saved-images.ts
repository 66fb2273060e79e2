import { counted, type SavedImage } from '../../gltf/look/saved-images.js';
import { asStored } from '../canvas.js';
import { wrong } from '../errors.js';

/** Decodes an image. @throws {CagecastError} `badArgument` that names it. */
export async function decoded({ name, bytes, type, ...said }: SavedImage): Promise<ImageBitmap> {
  const bitmap = await asStored(new Blob([bytes], { type })).catch((error: Error) => {
    throw wrong(`${name} cannot be read: ${error.message}`);
  });
  const { width, height } = bitmap;
  if (width * height <= said.width * said.height) return bitmap;
  bitmap.close();
  throw wrong(`${name} has ${counted(width)} × ${counted(height)} pixels, more than it says`);
}
