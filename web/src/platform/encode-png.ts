/**
 * Writes a PNG that has every byte of an image, which it uses up.
 * @param bitmap Its colours not multiplied by alpha.
 */
export function encodePng(bitmap: ImageBitmap): Promise<Blob> {
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  // This kind of canvas shows the image as it is; one in 2D would multiply its colours by alpha.
  canvas.getContext('bitmaprenderer')!.transferFromImageBitmap(bitmap);
  return canvas.convertToBlob({ type: 'image/png' });
}
