/**
 * Encodes an image as a PNG without loss; closes the bitmap.
 * @param bitmap Not premultiplied.
 */
export function encodePng(bitmap: ImageBitmap): Promise<Blob> {
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  // A 2D canvas would premultiply the colours, which loses precision.
  canvas.getContext('bitmaprenderer')!.transferFromImageBitmap(bitmap);
  return canvas.convertToBlob({ type: 'image/png' });
}
